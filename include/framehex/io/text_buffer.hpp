// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/output_file.hpp"

#include <charconv>

namespace framehex::detail {

/// Numbers as text, gathered into blocks. Reals are the shortest decimals that read back as the same number.
class TextBuffer {
public:
  explicit TextBuffer(OutputFile& file) : file_(file) {}

  TextBuffer& operator<<(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() > (1u << 16)) flush();
    return *this;
  }
  template <class Number>
  requires std::is_arithmetic_v<Number> TextBuffer& operator<<(Number number) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, number).ptr;
    return *this << std::string_view(digits, static_cast<std::size_t>(end - digits));
  }

  void flush() {
    file_.write(buffer_);
    buffer_.clear();
  }

private:
  OutputFile& file_;
  std::string buffer_;
};

}  // namespace framehex::detail
