// SPDX-License-Identifier: BSL-1.0
#include "framehex/version.hpp"

#include <CLI/CLI.hpp>

#include <iostream>

int main(int argc, char** argv) {
  CLI::App app("Hex-dominant meshes from closed surfaces and from tetrahedral meshes.");
  app.set_version_flag("--version", FRAMEHEX_VERSION);
  CLI11_PARSE(app, argc, argv);
  std::cout << app.help();
  return 0;
}
