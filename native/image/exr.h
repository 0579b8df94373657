#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace snowbough::image {

enum class ExrPixelType : uint8_t { kFloat, kHalf };

/// Everything about an image except its pixels.
struct ExrLayout {
  int32_t width = 0;
  int32_t height = 0;
  /// Channel names in the order of a pixel's values in memory ("Y", or "R", "G", "B"). The file
  /// sorts them by name, as the format requires.
  std::vector<std::string> channels;
  ExrPixelType type = ExrPixelType::kFloat;
  /// Text attributes of the header, by name.
  std::map<std::string, std::string> attributes;
};

/// An image in memory: height x width x channels, row 0 = v 0 (the file's last scanline).
struct ExrImage {
  ExrLayout layout;
  std::vector<float> pixels;
};

/// Writes `pixels` (height x width x channels, row 0 = v 0) as a scanline file, atomically, packed
/// with RLE: the last bits of smoothed heights are noise, which zlib packs hardly better. The same
/// input gives the same bytes: no dates, and packing does not depend on threads.
/// @throws std::invalid_argument for sizes below 1, missing, repeated or empty channel names, and
/// attribute names that the format reserves; std::runtime_error as atomic_write.
void write_exr(const std::string& path, const ExrLayout& layout, const float* pixels);

/// Largest edge of an image that read_exr accepts, in pixels.
constexpr int32_t kLargestExr = 8192;

/// Reads a scanline or tiled single-part EXR file of float or half channels without subsampling,
/// however it is packed.
/// Channels are in the file's order (by name).
/// @throws std::runtime_error with path and reason if the file is missing, no EXR file, damaged,
/// wider or higher than kLargestExr, of too many channels, or too short for its size; memory is
/// allocated only afterwards.
ExrImage read_exr(const std::string& path);

}  // namespace snowbough::image
