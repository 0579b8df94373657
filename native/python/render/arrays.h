#pragma once

#include <array>
#include <cstring>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "python/numpy_arrays.h"
#include "render/data/sources.h"

// Conversion from numpy arrays to the renderer's input. @throws std::invalid_argument naming the
// array with the wrong shape.
namespace snowbough::python {

namespace py = pybind11;
using render::Image;
using render::Material;
using Vec3 = std::array<float, 3>;

inline glm::vec3 to_vec3(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

inline void require_shape(const py::array& array, std::vector<py::ssize_t> shape,
                          const char* what) {
  bool right = array.ndim() == static_cast<py::ssize_t>(shape.size());
  for (size_t k = 0; right && k < shape.size(); ++k) {
    right = shape[k] < 0 || array.shape(static_cast<py::ssize_t>(k)) == shape[k];
  }
  if (right) return;
  std::string text;
  for (const py::ssize_t n : shape) {
    text += (text.empty() ? "" : ", ") + (n < 0 ? std::string("N") : std::to_string(n));
  }
  throw std::invalid_argument(std::string(what) + " must have shape (" + text + ")");
}

template <typename Element, typename Scalar>
std::vector<Element> elements(const InputArray<Scalar>& array) {
  static_assert(sizeof(Element) % sizeof(Scalar) == 0);
  std::vector<Element> made(static_cast<size_t>(array.size()) * sizeof(Scalar) / sizeof(Element));
  std::memcpy(static_cast<void*>(made.data()), array.data(), made.size() * sizeof(Element));
  return made;
}

inline std::vector<glm::mat4> matrices_of(const InputArray<float>& rows) {
  require_shape(rows, {-1, 4, 4}, "matrices");
  require_finite(rows, "matrices");
  std::vector<glm::mat4> matrices = elements<glm::mat4>(rows);
  for (glm::mat4& matrix : matrices) matrix = glm::transpose(matrix);
  return matrices;
}

/// (T, 3, Columns) as one element per corner; None gives an empty vector.
template <typename Element>
std::vector<Element> corners_of(const py::object& given, py::ssize_t triangles, const char* what) {
  if (given.is_none()) return {};
  const auto array = py::cast<InputArray<float>>(given);
  require_shape(array, {triangles, 3, sizeof(Element) / sizeof(float)}, what);
  return elements<Element>(array);
}

inline Image image_of(const py::object& image) {
  if (image.is_none()) return {};
  const auto rgba = py::cast<InputArray<uint8_t>>(image);
  require_shape(rgba, {-1, -1, 4}, "an image");
  return {static_cast<int32_t>(rgba.shape(1)), static_cast<int32_t>(rgba.shape(0)),
          elements<uint8_t>(rgba)};
}

inline std::vector<Material> materials_of(const std::vector<Vec3>& colors,
                                          const std::vector<py::object>& images) {
  if (!images.empty() && images.size() != colors.size()) {
    throw std::invalid_argument("images must have one entry (or None) for each of colors");
  }
  std::vector<Material> materials;
  for (size_t m = 0; m < colors.size(); ++m) {
    materials.push_back({to_vec3(colors[m]), images.empty() ? Image{} : image_of(images[m])});
  }
  return materials;
}

}  // namespace snowbough::python
