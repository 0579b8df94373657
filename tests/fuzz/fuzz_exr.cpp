// EXR images. An image that was read must come back bit for bit after it is written.
#include <cstring>
#include <stdexcept>

#include "fuzz_input.h"
#include "image/exr.h"

using namespace snowbough;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const fuzz::ScratchFolder scratch;
  image::ExrImage read;
  try {
    read = image::read_exr(scratch.write("image.exr", {reinterpret_cast<const char*>(data), size}));
  } catch (const std::runtime_error&) {
    return 0;
  }
  const image::ExrLayout& layout = read.layout;
  fuzz::require(layout.width > 0 && layout.height > 0 &&
                    read.pixels.size() == static_cast<size_t>(layout.width) *
                                              static_cast<size_t>(layout.height) *
                                              layout.channels.size(),
                "the image has another number of pixels");
  if (read.pixels.size() > 4096) return 0;
  image::ExrLayout written = layout;
  // Half precision rounds NaN; names of attributes may be reserved.
  written.type = image::ExrPixelType::kFloat;
  written.attributes.clear();
  const std::string path = scratch.file("again.exr");
  image::write_exr(path, written, read.pixels.data());
  const image::ExrImage again = image::read_exr(path);
  fuzz::require(again.layout.channels == layout.channels &&
                    again.pixels.size() == read.pixels.size() &&
                    std::memcmp(again.pixels.data(), read.pixels.data(),
                                read.pixels.size() * sizeof(float)) == 0,
                "the image changes when it is written");
  return 0;
}
