#include "object_description.h"

#include <cmath>

#include "map_topology.h"
#include "object_alpha.h"
#include "python/choose.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

std::vector<int32_t> shading_of(const py::object& given, py::ssize_t triangles,
                                const std::string& who) {
  const auto numbers = py::cast<InputArray<int32_t>>(given);
  if (numbers.ndim() != 2 || numbers.shape(0) != triangles || numbers.shape(1) != 3) {
    throw std::invalid_argument(who +
                                "shading must have shape (T, 3), T = " + std::to_string(triangles));
  }
  return {numbers.data(), numbers.data() + numbers.size()};
}

}  // namespace

snow::ObjectDescription describe_object(const std::string& name,
                                        const InputArray<int32_t>& triangles,
                                        const InputArray<float>& uv, int32_t resolution,
                                        bool receive, bool occlude, const py::object& rest,
                                        const std::optional<double>& blur_radius,
                                        const py::object& alpha, const py::object& shading,
                                        const std::string& sides) {
  const std::string who = "object '" + name + "': ";
  snow::ObjectDescription description;
  description.name = name;
  description.topology = map_topology(triangles, uv, resolution, who);
  description.receive = receive;
  description.occlude = occlude;
  if (blur_radius.has_value()) {
    if (!std::isfinite(*blur_radius) || *blur_radius < 0.0) {
      throw std::invalid_argument(who + "blur_radius must be 0 metres or more");
    }
    description.blur_radius = *blur_radius;
  }
  if (!rest.is_none()) {
    description.rest =
        rows_from_numpy<glm::vec3, float, 3>(py::cast<InputArray<float>>(rest), who + "rest");
  }
  if (!alpha.is_none()) {
    description.alpha = alpha_from_python(alpha, name, triangles.shape(0));
  }
  if (!shading.is_none()) {
    description.shading = shading_of(shading, triangles.shape(0), who);
  }
  description.sides = choose<snow::Sides>(who + "sides", sides,
                                          {{"AUTO", snow::Sides::kAuto},
                                           {"POSITIVE", snow::Sides::kPositive},
                                           {"BOTH", snow::Sides::kBoth}});
  return description;
}

}  // namespace snowbough::python
