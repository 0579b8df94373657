#include <pybind11/stl.h>

#include <utility>

#include "python/render/arrays.h"
#include "python/render/bind_parts.h"
#include "snow/simulation.h"

namespace snowbough::python {
namespace {

using namespace snowbough::render;

/// Returns an empty vector for None.
std::vector<std::array<glm::vec3, 3>> corner_normals(const py::object& normals) {
  if (normals.is_none()) return {};
  const auto array = py::cast<InputArray<float>>(normals);
  require_shape(array, {-1, 3, 3}, "normals");
  return elements<std::array<glm::vec3, 3>>(array);
}

void set_mesh_snow(Renderer& renderer, const std::string& mesh, const py::object& heights,
                   const py::object& uv) {
  MeshSnow snow;
  if (!heights.is_none()) {
    const auto map = py::cast<InputArray<float>>(heights);
    const auto corners = py::cast<InputArray<float>>(uv);
    require_shape(map, {-1, -1}, "heights");
    require_finite(map, "heights");
    require_shape(corners, {-1, 3, 2}, "uv");
    snow = {elements<glm::vec2>(corners), static_cast<int32_t>(map.shape(1)),
            static_cast<int32_t>(map.shape(0)), elements<float>(map)};
  }
  const ReleasedGil release;
  renderer.set_mesh_snow(mesh, snow);
}

SnowSource snow_source(const InputArray<float>& positions, const InputArray<int32_t>& triangles,
                       const InputArray<float>& uv, const py::object& normals, const Vec3& color,
                       int32_t resolution) {
  SnowSource source;
  source.positions = rows_from_numpy<glm::vec3, float, 3>(positions, "positions");
  source.triangles = rows_from_numpy<std::array<int32_t, 3>, int32_t, 3>(triangles, "triangles");
  require_shape(uv, {triangles.shape(0), 3, 2}, "uv");
  source.uv = elements<std::array<glm::vec2, 3>>(uv);
  source.normals = corner_normals(normals);
  source.color = to_vec3(color);
  source.resolution = resolution;
  return source;
}

void add_snow_mesh(Renderer& renderer, const std::string& name, const InputArray<float>& positions,
                   const InputArray<int32_t>& triangles, const InputArray<float>& uv,
                   const py::object& normals, const Vec3& color, int32_t resolution,
                   bool draws_base) {
  SnowSource source = snow_source(positions, triangles, uv, normals, color, resolution);
  source.draws_base = draws_base;
  const ReleasedGil release;
  renderer.add_snow_mesh(name, source);
}

void set_snow_pose(Renderer& renderer, const std::string& name, const InputArray<float>& positions,
                   const py::object& normals) {
  const auto moved = rows_from_numpy<glm::vec3, float, 3>(positions, "positions");
  const auto corners = corner_normals(normals);
  const ReleasedGil release;
  renderer.set_snow_pose(name, moved, corners);
}

void set_snow(Renderer& renderer, const std::string& name, const InputArray<float>& height) {
  require_shape(height, {-1, -1}, "height");
  require_finite(height, "height");
  const HeightMap map{static_cast<int32_t>(height.shape(1)), static_cast<int32_t>(height.shape(0)),
                      elements<float>(height)};
  const ReleasedGil release;
  renderer.set_snow(name, map);
}

bool take_snow(Renderer& renderer, const std::string& name, snow::SnowSimulation& simulation,
               const std::string& object) {
  const ReleasedGil release;
  const std::string& from = object.empty() ? name : object;
  const auto heights = simulation.live_output(from);
  if (heights != nullptr && renderer.share_snow(name, *heights)) return true;
  const int32_t size = simulation.resolution(from);
  renderer.set_snow(name, {size, size, simulation.output(from, false).height});
  return false;
}

py::dict snow_levels(const Renderer& renderer, const std::string& mesh) {
  SnowLevels found;
  {
    const ReleasedGil release;
    found = renderer.snow_levels(mesh);
  }
  const auto count = static_cast<py::ssize_t>(found.classes.size());
  py::dict dict;
  dict["class"] = to_numpy<uint32_t>(std::move(found.classes), {count});
  dict["edge"] = to_numpy<float>(std::move(found.edges), {count, 3});
  return dict;
}

}  // namespace

void bind_render_snow(RendererClass& to) {
  using namespace py::literals;
  to.def("set_mesh_snow", &set_mesh_snow, "mesh"_a, "heights"_a = py::none(), "uv"_a = py::none(),
         R"(Sets the snow on a mesh: heights (H, W) in metres, row 0 at v = 0, and coordinates uv
(T, 3, 2) of its corners. None: no snow.)")
      .def("add_snow_mesh", &add_snow_mesh, "name"_a, "positions"_a, "triangles"_a, "uv"_a,
           "normals"_a = py::none(), "color"_a = Vec3{0.5f, 0.5f, 0.5f}, "resolution"_a = 1024,
           "draws_base"_a = true,
           R"(Adds a mesh that carries snow, bare until set_snow: positions (N, 3), triangles (T,
3), uv (T, 3, 2) in [0, 1], shading normals (T, 3, 3) along which snow grows (None: smooth
everywhere), linear colour of the bare surface. resolution: edge of its map in texels, which
decides how finely the mesh is cut; maps of other sizes are accepted, too. Faces are connected by
shared vertices. draws_base=False: draws only snow, over a mesh of add_mesh.)")
      .def("set_snow_pose", &set_snow_pose, "name"_a, "positions"_a, "normals"_a = py::none(),
           "Moves a mesh with snow: positions (N, 3) and shading normals (T, 3, 3) or None.")
      .def("set_snow", &set_snow, "name"_a, "height"_a,
           R"(Sets the snow on such a mesh, or on a tree (a map of its uv_snow): heights (H, W) in
metres along the shading normals, row 0 = v 0, negative on the back, as from SnowSimulation.output.)")
      .def("take_snow", &take_snow, "name"_a, "simulation"_a, "object"_a = "",
           R"(Copies the current snow of an object of a SnowSimulation (by default of the same name)
to a mesh or a tree. If the simulation's engine is GL on the same device, the map stays on the GPU,
smoothed by the thesis's Gaussian and with its stored thickness (`output` is lower where a surface
is convex, as on twigs), and the result is True; otherwise `output` is used.)")
      .def("snow_levels", &snow_levels, "name"_a,
           R"(As levels, for a mesh with snow and its patches (its triangles, cut where they cover
many texels): 'class' (P,) and 'edge' (P, 3).)");
}

}  // namespace snowbough::python
