// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <concepts>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

namespace framehex {

/// The bytes of a file.
///
/// @throws io_error  when it is missing, a directory, or cannot be read.
inline std::string read_file(const std::filesystem::path& path) {
  const auto fail = [&](int reason) -> io_error {
    return io_error(path.string() + ": cannot be read (" + std::generic_category().message(reason) + ")");
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw fail(EISDIR);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.string().c_str(), "rb"), &std::fclose);
  if (!file) throw fail(errno);
  std::string bytes;
  char block[1 << 16];
  for (std::size_t n; (n = std::fread(block, 1, sizeof block, file.get())) > 0;) bytes.append(block, n);
  if (std::ferror(file.get())) throw fail(errno);
  return bytes;
}

namespace detail {

inline char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Are two words the same but for upper and lower case? `lower` is in lower case.
inline bool same_word(std::string_view word, std::string_view lower) {
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return lower_case(a) == b; });
}

inline std::string lower_text(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), lower_case);
  return lower;
}

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// Reads numbers and words off a file held in memory; whatever does not fit is an io_error naming file and line.
class Cursor {
public:
  /// @param comment  character that starts a comment up to the end of its line; '\0': none.
  Cursor(std::string name, std::string_view bytes, char comment = '\0')
      : name_(std::move(name)), bytes_(bytes), comment_(comment) {}

  const std::string& name() const { return name_; }
  std::size_t position() const { return at_; }
  std::size_t remaining() const { return bytes_.size() - at_; }

  void move_to(std::size_t position) {
    if (position > bytes_.size()) fail("the file ends within binary data");
    at_ = position;
  }

  [[noreturn]] void fail(const std::string& what) const {
    const auto line = static_cast<std::size_t>(
        1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n'));
    throw io_error(name_ + ": line " + std::to_string(line) + ": " + what, Entity::line, {line});
  }

  bool at_end() {
    skip_space();
    return at_ == bytes_.size();
  }

  /// Next word, empty at the end of the file.
  std::string_view word() {
    skip_space();
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !is_space(bytes_[at_])) ++at_;
    return bytes_.substr(begin, at_ - begin);
  }

  std::string_view peek_word() {
    const std::size_t before = at_;
    const std::string_view next = word();
    at_ = before;
    return next;
  }

  /// The rest of the line, without its end.
  std::string_view line() {
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
    std::string_view text = bytes_.substr(begin, at_ - begin);
    if (at_ < bytes_.size()) ++at_;
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }

  /// What is left of the line, to be read by itself: its end is that of the line, and faults are in this line of the file.
  Cursor rest_of_line() {
    Cursor rest = *this;
    const std::string_view text = line();
    rest.bytes_ = bytes_.substr(0, rest.at_ + text.size());
    return rest;
  }

  template <class Number>
  Number number(const char* what) {
    const std::size_t before = (skip_space(), at_);
    std::string_view text = word();
    if (text.starts_with('+')) text.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end != text.data() + text.size() || error != std::errc{}) {
      // Underflow is a number all the same: zero is nearest.
      if (std::is_floating_point_v<Number> && error == std::errc::result_out_of_range &&
          end == text.data() + text.size() && is_below_one(text))
        return Number{};
      at_ = before;
      fail(text.empty() ? std::string("the file ends where ") + what + " should stand"
                        : std::string(what) + " should stand where \"" + printable(text) + "\" does");
    }
    return value;
  }

  /// A count, checked against what the rest of the file can hold at all.
  ///
  /// @param least_bytes  that one counted thing takes in the file at least.
  std::size_t count(const char* what, std::size_t least_bytes) {
    const std::size_t before = (skip_space(), at_);
    const auto n = number<std::size_t>(what);
    if (n > remaining() / least_bytes + 1) {
      at_ = before;
      fail(std::string(what) + " is " + std::to_string(n) + ", more than the file can hold");
    }
    return n;
  }

  /// Passes over `n` values of so many bytes.
  void skip(std::size_t n, std::size_t size = 1) {
    if (n > remaining() / size) fail("the file ends within binary data");
    at_ += n * size;
  }

  /// `n` values as they stand in memory, in the byte order told.
  template <class Value>
  void raw(Value* values, std::size_t n, std::endian order = std::endian::native) {
    if (n > remaining() / sizeof(Value)) fail("the file ends within binary data");
    if (n > 0) std::memcpy(values, bytes_.data() + at_, n * sizeof(Value));
    at_ += n * sizeof(Value);
    if (order != std::endian::native)
      for (std::size_t i = 0; i < n; ++i) swap_bytes(values[i]);
  }

  template <class Value>
  Value raw(std::endian order = std::endian::native) {
    Value value;
    raw(&value, 1, order);
    return value;
  }

  void skip_space() {
    for (;;) {
      while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
      if (comment_ == '\0' || at_ == bytes_.size() || bytes_[at_] != comment_) return;
      line();
    }
  }

  static std::string printable(std::string_view text) {
    std::string out;
    for (const char c : text.substr(0, 24)) out += c >= ' ' && c <= '~' ? c : '?';
    return out;
  }

private:
  /// Is the magnitude of a decimal number, which is not 0, less than 1?
  static bool is_below_one(std::string_view text) {
    const std::size_t e = std::min(text.find_first_of("eE"), text.size());
    const std::string_view mantissa = text.substr(0, e);
    std::string_view power = text.substr(std::min(e + 1, text.size()));
    if (power.starts_with('+')) power.remove_prefix(1);
    long exponent = 0;
    if (std::from_chars(power.data(), power.data() + power.size(), exponent).ec == std::errc::result_out_of_range)
      return power.starts_with('-');
    const auto point = static_cast<long>(std::min(mantissa.find('.'), mantissa.size()));
    const auto first = static_cast<long>(std::min(mantissa.find_first_of("123456789"), mantissa.size()));
    // Digits before the point once the exponent has moved it; negative: zeros after it.
    const long digits = first < point ? point - first : point - first + 1;
    return exponent <= -digits;
  }

  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  template <class Value>
  static void swap_bytes(Value& value) {
    auto* const bytes = reinterpret_cast<char*>(&value);
    std::reverse(bytes, bytes + sizeof(Value));
  }

  std::string name_;
  std::string_view bytes_;
  char comment_;
  std::size_t at_ = 0;
};

}  // namespace detail

}  // namespace framehex
