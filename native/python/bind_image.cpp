#include <pybind11/stl.h>

#include "bindings.h"
#include "image/atomic_file.h"
#include "image/exr.h"
#include "image/png.h"
#include "numpy_arrays.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

struct PixelShape {
  int32_t height = 0;
  int32_t width = 0;
  int32_t channels = 0;
};

PixelShape pixel_shape(const py::array& pixels) {
  if (pixels.ndim() != 2 && pixels.ndim() != 3) {
    throw std::invalid_argument("pixels must have shape (H, W) or (H, W, channels)");
  }
  return {static_cast<int32_t>(pixels.shape(0)), static_cast<int32_t>(pixels.shape(1)),
          pixels.ndim() == 3 ? static_cast<int32_t>(pixels.shape(2)) : 1};
}

std::vector<std::string> channels_of(int32_t count) {
  switch (count) {
    case 1:
      return {"Y"};
    case 3:
      return {"R", "G", "B"};
    case 4:
      return {"R", "G", "B", "A"};
    default:
      throw std::invalid_argument("an EXR image has 1, 3 or 4 channels, not " +
                                  std::to_string(count));
  }
}

void write_exr(const std::string& path, const InputArray<float>& pixels, bool half,
               const std::map<std::string, std::string>& attributes) {
  const PixelShape shape = pixel_shape(pixels);
  image::ExrLayout layout;
  layout.width = shape.width;
  layout.height = shape.height;
  layout.channels = channels_of(shape.channels);
  layout.type = half ? image::ExrPixelType::kHalf : image::ExrPixelType::kFloat;
  layout.attributes = attributes;
  const float* data = pixels.data();
  ReleasedGil unlocked;
  image::write_exr(path, layout, data);
}

py::tuple read_exr(const std::string& path) {
  image::ExrImage image;
  {
    ReleasedGil unlocked;
    image = image::read_exr(path);
  }
  const image::ExrLayout& layout = image.layout;
  std::vector<py::ssize_t> shape{layout.height, layout.width};
  if (layout.channels.size() > 1) shape.push_back(static_cast<py::ssize_t>(layout.channels.size()));
  py::dict header;
  header["channels"] = layout.channels;
  header["half"] = layout.type == image::ExrPixelType::kHalf;
  header["attributes"] = layout.attributes;
  return py::make_tuple(to_numpy<float>(std::move(image.pixels), std::move(shape)), header);
}

template <typename Sample>
std::string encode_samples(const py::array& pixels) {
  const PixelShape shape = pixel_shape(pixels);
  const auto samples = InputArray<Sample>::ensure(pixels);
  const Sample* data = samples.data();
  ReleasedGil unlocked;
  return image::encode_png(shape.width, shape.height, shape.channels, data);
}

std::string encoded_png(const py::array& pixels) {
  if (py::isinstance<py::array_t<uint8_t>>(pixels)) return encode_samples<uint8_t>(pixels);
  if (py::isinstance<py::array_t<uint16_t>>(pixels)) return encode_samples<uint16_t>(pixels);
  throw std::invalid_argument("a PNG image needs an array of uint8 or uint16");
}

void write_png(const std::string& path, const py::array& pixels) {
  image::atomic_write(path, encoded_png(pixels));
}

}  // namespace

void bind_image(py::module_& module) {
  module.def(
      "write_exr", &write_exr, py::arg("path"), py::arg("pixels"), py::arg("half") = false,
      py::arg("attributes") = std::map<std::string, std::string>{},
      R"(Writes float pixels (H, W), (H, W, 3) or (H, W, 4), row 0 = v 0, as an EXR file, atomically.
The same input gives the same bytes. The channels are Y, RGB or RGBA. Raises ValueError for
wrong shapes, RuntimeError with path and reason if the file cannot be written.)");
  module.def(
      "read_exr", &read_exr, py::arg("path"),
      R"(Returns (pixels, header): float32 (H, W) or (H, W, channels), row 0 = v 0, and a dict with
channels, half, attributes (the header's text attributes).)");
  module.def(
      "encode_png", [](const py::array& pixels) { return py::bytes(encoded_png(pixels)); },
      py::arg("pixels"),
      "The bytes of a PNG file with (H, W) or (H, W, 1 to 4) uint8 or uint16 samples.");
  module.def("write_png", &write_png, py::arg("path"), py::arg("pixels"),
             "Writes (H, W) or (H, W, 1 to 4) uint8 or uint16 samples, row 0 at the bottom.");
}

}  // namespace snowbough::python
