// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <geogram/basic/command_line.h>

#include <string>

namespace GEO::CmdLine {
bool import_arg_group(const std::string& name);
}
