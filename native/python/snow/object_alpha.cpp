#include "object_alpha.h"

#include <pybind11/stl.h>

#include "python/numpy_arrays.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

snow::AlphaMask mask_from_python(const py::handle& image, const std::string& extension) {
  const auto values = InputArray<uint8_t>::ensure(image);
  if (!values || values.ndim() != 2) {
    PyErr_Clear();
    throw std::invalid_argument("an alpha image must have shape (H, W)");
  }
  return snow::make_alpha_mask(
      static_cast<int32_t>(values.shape(1)), static_cast<int32_t>(values.shape(0)),
      snow::alpha_extension(extension), {values.data(), values.data() + values.size()});
}

py::object entry(const py::dict& given, const char* name) {
  if (!given.contains(name)) {
    throw std::invalid_argument(std::string("alpha must have an entry '") + name + "'");
  }
  return given[name];
}

}  // namespace

snow::ObjectAlpha alpha_from_python(const py::object& given, const std::string& name,
                                    py::ssize_t triangles) {
  try {
    const auto dict = py::cast<py::dict>(given);
    const auto uv = InputArray<float>::ensure(entry(dict, "uv"));
    const auto image = InputArray<int32_t>::ensure(entry(dict, "image"));
    const auto images = py::cast<py::list>(entry(dict, "images"));
    const auto extensions = py::cast<std::vector<std::string>>(entry(dict, "extensions"));
    if (!uv || uv.ndim() != 3 || uv.shape(0) != triangles || uv.shape(1) != 3 || uv.shape(2) != 2) {
      PyErr_Clear();
      throw std::invalid_argument("alpha's uv must have shape (T, 3, 2), T = " +
                                  std::to_string(triangles));
    }
    if (!image || image.ndim() != 1 || image.shape(0) != triangles) {
      PyErr_Clear();
      throw std::invalid_argument("alpha's image must have shape (T,), T = " +
                                  std::to_string(triangles));
    }
    if (extensions.size() != images.size()) {
      throw std::invalid_argument("alpha must have one of extensions for each of images");
    }
    snow::ObjectAlpha alpha;
    const auto* corners = reinterpret_cast<const glm::vec2*>(uv.data());
    alpha.corner_uv.assign(corners, corners + uv.size() / 2);
    alpha.mask.assign(image.data(), image.data() + image.size());
    for (size_t i = 0; i < images.size(); ++i) {
      alpha.masks.push_back(
          std::make_shared<const snow::AlphaMask>(mask_from_python(images[i], extensions[i])));
    }
    return alpha;
  } catch (const py::cast_error&) {
    throw std::invalid_argument("object '" + name +
                                "': alpha must be a dict of uv, image, images and extensions");
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("object '" + name + "': " + error.what());
  }
}

}  // namespace snowbough::python
