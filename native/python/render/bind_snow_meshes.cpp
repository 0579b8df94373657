#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>

#include "python/render/arrays.h"
#include "python/render/bind_parts.h"
#include "python/snow/snow_style.h"
#include "snow/simulation.h"

namespace snowbough::python {
namespace {

using namespace snowbough::render;

void add_snow_mesh(Renderer& renderer, const std::string& name, const InputArray<float>& vertices,
                   const InputArray<int32_t>& triangles, const py::object& normals) {
  MeshSource source;
  source.vertices = rows_from_numpy<glm::vec3, float, 3>(vertices, "vertices");
  source.triangles = rows_from_numpy<std::array<int32_t, 3>, int32_t, 3>(triangles, "triangles");
  source.normals =
      corners_of<glm::vec3>(normals, static_cast<py::ssize_t>(source.triangles.size()), "normals");
  source.is_snow = true;
  const ReleasedGil release;
  renderer.add_mesh(name, source);
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

void set_snow(Renderer& renderer, const std::string& tree, const InputArray<float>& height,
              float open_depth, std::optional<float> last_depth, const py::kwargs& sliders) {
  require_shape(height, {-1, -1}, "height");
  require_finite(height, "height");
  const TreeSnow snow{static_cast<int32_t>(height.shape(1)),
                      static_cast<int32_t>(height.shape(0)),
                      elements<float>(height),
                      {open_depth, last_depth.value_or(open_depth), style_from(sliders)}};
  const ReleasedGil release;
  renderer.set_snow(tree, snow);
}

bool take_snow(Renderer& renderer, const std::string& tree, snow::SnowSimulation& simulation,
               float open_depth, const std::string& object, std::optional<float> last_depth) {
  const SnowLook look{open_depth, last_depth.value_or(open_depth), shared::usual_style()};
  const ReleasedGil release;
  const std::string& from = object.empty() ? tree : object;
  const auto heights = simulation.live_output(from);
  if (heights != nullptr && renderer.share_snow(tree, *heights, look)) return true;
  const int32_t size = simulation.resolution(from);
  renderer.set_snow(tree, {size, size, simulation.output(from).height, look});
  return false;
}

}  // namespace

void bind_render_snow(RendererClass& to) {
  using namespace py::literals;
  to.def("set_mesh_snow", &set_mesh_snow, "mesh"_a, "heights"_a = py::none(), "uv"_a = py::none(),
         "Sets the snow on a mesh: a map of heights (H, W) in metres, row 0 at v = 0, and the "
         "coordinates\nuv (T, 3, 2) of the mesh's corners on it. None removes the snow.")
      .def("add_snow_mesh", &add_snow_mesh, "name"_a, "vertices"_a, "triangles"_a,
           "normals"_a = py::none(),
           "Adds a mesh that is shaded as snow, such as the surface from SnowSurface: vertices "
           "(N, 3) in metres,\ntriangles (T, 3), anticlockwise seen from outside; normals "
           "(T, 3, 3) per corner instead of smooth\nones. Otherwise as add_mesh.")
      .def("set_snow", &set_snow, "tree"_a, "height"_a, "open_depth"_a, "last_depth"_a = py::none(),
           "Sets the snow on a tree: a map of heights (H, W) along the normals in metres for its "
           "uv_snow, row 0\n= v 0, as from SnowSimulation.output; the depth on open level ground "
           "in metres, now and at the\nshot's end (by default the same). The shape of the snow is "
           "that of SnowSurface, whose sliders it takes by\nname.")
      .def("take_snow", &take_snow, "tree"_a, "simulation"_a, "open_depth"_a, "object"_a = "",
           "last_depth"_a = py::none(),
           "Sets the snow on a tree from an object of a SnowSimulation (by default the object of "
           "the same name).\nIf the simulation uses engine GL on the same device, the map stays on "
           "the GPU and True is\nreturned: the thesis's Gaussian smooths it, and heights are "
           "thicknesses (in `output` they are\nlower on convex surfaces such as twigs). Otherwise "
           "the map is that of `output`.");
}

}  // namespace snowbough::python
