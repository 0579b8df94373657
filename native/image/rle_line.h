#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace snowbough::image {

/// Packs one line of pixels as OpenEXR's RLE compression does: even bytes first, then odd ones,
/// each as its difference from the byte before; runs of three or more become a count and a value.
/// Format: OpenEXR File Layout, openexr.com; the bytes match OpenEXR's own writer.
/// Keeps its working memory: one packer per thread.
class RleLinePacker {
 public:
  /// `line`: `size` bytes, an even number. Returns true if packing made it shorter; packed() then
  /// holds the result. Otherwise the format stores the line unpacked.
  bool pack(const uint8_t* line, size_t size);

  const uint8_t* packed() const { return packed_.data(); }
  size_t packed_size() const { return packed_size_; }

 private:
  std::vector<uint8_t> differences_;
  std::vector<uint8_t> packed_;
  size_t packed_size_ = 0;
};

}  // namespace snowbough::image
