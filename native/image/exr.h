#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace snowbough::image {

enum class ExrPixelType : uint8_t { kFloat, kHalf };

/// How pixels are packed. All are read by every Blender version; figures in docs/formats.md.
enum class ExrCompression : uint8_t { kNone, kRle, kZips, kZip, kPiz };

/// An image without its pixels.
struct ExrLayout {
  int32_t width = 0;
  int32_t height = 0;
  /// Channel names in the order in which a pixel's values are stored in memory ("Y", or "R", "G",
  /// "B"). In the file they are sorted by name, as the format demands.
  std::vector<std::string> channels;
  ExrPixelType type = ExrPixelType::kFloat;
  /// Smoothed heights have noise in their last bits, which zlib packs no better than runs of zeros
  /// do: kRle is ten times faster at the same size.
  ExrCompression compression = ExrCompression::kRle;
  /// zlib's level for kZip and kZips, 1 to 9; the pixels are the same with each.
  int32_t compression_level = 1;
  /// Text attributes of the header, by name.
  std::map<std::string, std::string> attributes;
};

/// An image in memory: height x width x channels, row 0 = v 0 (the file's last scanline).
struct ExrImage {
  ExrLayout layout;
  std::vector<float> pixels;
};

/// Writes `pixels` (height x width x channels, row 0 = v 0) as a scanline file, atomically. The
/// same input gives the same bytes: no dates, and the packing does not depend on threads. kRle uses
/// no thread but the caller's; OpenEXR, which packs the others, uses its global pool's if there
/// are.
/// @throws std::invalid_argument for sizes below 1 or without channels, doubled or empty names, and
///         attribute names that the format keeps for itself; std::runtime_error as atomic_write.
void write_exr(const std::string& path, const ExrLayout& layout, const float* pixels);

/// Largest edge of an image that is read, in pixels.
constexpr int32_t kLargestExr = 8192;

/// Reads any scanline or tiled single-part EXR file of float or half channels without subsampling;
/// channels in the file's order (by name).
/// @throws std::runtime_error with path and reason where it is missing, no EXR file, damaged, wider
/// or higher than kLargestExr, or of a size that so short a file cannot hold: memory is taken only
/// afterwards.
ExrImage read_exr(const std::string& path);

}  // namespace snowbough::image
