// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

namespace framehex::test {

/// Each makes some input of any bytes and gives it to a part of the library. Errors of the library's own types are right
/// answers; another exception, or an answer that breaks a promise, ends the process.
void fuzz_readers(std::span<const std::uint8_t> bytes);
void fuzz_validate(std::span<const std::uint8_t> bytes);
void fuzz_recombine(std::span<const std::uint8_t> bytes);
void fuzz_mesh_surface(std::span<const std::uint8_t> bytes);

inline void promise(bool kept, const char* what) {
  if (kept) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

}  // namespace framehex::test
