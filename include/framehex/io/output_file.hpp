// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#if __has_include(<unistd.h>)
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>
#endif

namespace framehex {

/// A file that appears whole or not at all.
///
/// Bytes go to a file without a name in the folder of the wanted one, which takes the name in `commit`, once everything
/// has reached the disk: whatever ends the process before, kill -9 too, the system lets go of it. An older file of that
/// name is replaced in one step. Where a file system has no files without names, or there is no Linux, a temporary file
/// beside the wanted one stands in: without `commit` (an exception, a cancelled run) it is removed, and what killed
/// processes left is by the next that writes there. A symbolic link is followed. A device (`/dev/stdout`) is written
/// directly.
class OutputFile {
public:
  /// @throws io_error  when a file of that name cannot be made.
  explicit OutputFile(const std::filesystem::path& path) : name_(path.string()), target_(followed(path).string()) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(target_, ignored);
    if (std::filesystem::is_directory(status)) throw io_error(name_ + ": is a directory");
#if __has_include(<unistd.h>)
    if (std::filesystem::exists(status) && ::access(target_.c_str(), W_OK) != 0) fail("cannot be written");
#endif
    const std::string temporary = temporary_name(path);
    if (temporary.empty()) {
      file_ = std::fopen(target_.c_str(), "wb");
    } else if (!open_nameless()) {
      remove_abandoned();
      file_ = std::fopen(temporary.c_str(), "wbx");
      if (file_) temporary_ = temporary;
    }
    if (!file_) fail("cannot be written");
  }

  /// Where the bytes of a file may have a name of their own until it is whole: for those who must clean up after themselves
  /// in a hurry. Empty for a device.
  static std::string temporary_name(const std::filesystem::path& path) {
    const std::filesystem::path target = followed(path);
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(target, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return {};
#if __has_include(<unistd.h>)
    return target.string() + host_suffix() + std::to_string(::getpid()) + partial_suffix;
#else
    return target.string() + partial_suffix;
#endif
  }

  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile() {
    discard();
  }

  /// @throws io_error  when the disk is full or fails.
  void write(std::string_view bytes) {
    if (bytes.empty()) return;  // its data may be null, which fwrite does not allow
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail("cannot be written whole");
  }

  /// Writes the bytes of `n` values as they stand in memory.
  template <class Value>
  void write_values(const Value* values, std::size_t n) {
    static_assert(std::is_trivially_copyable_v<Value>);
    write({reinterpret_cast<const char*>(values), n * sizeof(Value)});
  }

  template <class Value>
  void write_value(const Value& value) {
    write_values(&value, 1);
  }

  /// Brings all bytes to the disk, so that `commit` only has the name left to change: for files that belong together.
  ///
  /// @throws io_error  when the disk is full or fails.
  void finish() {
    if (!file_ || is_finished_) return;
    if (std::fflush(file_) != 0) fail("cannot be written whole");
#if __has_include(<unistd.h>)
    if ((is_nameless_ || !temporary_.empty()) && ::fsync(::fileno(file_)) != 0) fail("cannot be written whole");
#endif
    is_finished_ = true;
    if (is_nameless_) return;  // it lives as long as it is open
    std::FILE* const file = file_;
    file_ = nullptr;
    if (std::fclose(file) != 0) fail("cannot be written whole");
  }

  /// Makes the file appear under its name.
  ///
  /// @throws io_error  when the disk is full or fails; nothing has appeared then.
  void commit() {
    finish();
    if (is_nameless_ && file_ && !name_it()) {
      discard();
      return;
    }
    if (!temporary_.empty() && std::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot be written");
    temporary_.clear();
    discard();
  }

private:
  static std::filesystem::path followed(const std::filesystem::path& path) {
    std::error_code ignored;
    // What stands behind the name of a pipe or a device has no path of its own.
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return path;
    return std::filesystem::is_symlink(path, ignored) ? std::filesystem::weakly_canonical(path, ignored) : path;
  }

  static constexpr const char* partial_suffix = ".partial";

#if __has_include(<unistd.h>)
  /// Numbers of processes are those of a machine, and folders may be shared.
  static std::string host_suffix() {
    std::string host(256, '\0');
    if (::gethostname(host.data(), host.size() - 1) != 0) host.clear();
    host.resize(std::char_traits<char>::length(host.c_str()));
    return "." + host + ".";
  }
#endif

  /// @return false where there are no files without names.
  bool open_nameless() {
#ifdef O_TMPFILE
    const std::filesystem::path folder = std::filesystem::path(target_).parent_path();
    const int file = ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (file < 0) return false;
    // By this it gets its name.
    if (::access(open_path(file).c_str(), F_OK) == 0) file_ = ::fdopen(file, "wb");
    if (!file_) ::close(file);
    is_nameless_ = file_ != nullptr;
#endif
    return is_nameless_;
  }

#ifdef O_TMPFILE
  static std::string open_path(int file) {
    return "/proc/self/fd/" + std::to_string(file);
  }
#endif

  /// Gives the file its name, or where an older one has it another one, which is to be changed.
  /// @return whether it is to be changed.
  bool name_it() {
#ifdef O_TMPFILE
    const std::string source = open_path(::fileno(file_));
    const auto link_to = [&](const std::string& name) {
      return ::linkat(AT_FDCWD, source.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
    };
    if (link_to(target_)) return false;
    if (errno != EEXIST) fail("cannot be written");
    remove_abandoned();
    const std::string temporary = temporary_name(target_);
    if (!link_to(temporary)) fail("cannot be written");
    temporary_ = temporary;
#endif
    return true;
  }

  /// Removes what processes of this machine left that are no more.
  void remove_abandoned() const noexcept {
#if __has_include(<unistd.h>)
    std::error_code ignored;
    const std::filesystem::path target(target_);
    const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
    const std::string first = target.filename().string() + host_suffix();
    for (std::filesystem::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
      const std::string name = at->path().filename().string();
      if (!name.starts_with(first) || !name.ends_with(partial_suffix)) continue;
      const int process = std::atoi(name.c_str() + first.size());
      if (process > 0 && ::kill(process, 0) != 0 && errno == ESRCH) std::filesystem::remove(at->path(), ignored);
    }
#endif
  }

  [[noreturn]] void fail(const char* what) {
    const int reason = errno;
    discard();
    throw io_error(name_ + ": " + what + " (" + std::generic_category().message(reason) + ")");
  }

  void discard() noexcept {
    if (file_) std::fclose(file_);
    file_ = nullptr;
    if (!temporary_.empty()) std::remove(temporary_.c_str());
    temporary_.clear();
  }

  std::string name_;       // as given, for messages
  std::string target_;     // links followed
  std::string temporary_;  // empty for a device, and when nothing is left to remove
  std::FILE* file_ = nullptr;
  bool is_nameless_ = false, is_finished_ = false;
};

}  // namespace framehex
