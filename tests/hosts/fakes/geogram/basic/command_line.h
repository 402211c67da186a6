// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <geogram/basic/common.h>
