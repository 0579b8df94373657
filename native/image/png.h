#pragma once

#include <cstdint>
#include <string>

namespace snowbough::image {

/// A PNG file of height x width x channels samples, row 0 at the bottom. Channels: 1 grey, 2 grey +
/// alpha, 3 RGB, 4 RGBA. The same input gives the same bytes. Format: W3C, Portable Network
/// Graphics specification, second edition; packed by zlib.
/// @throws std::invalid_argument for sizes below 1 or other channel counts.
std::string encode_png(int32_t width, int32_t height, int32_t channels, const uint8_t* samples);
std::string encode_png(int32_t width, int32_t height, int32_t channels, const uint16_t* samples);

}  // namespace snowbough::image
