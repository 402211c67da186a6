// SPDX-License-Identifier: BSL-1.0
#include "bytes.hpp"
#include "support/temporary_folder.hpp"
#include "support/usable.hpp"
#include "targets.hpp"

namespace framehex::test {

/// The first byte tells the format, the rest is the file.
void fuzz_readers(std::span<const std::uint8_t> input) {
  static const TemporaryFolder folder;
  constexpr std::array<const char*, 10> extensions{".stl", ".obj", ".off",  ".ply",   ".vtu",
                                                   ".vtk", ".msh", ".mesh", ".meshb", ".txt"};
  Bytes bytes(input);
  const std::string name = std::string("file") + extensions[bytes.below(extensions.size())];
  const std::filesystem::path file = folder.write(name, bytes.rest());
  try {
    promise(reads_something_usable(file), "what is read can be used");
  } catch (const error& e) {
    promise(std::string_view(e.what()).find(name) != std::string_view::npos, "an error names the file");
  }
}

}  // namespace framehex::test
