// SPDX-License-Identifier: BSL-1.0
// Inputs that a fuzzer has found: each once broke a promise or leads where no other goes.
#include "framehex/io/input_file.hpp"
#include "targets.hpp"

#include <catch2/catch.hpp>

#include <filesystem>

using namespace framehex;

namespace {

void replay(const char* target, void (*fuzz)(std::span<const std::uint8_t>)) {
  std::size_t n = 0;
  for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(FRAMEHEX_CORPUS) / target)) {
    INFO(file.path());
    const std::string bytes = read_file(file.path());
    fuzz({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    ++n;
  }
  CHECK(n > 0);
}

}  // namespace

TEST_CASE("Inputs found by fuzzing keep every promise", "[regression]") {
  SECTION("readers") {
    replay("readers", test::fuzz_readers);
  }
  SECTION("validate") {
    replay("validate", test::fuzz_validate);
  }
  SECTION("recombine") {
    replay("recombine", test::fuzz_recombine);
  }
  SECTION("mesh_surface") {
    replay("mesh_surface", test::fuzz_mesh_surface);
  }
}
