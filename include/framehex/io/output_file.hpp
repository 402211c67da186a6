// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#if __has_include(<unistd.h>)
#include <unistd.h>
#endif

namespace framehex {

/// A file that appears whole or not at all.
///
/// Bytes go to a temporary file beside the wanted one, which takes its name in `commit`, once everything has reached
/// the disk. Without `commit` (an exception, a cancelled run) the temporary file is removed and an older file of the
/// wanted name stays as it was. A symbolic link is followed. A device (`/dev/stdout`) is written directly.
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
    temporary_ = temporary_name(path);
    const bool is_device = temporary_.empty();
    file_ = std::fopen(is_device ? target_.c_str() : temporary_.c_str(), is_device ? "wb" : "wbx");
    if (!file_) {
      const int reason = errno;
      temporary_.clear();  // not ours
      errno = reason;
      fail("cannot be written");
    }
  }

  /// Where the bytes of a file go until it is whole: for those who must clean up after themselves in a hurry. Empty for
  /// a device.
  static std::string temporary_name(const std::filesystem::path& path) {
    const std::filesystem::path target = followed(path);
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(target, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return {};
#if __has_include(<unistd.h>)
    return target.string() + "." + std::to_string(::getpid()) + ".partial";
#else
    return target.string() + ".partial";
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
    if (!file_) return;
    if (std::fflush(file_) != 0) fail("cannot be written whole");
#if __has_include(<unistd.h>)
    if (!temporary_.empty() && ::fsync(::fileno(file_)) != 0) fail("cannot be written whole");
#endif
    std::FILE* const file = file_;
    file_ = nullptr;
    if (std::fclose(file) != 0) fail("cannot be written whole");
  }

  /// Makes the file appear under its name.
  ///
  /// @throws io_error  when the disk is full or fails; nothing has appeared then.
  void commit() {
    finish();
    if (temporary_.empty()) return;
    if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot be written");
    temporary_.clear();
  }

private:
  static std::filesystem::path followed(const std::filesystem::path& path) {
    std::error_code ignored;
    // What stands behind the name of a pipe or a device has no path of its own.
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return path;
    return std::filesystem::is_symlink(path, ignored) ? std::filesystem::weakly_canonical(path, ignored) : path;
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
};

}  // namespace framehex
