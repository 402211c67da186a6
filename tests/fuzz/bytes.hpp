// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>

namespace framehex::test {

/// Bytes of a fuzzer, taken from the front as numbers; zeros follow the last.
class Bytes {
public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  bool empty() const { return left_.empty(); }

  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t b = left_.front();
    left_ = left_.subspan(1);
    return b;
  }

  /// 0 to n - 1, n at most 256.
  unsigned below(unsigned n) { return byte() % n; }

  /// Any double: each pattern of bits is one.
  double any() {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
    return std::bit_cast<double>(bits);
  }

  /// -1 to 1 in 255 steps.
  double unit() { return (byte() - 127.5) / 127.5; }

  std::string rest() { return {left_.begin(), left_.end()}; }

private:
  std::span<const std::uint8_t> left_;
};

}  // namespace framehex::test
