#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "map_topology.h"
#include "python/bindings.h"
#include "python/numpy_arrays.h"
#include "python/snow/snow_style.h"
#include "snow/scene/object_set.h"
#include "snow/surface/joints.h"
#include "snow/surface/snow_surface.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

std::vector<float> square_map(const InputArray<float>& height, const char* name) {
  if (height.ndim() != 2 || height.shape(0) != height.shape(1)) {
    throw std::invalid_argument(std::string(name) + " must have shape (resolution, resolution)");
  }
  require_finite(height, name);
  return {height.data(), height.data() + height.size()};
}

/// Converts a receiver, whose triangles are rows of positions.
snow::SurfaceSource surface_source(snow::MapTopology topology, const InputArray<float>& positions,
                                   const std::optional<InputArray<int32_t>>& shading) {
  snow::SurfaceSource source{
      std::move(topology), rows_from_numpy<glm::vec3, float, 3>(positions, "positions"), {}};
  const auto vertices = static_cast<int32_t>(source.positions.size());
  if (source.topology.vertex_count > vertices) {
    throw std::invalid_argument("triangles must name rows of positions");
  }
  source.topology.vertex_count = vertices;
  if (shading) {
    if (shading->size() != static_cast<py::ssize_t>(source.topology.triangles.size())) {
      throw std::invalid_argument("shading must have shape (T, 3)");
    }
    source.shading.assign(shading->data(), shading->data() + shading->size());
    snow::renumber_shading(source.shading);
  }
  return source;
}

using NeighbourArrays =
    std::tuple<InputArray<int32_t>, InputArray<float>, InputArray<float>, InputArray<float>>;

std::vector<snow::Neighbour> neighbours_of(const std::vector<NeighbourArrays>& arrays) {
  std::vector<snow::Neighbour> neighbours;
  for (const auto& [triangles, uv, positions, height] : arrays) {
    require_finite(uv, "uv");
    std::vector<float> heights = square_map(height, "height");
    neighbours.push_back(
        {surface_source(map_topology(triangles, uv, static_cast<int32_t>(height.shape(0))),
                        positions, std::nullopt),
         std::move(heights)});
  }
  return neighbours;
}

void require_positive(double value, const char* name) {
  if (!(value > 0.0 && std::isfinite(value))) {
    throw std::invalid_argument(std::string(name) + " must be a number over 0");
  }
}

/// A surface and its style.
struct BoundSurface {
  snow::SnowSurface surface;
  shared::SnowStyle style = shared::usual_style();
};

std::unique_ptr<BoundSurface> make_surface(
    const InputArray<int32_t>& triangles, const InputArray<float>& uv,
    const InputArray<float>& positions, const InputArray<float>& last,
    const InputArray<float>& highest, float depth,
    const std::optional<InputArray<int32_t>>& shading, float scale, int32_t most_points,
    uint32_t seed, const std::array<float, 2>& wind, const std::optional<InputArray<float>>& dents,
    const std::vector<NeighbourArrays>& neighbours) {
  const std::vector<float> heights = square_map(last, "last");
  require_finite(uv, "uv");
  require_positive(depth, "depth");
  require_positive(scale, "scale");
  require_positive(most_points, "most_points");
  const snow::SurfaceSource source = surface_source(
      map_topology(triangles, uv, static_cast<int32_t>(last.shape(0))), positions, shading);
  const std::vector<float> most = square_map(highest, "highest");
  const std::vector<float> dent = dents ? square_map(*dents, "dents") : std::vector<float>{};
  for (const float part : wind) require_number(part, "wind");
  const std::vector<snow::Neighbour> others = neighbours_of(neighbours);
  const snow::SurfacePlan plan{{depth, scale, most_points}, seed, {wind[0], wind[1]}};
  return without_gil([&] {
    return std::make_unique<BoundSurface>(
        BoundSurface{snow::plan_surface(source, heights, most, dent, plan, others)});
  });
}

std::pair<double, double> wanted_points(const InputArray<int32_t>& triangles,
                                        const InputArray<float>& positions, float depth,
                                        const std::optional<InputArray<int32_t>>& shading) {
  require_positive(depth, "depth");
  InputArray<float> no_uv(std::vector<py::ssize_t>{triangles.size() / 3, 3, 2});
  std::fill_n(no_uv.mutable_data(), no_uv.size(), 0.0f);
  const snow::SurfaceSource source =
      surface_source(map_topology(triangles, no_uv, 2), positions, shading);
  const snow::PointCounts counts = without_gil([&] { return snow::wanted_points(source, depth); });
  return {counts.hems, counts.level};
}

void set_style(BoundSurface& self, const py::kwargs& sliders) {
  self.style = style_from(sliders);
}

py::tuple faces(const BoundSurface& self) {
  const snow::SurfaceFaces& faces = self.surface.faces;
  std::vector<int32_t> begin = faces.begin, corner = faces.corner;
  std::vector<glm::vec2> uv = faces.uv;
  const auto count = static_cast<py::ssize_t>(begin.size());
  const auto corners = static_cast<py::ssize_t>(corner.size());
  return py::make_tuple(to_numpy<int32_t>(std::move(begin), {count}),
                        to_numpy<int32_t>(std::move(corner), {corners}),
                        to_numpy<float>(std::move(uv), {corners, 2}));
}

