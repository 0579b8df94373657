#pragma once

#include <string>

#include "image/exr.h"

namespace snowbough::image {

/// Writes an OpenEXR file with RLE compression, line by line, with the bytes that OpenEXR would
/// write. OpenEXR's own writer passes every line to a pool thread if the process has a pool, as
/// Blender has, which takes five times as long.
/// @param header the file's first bytes, up to the line offset table.
/// @param pixels as in write_exr.
/// @throws std::runtime_error as AtomicFile.
void write_rle_file(const std::string& path, const ExrLayout& layout, std::string header,
                    const float* pixels);

}  // namespace snowbough::image
