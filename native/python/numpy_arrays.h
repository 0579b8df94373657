#pragma once

#include <pybind11/numpy.h>

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace snowbough::python {

/// C-contiguous input; other layouts and dtypes are converted once.
template <typename Scalar>
using InputArray = pybind11::array_t<Scalar, pybind11::array::c_style | pybind11::array::forcecast>;

/// A numpy array with a copy of `count` values. Use this instead of array_t's constructor with a
/// count, and sizeof instead of nbytes and itemsize: with pybind11 before 2.12 and NumPy 2, they
/// take the size of an element for 0.
template <typename Scalar>
pybind11::array_t<Scalar> copied_numpy(const Scalar* values, size_t count) {
  const std::vector<pybind11::ssize_t> shape{static_cast<pybind11::ssize_t>(count)};
  return pybind11::array_t<Scalar>(shape, values);
}

/// Moves a vector into a numpy array of `shape` without copying. `Scalar` is the element type in
/// Python; Element may be a packed struct of Scalars.
template <typename Scalar, typename Element>
pybind11::array_t<Scalar> to_numpy(std::vector<Element>&& values,
                                   std::vector<pybind11::ssize_t> shape) {
  static_assert(sizeof(Element) % sizeof(Scalar) == 0);
  using Owner = std::vector<Element>;
  auto owner = std::make_unique<Owner>(std::move(values));
  auto* data = reinterpret_cast<Scalar*>(owner->data());
  pybind11::capsule capsule(owner.release(), [](void* p) { delete static_cast<Owner*>(p); });
  return pybind11::array_t<Scalar>(std::move(shape), data, std::move(capsule));
}

/// A read-only view of a vector that `owner` keeps alive.
template <typename Scalar, typename Element>
pybind11::array_t<Scalar> view_numpy(const std::vector<Element>& values,
                                     std::vector<pybind11::ssize_t> shape, pybind11::handle owner) {
  static_assert(sizeof(Element) % sizeof(Scalar) == 0);
  pybind11::array_t<Scalar> view(std::move(shape), reinterpret_cast<const Scalar*>(values.data()),
                                 owner);
  pybind11::detail::array_proxy(view.ptr())->flags &=
      ~pybind11::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

/// Largest accepted coordinate, in metres: the product of four still fits a float.
constexpr double kFarthest = 1e9;

/// @throws std::invalid_argument naming `what` and the first row that holds NaN, infinity or a
/// number beyond kFarthest. Does not check integer types.
template <typename Scalar>
void require_finite(const InputArray<Scalar>& array, const std::string& what) {
  if constexpr (std::is_floating_point_v<Scalar>) {
    const Scalar* values = array.data();
    for (pybind11::ssize_t i = 0; i < array.size(); ++i) {
      if (std::abs(static_cast<double>(values[i])) <= kFarthest) continue;
      const pybind11::ssize_t rows = array.ndim() > 0 ? array.shape(0) : 1;
      throw std::invalid_argument(what + ": row " + std::to_string(i / (array.size() / rows)) +
                                  " holds " + std::to_string(values[i]) + ", which is " +
                                  (std::isfinite(values[i]) ? "beyond 1e9" : "not finite"));
    }
  }
}

/// Copies an (N, Columns) array into packed structs. @throws std::invalid_argument naming `what`,
/// also as require_finite.
template <typename Element, typename Scalar, int Columns>
std::vector<Element> rows_from_numpy(const InputArray<Scalar>& array, const std::string& what) {
  static_assert(sizeof(Element) == sizeof(Scalar) * Columns);
  if (array.ndim() != 2 || array.shape(1) != Columns) {
    throw std::invalid_argument(what + " must have shape (N, " + std::to_string(Columns) + ")");
  }
  require_finite(array, what);
  const auto* begin = reinterpret_cast<const Element*>(array.data());
  return std::vector<Element>(begin, begin + array.shape(0));
}

}  // namespace snowbough::python
