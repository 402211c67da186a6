// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/io/vtu_writer.hpp"

#include <zlib.h>

namespace framehex {

/// Deflates the arrays of a .vtu file. Needs zlib.
///
/// @param level  1 (fast) to 9 (small).
/// @par Determinism  Same bytes from the same version of zlib.
inline VtuCompression zlib_compression(int level = 6) {
  return {"vtkZLibDataCompressor", [level](std::string_view bytes) {
            uLongf n = compressBound(static_cast<uLong>(bytes.size()));
            std::string packed(n, '\0');
            if (compress2(reinterpret_cast<Bytef*>(packed.data()), &n, reinterpret_cast<const Bytef*>(bytes.data()),
                          static_cast<uLong>(bytes.size()), level) != Z_OK)
              throw invalid_option("zlib cannot compress at level " + std::to_string(level));
            packed.resize(n);
            return packed;
          }};
}

}  // namespace framehex
