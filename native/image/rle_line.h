#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace snowbough::image {

/// Packs one line of pixels as OpenEXR's RLE compression does: even bytes first, then odd ones,
/// each as its difference from the byte before, and of these runs of three and more as a count and
/// a value. Source of the format: OpenEXR File Layout, openexr.com, and OpenEXR's own writer, whose
/// bytes these are.
///
/// It keeps its working memory, so one packer is for one thread.
class RleLinePacker {
 public:
  /// `line`: `size` bytes, an even number. Returns whether that made it shorter; then packed()
  /// holds the result, else the format wants the line as it is.
  bool pack(const uint8_t* line, size_t size);

  const uint8_t* packed() const { return packed_.data(); }
  size_t packed_size() const { return packed_size_; }

 private:
  std::vector<uint8_t> differences_;
  std::vector<uint8_t> packed_;
  size_t packed_size_ = 0;
};

}  // namespace snowbough::image