py::array_t<float> points(const BoundSurface& self, const InputArray<float>& height,
                          float open_depth, const std::optional<InputArray<float>>& positions,
                          const std::array<float, 3>& up,
                          const std::optional<InputArray<float>>& to_result) {
  const std::vector<float> heights = square_map(height, "height");
  if (height.shape(0) != self.surface.samples.resolution) {
    const std::string size = std::to_string(self.surface.samples.resolution);
    throw std::invalid_argument("height must have shape (" + size + ", " + size + ")");
  }
  require_number(open_depth, "open_depth");
  for (const float part : up) require_number(part, "up");
  if (to_result) require_finite(*to_result, "to_result");
  std::vector<glm::vec3> places;
  snow::SurfaceFrame frame{
      heights.data(), open_depth, nullptr, {up[0], up[1], up[2]}, glm::mat4(1.0f)};
  if (positions) {
    const size_t vertices = self.surface.positions.size();
    if (positions->ndim() < 1 || static_cast<size_t>(positions->shape(0)) != vertices) {
      throw std::invalid_argument("positions must have " + std::to_string(vertices) + " rows");
    }
    places = rows_from_numpy<glm::vec3, float, 3>(*positions, "positions");
    frame.positions = places.data();
  }
  if (to_result &&
      (to_result->ndim() != 2 || to_result->shape(0) != 4 || to_result->shape(1) != 4)) {
    throw std::invalid_argument("to_result must have shape (4, 4)");
  }
  if (to_result) frame.to_result = glm::transpose(glm::make_mat4(to_result->data()));
  std::vector<glm::vec3> result =
      without_gil([&] { return snow::surface_points(self.surface, self.style, frame); });
  const auto count = static_cast<py::ssize_t>(result.size());
  return to_numpy<float>(std::move(result), {count, 3});
}

py::array_t<float> point_normals(const InputArray<float>& points,
                                 const InputArray<int32_t>& triangles) {
  const auto places = rows_from_numpy<glm::vec3, float, 3>(points, "points");
  const auto faces = rows_from_numpy<glm::ivec3, int32_t, 3>(triangles, "triangles");
  std::vector<glm::vec3> normals = without_gil([&] { return snow::point_normals(places, faces); });
  const auto count = static_cast<py::ssize_t>(normals.size());
  return to_numpy<float>(std::move(normals), {count, 3});
}

py::array_t<float> nearness_to_joints(const InputArray<float>& points,
                                      const InputArray<int32_t>& triangles, float reach) {
  const auto places = rows_from_numpy<glm::vec3, float, 3>(points, "points");
  const auto faces = rows_from_numpy<glm::ivec3, int32_t, 3>(triangles, "triangles");
  require_positive(reach, "reach");
  std::vector<float> near =
      without_gil([&] { return snow::nearness_to_joints(places, faces, reach); });
  const auto count = static_cast<py::ssize_t>(near.size());
  return to_numpy<float>(std::move(near), {count});
}

}  // namespace

void bind_surface(py::module_& module) {
  module.def(
      "wanted_surface_points", &wanted_points, py::arg("triangles"), py::arg("positions"),
      py::arg("depth"), py::arg("shading") = py::none(),
      R"(Approximate numbers of points that a SnowSurface of a receiver needs at the default detail
under `depth` metres of snow, (at hems and curved places, on level places), from triangles (T, 3),
positions (V, 3) and shading (T, 3) or None.)");
  module.def(
      "point_normals", &point_normals, py::arg("points"), py::arg("triangles"),
      R"(Unit normals (P, 3) of points (P, 3): the mean over their triangles (T, 3), by area. Raises
ValueError for triangles with invalid indices.)");
  module.def(
      "nearness_to_joints", &nearness_to_joints, py::arg("points"), py::arg("triangles"),
      py::arg("reach"),
      R"(How near points (P, 3) of a drawn surface lie to where it goes on within the snow of another
piece: 1 there, 0 from `reach` metres along its triangles (T, 3) on. Raises ValueError for triangles
with invalid indices.)");
  py::class_<BoundSurface>(module, "SnowSurface", "The snow's surface on one receiver.")
      .def(py::init(&make_surface), py::arg("triangles"), py::arg("uv"), py::arg("positions"),
           py::arg("last"), py::arg("highest"), py::arg("depth"), py::arg("shading") = py::none(),
           py::arg("scale") = 1.0f, py::arg("most_points") = 200000, py::arg("seed") = 0,
           py::arg("wind") = std::array<float, 2>{0.0f, 0.0f}, py::arg("dents") = py::none(),
           py::arg("neighbours") = std::vector<NeighbourArrays>{})
      .def("faces", &faces)
      .def(
          "set_style", &set_style,
          R"(Sets the artist's sliders by name (kSliders in snow_style.h). Those that are not given are 1.
Raises TypeError, with all names, for another one.)")
      .def_property_readonly("point_count",
                             [](const BoundSurface& self) { return self.surface.point_count(); })
      .def_property_readonly(
          "coarsened", [](const BoundSurface& self) { return self.surface.coarsened; },
          "Factor by which hems are coarser than `scale` asks for, for lack of points: 1 if not.")
      .def("points", &points, py::arg("height"), py::arg("open_depth"),
           py::arg("positions") = py::none(),
           py::arg("up") = std::array<float, 3>{0.0f, 0.0f, 1.0f},
           py::arg("to_result") = py::none());
}

}  // namespace snowbough::python
