#pragma once

#include <string>

#include "image/exr.h"

namespace snowbough::image {

/// Writes an OpenEXR file with RLE compression, line by line, with the bytes that OpenEXR would
/// write. OpenEXR's own writer hands every line to another thread of its pool where the process has
/// one, as Blender's has, which takes five times as long.
/// @param header the file's first bytes, up to the table of the lines' places.
/// @param pixels as write_exr's.
/// @throws std::runtime_error as AtomicFile.
void write_rle_file(const std::string& path, const ExrLayout& layout, std::string header,
                    const float* pixels);

}  // namespace snowbough::image
