// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"

#if __has_include(<sys/mman.h>)
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace framehex::detail {

/// The bytes of a file for who goes through them once: the system brings those that are looked at, and takes them back.
/// What is no regular file is read whole, as everything is where files cannot be mapped.
///
/// A file that another program makes shorter meanwhile ends the process.
class MappedFile {
public:
  /// @throws io_error  as `read_file`.
  explicit MappedFile(const std::filesystem::path& path) {
    if (!map(path)) copy_ = read_file(path);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

#if __has_include(<sys/mman.h>)
  ~MappedFile() {
    if (bytes_) ::munmap(bytes_, size_);
  }

  std::string_view bytes() const {
    return bytes_ ? std::string_view(static_cast<const char*>(bytes_), size_) : std::string_view(copy_);
  }

  /// Gives back the memory of what was looked at; it may be looked at again.
  void release() const {
    if (bytes_) ::madvise(bytes_, size_, MADV_DONTNEED);
  }

private:
  bool map(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return false;
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    struct stat status {};
    if (::fstat(file, &status) == 0 && status.st_size > 0) {
      size_ = static_cast<std::size_t>(status.st_size);
      void* const at = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
      if (at != MAP_FAILED) {
        bytes_ = at;
        ::madvise(bytes_, size_, MADV_SEQUENTIAL);
      }
    }
    ::close(file);
    return bytes_ != nullptr;
  }

  void* bytes_ = nullptr;
  std::size_t size_ = 0;
#else
  std::string_view bytes() const {
    return copy_;
  }
  void release() const {}

private:
  static bool map(const std::filesystem::path&) {
    return false;
  }
#endif
  std::string copy_;
};

}  // namespace framehex::detail
