#include <pybind11/stl.h>

#include <array>
#include <cstring>
#include <glm/mat4x4.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/thread_pool.h"
#include "bindings.h"
#include "bound_mesh.h"
#include "choose.h"
#include "numpy_arrays.h"
#include "render/renderer.h"
#include "snow/simulation.h"
#include "tree_source.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

using namespace snowbough::render;
using Vec3 = std::array<float, 3>;

glm::vec3 to_vec3(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

/// Binds a struct of options whose fields keywords set, in the constructor or one by one.
template <typename Options>
class OptionsClass {
 public:
  OptionsClass(py::module_& module, const char* name, const char* doc) : class_(module, name, doc) {
    class_.def(py::init([](const py::kwargs& values) {
      py::object made = py::cast(Options{});
      for (const auto& [key, value] : values) {
        const auto field = py::cast<std::string>(key);
        if (!py::hasattr(made, key)) throw py::type_error("there is no setting '" + field + "'");
        py::setattr(made, key, value);
      }
      return made.cast<Options>();
    }));
  }
  template <typename Value>
  OptionsClass& field(const char* name, Value Options::*member, const char* doc) {
    class_.def_readwrite(name, member, doc);
    return *this;
  }
  OptionsClass& field(const char* name, glm::vec3 Options::*member, const char* doc) {
    class_.def_property(
        name,
        [member](const Options& self) {
          const glm::vec3& v = self.*member;
          return py::make_tuple(v.x, v.y, v.z);
        },
        [member](Options& self, const Vec3& value) { self.*member = to_vec3(value); }, doc);
    return *this;
  }
  py::class_<Options>& python() { return class_; }

 private:
  py::class_<Options> class_;
};

void require_shape(const py::array& array, std::vector<py::ssize_t> shape, const char* what) {
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

/// Empty for None.
std::vector<std::array<glm::vec3, 3>> corner_normals(const py::object& normals) {
  if (normals.is_none()) return {};
  const auto array = py::cast<InputArray<float>>(normals);
  require_shape(array, {-1, 3, 3}, "normals");
  return elements<std::array<glm::vec3, 3>>(array);
}

void add_tree(Renderer& renderer, const std::string& name, const BoundMesh& mesh, float bark_depth,
              const Vec3& bark_dark, const Vec3& bark_light) {
  const py::gil_scoped_release release;
  renderer.add_tree(name, tree_source(mesh.mesh),
                    {bark_depth, to_vec3(bark_dark), to_vec3(bark_light)});
}

void set_pose(Renderer& renderer, const std::string& tree, const InputArray<float>& matrices) {
  require_shape(matrices, {-1, 4, 4}, "matrices");
  std::vector<glm::mat4> columns = elements<glm::mat4>(matrices);
  const py::gil_scoped_release release;
  for (glm::mat4& matrix : columns) matrix = glm::transpose(matrix);
  renderer.set_pose(tree, columns);
}

LeafSource::Image leaf_image(const py::object& image) {
  if (image.is_none()) return {};
  const auto rgba = py::cast<InputArray<uint8_t>>(image);
  require_shape(rgba, {-1, -1, 4}, "a leaf's image");
  return {static_cast<int32_t>(rgba.shape(1)), static_cast<int32_t>(rgba.shape(0)),
          elements<uint8_t>(rgba)};
}

void set_leaves(Renderer& renderer, const std::string& tree, const InputArray<float>& triangles,
                const InputArray<int32_t>& bones, const py::object& uv, const py::object& materials,
                const std::vector<Vec3>& colors, const std::vector<py::object>& images) {
  require_shape(triangles, {-1, 3, 3}, "triangles");
  const py::ssize_t count = triangles.shape(0);
  require_shape(bones, {count}, "bones");
  LeafSource source;
  source.positions = elements<glm::vec3>(triangles);
  source.bone = elements<int32_t>(bones);
  source.uv.resize(source.positions.size(), glm::vec2(0.0f));
  source.material.resize(source.bone.size(), 0);
  if (!uv.is_none()) {
    const auto array = py::cast<InputArray<float>>(uv);
    require_shape(array, {count, 3, 2}, "uv");
    source.uv = elements<glm::vec2>(array);
  }
  if (!materials.is_none()) {
    const auto array = py::cast<InputArray<int32_t>>(materials);
    require_shape(array, {count}, "materials");
    source.material = elements<int32_t>(array);
  }
  if (!images.empty() && images.size() != colors.size()) {
    throw std::invalid_argument("images must have one entry (or None) for each of colors");
  }
  for (size_t m = 0; m < colors.size(); ++m) {
    source.materials.push_back(
        {to_vec3(colors[m]), images.empty() ? LeafSource::Image{} : leaf_image(images[m])});
  }
  const py::gil_scoped_release release;
  renderer.set_leaves(tree, source);
}

void add_mesh(Renderer& renderer, const std::string& name, const InputArray<float>& vertices,
              const InputArray<int32_t>& triangles, const Vec3& color) {
  MeshSource source;
  source.vertices = rows_from_numpy<glm::vec3, float, 3>(vertices, "vertices");
  source.triangles = rows_from_numpy<std::array<int32_t, 3>, int32_t, 3>(triangles, "triangles");
  source.color = to_vec3(color);
  const py::gil_scoped_release release;
  renderer.add_mesh(name, source);
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
                   const py::object& normals, const Vec3& color, int32_t resolution) {
  const SnowSource source = snow_source(positions, triangles, uv, normals, color, resolution);
  const py::gil_scoped_release release;
  renderer.add_snow_mesh(name, source);
}

void set_snow_pose(Renderer& renderer, const std::string& name, const InputArray<float>& positions,
                   const py::object& normals) {
  const auto moved = rows_from_numpy<glm::vec3, float, 3>(positions, "positions");
  const auto corners = corner_normals(normals);
  const py::gil_scoped_release release;
  renderer.set_snow_pose(name, moved, corners);
}

void set_snow(Renderer& renderer, const std::string& name, const InputArray<float>& height) {
  require_shape(height, {-1, -1}, "height");
  const HeightMap map{static_cast<int32_t>(height.shape(1)), static_cast<int32_t>(height.shape(0)),
                      elements<float>(height)};
  const py::gil_scoped_release release;
  renderer.set_snow(name, map);
}

bool take_snow(Renderer& renderer, const std::string& name, snow::SnowSimulation& simulation,
               const std::string& object) {
  const py::gil_scoped_release release;
  const std::string& from = object.empty() ? name : object;
  const auto heights = simulation.live_output(from);
  if (heights != nullptr && renderer.share_snow(name, *heights)) return true;
  const int32_t size = simulation.resolution(from);
  renderer.set_snow(name, {size, size, simulation.output(from, false).height});
  return false;
}

py::array_t<uint8_t> render_picture(Renderer& renderer, const Camera& camera,
                                    const RenderSettings& settings) {
  Picture picture;
  {
    const py::gil_scoped_release release;
    picture = renderer.render(camera, settings);
  }
  return to_numpy<uint8_t>(std::move(picture.rgba), {picture.height, picture.width, 4});
}

py::dict statistics(const Renderer& renderer) {
  FrameStatistics frame;
  {
    const py::gil_scoped_release release;
    frame = renderer.statistics();
  }
  py::dict dict;
  dict["dropped"] = frame.dropped;
  dict["plain"] = frame.plain;
  dict["tessellated"] = frame.tessellated;
  dict["triangles"] = frame.triangles;
  dict["wall_seconds"] = frame.wall_seconds;
  py::dict passes;
  double gpu_seconds = 0.0;
  for (const gpu::PassTime& pass : frame.passes) {
    py::dict one;
    one["gpu_seconds"] = pass.gpu_seconds;
    one["wall_seconds"] = pass.wall_seconds;
    one["primitives"] = pass.primitives;
    passes[py::str(pass.name)] = one;
    gpu_seconds += pass.gpu_seconds;
  }
  dict["gpu_seconds"] = gpu_seconds;
  dict["passes"] = passes;
  return dict;
}

py::array_t<float> triangles(Renderer& renderer, const std::string& tree, const Camera& camera,
                             const RenderSettings& settings) {
  std::vector<glm::vec3> corners;
  {
    const py::gil_scoped_release release;
    corners = renderer.triangles(tree, camera, settings);
  }
  const auto count = static_cast<py::ssize_t>(corners.size() / 3);
  return to_numpy<float>(std::move(corners), {count, 3, 3});
}

py::dict levels(const Renderer& renderer, const std::string& tree) {
  TreeLevels found;
  {
    const py::gil_scoped_release release;
    found = renderer.levels(tree);
  }
  const auto count = static_cast<py::ssize_t>(found.classes.size());
  py::dict dict;
  dict["class"] = to_numpy<uint32_t>(std::move(found.classes), {count});
  dict["edge"] = to_numpy<float>(std::move(found.edges), {count, 4});
  return dict;
}

py::dict snow_levels(const Renderer& renderer, const std::string& mesh) {
  SnowLevels found;
  {
    const py::gil_scoped_release release;
    found = renderer.snow_levels(mesh);
  }
  const auto count = static_cast<py::ssize_t>(found.classes.size());
  py::dict dict;
  dict["class"] = to_numpy<uint32_t>(std::move(found.classes), {count});
  dict["edge"] = to_numpy<float>(std::move(found.edges), {count, 3});
  return dict;
}

void bind_options(py::module_& module) {
  OptionsClass<Camera>(module, "Camera",
                       "A pinhole camera, its fields set by keyword. Metres, radians.")
      .field("eye", &Camera::eye, "Where it stands, (3,).")
      .field("target", &Camera::target, "What it looks at, (3,).")
      .field("up", &Camera::up, "What is up in the picture, (3,).")
      .field("field_of_view", &Camera::field_of_view, "From the bottom to the top, radians.")
      .field("near", &Camera::near, "Metres; 0: from the scene's size.")
      .field("far", &Camera::far, "Metres; 0: from the scene's size.")
      .field("width", &Camera::width, "Pixels.")
      .field("height", &Camera::height, "Pixels.");
  OptionsClass<Snowfall>(module, "Snowfall",
                         "Flakes in the air, its fields set by keyword. Metres, seconds.")
      .field("rate", &Snowfall::rate, "Depth on open level ground in a second; 0: no flakes.")
      .field("direction", &Snowfall::direction, "In which they fall, downwards, (3,).")
      .field("speed", &Snowfall::speed, "Metres a second.")
      .field("flutter", &Snowfall::flutter, "Degrees by which they stray, 0 to 45.")
      .field("radius", &Snowfall::radius, "Of a flake, metres.")
      .field("shutter", &Snowfall::shutter, "How long the picture is exposed, seconds.")
      .field("time", &Snowfall::time, "Of the picture, seconds.")
      .field("seed", &Snowfall::seed, "The same seed and time give the same flakes.");
  OptionsClass<RenderSettings> settings(module, "RenderSettings",
                                        "How a picture is made, its fields set by keyword.");
  settings
      .field("max_level", &RenderSettings::max_level,
             "Most parts of an edge, 1 to 64; 1: all plain.")
      .field("target_pixels", &RenderSettings::target_pixels,
             "SCREEN: pixels that a part of an edge covers.")
      .field("min_pixels", &RenderSettings::min_pixels,
             "Patches that cover fewer pixels are dropped; 0: none.")
      .field("max_distance", &RenderSettings::max_distance,
             "THESIS: metres at which the level has come down to 1.")
      .field("max_area", &RenderSettings::max_area,
             "THESIS: m2 at which the level is highest; 0: the tree's largest patch.")
      .field("snow_factor", &RenderSettings::snow_factor,
             "THESIS, of snow: m of tf = clamp(max(n.up, 0) * m * A, 1, max).")
      .field("wireframe", &RenderSettings::wireframe, "Lines, those behind hidden.")
      .field("cull_back_faces", &RenderSettings::cull_back_faces,
             "Leaves out bark seen from its back.")
      .field("antialias", &RenderSettings::antialias, "Means of 2 x 2 pixels.")
      .field("sun_direction", &RenderSettings::sun_direction, "Towards the sun, (3,).")
      .field("sun_color", &RenderSettings::sun_color, "Linear light on what faces the sun.")
      .field("sky_color", &RenderSettings::sky_color, "Linear light on what faces up.")
      .field("ground_color", &RenderSettings::ground_color, "Linear light on what faces down.")
      .field("snowfall", &RenderSettings::snowfall,
             "Falling flakes, a Snowfall; not in wireframes.")
      .field("shadow_resolution", &RenderSettings::shadow_resolution,
             "Edge of the shadow map in texels; 0: no shadows.");
  settings.python().def_property(
      "metric",
      [](const RenderSettings& self) {
        return self.metric == Metric::kThesis ? "THESIS" : "SCREEN";
      },
      [](RenderSettings& self, const std::string& value) {
        self.metric = choose<Metric>("metric", value,
                                     {{"THESIS", Metric::kThesis}, {"SCREEN", Metric::kScreen}});
      },
      "SCREEN: parts of edges cover target_pixels; THESIS: the thesis's eq. 3.4.1.");
}

}  // namespace

void bind_render(py::module_& module) {
  using namespace py::literals;
  bind_options(module);
  py::class_<Renderer, HeldWithoutGil<Renderer>>(
      module, "Renderer",
      "Draws trees and snow off-screen in real time: a tree's four-sided base is uploaded once and "
      "tessellated\n"
      "on the GPU, patch by patch. Needs OpenGL 4.5; works on software renderers, slowly. Raises\n"
      "RuntimeError where no context can be made, and for every call once it is closed. A context\n"
      "manager: leaving it closes the renderer.\n\n"
      "Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, sections 3.4 and "
      "4.2.2.")
      .def(py::init([](const std::string& device) {
             const py::gil_scoped_release release;
             base::start_thread_pool();
             return HeldWithoutGil<Renderer>(new Renderer(device));
           }),
           "device"_a = "")
      .def("add_tree", &add_tree, "name"_a, "mesh"_a, "bark_depth"_a = TreeLook{}.bark_depth,
           "bark_dark"_a = Vec3{0.045f, 0.03f, 0.02f}, "bark_light"_a = Vec3{0.24f, 0.18f, 0.13f},
           "Adds a TreeMesh of lod=0, in its rest pose. bark_depth: how far bark rises and falls, "
           "as a\n"
           "share of the limb's radius, 0 to 1; colours are linear.")
      .def("set_pose", &set_pose, "tree"_a, "matrices"_a,
           "Poses a tree: (B, 4, 4), for each bone what takes its rest pose to the pose.")
      .def(
          "set_leaves", &set_leaves, "tree"_a, "triangles"_a, "bones"_a, "uv"_a = py::none(),
          "materials"_a = py::none(), "colors"_a = std::vector<Vec3>{{0.1f, 0.25f, 0.05f}},
          "images"_a = std::vector<py::object>{},
          "Gives a tree leaves: triangles (T, 3, 3) in metres in the rest pose, the bone (T,) that "
          "each\n"
          "hangs on, texture coordinates uv (T, 3, 2), materials (T,) as indices into colors\n"
          "(linear) and images ((H, W, 4) uint8, sRGB and alpha, row 0 at the bottom, or None). "
          "What\n"
          "is less than half there by its alpha is a hole.")
      .def("add_mesh", &add_mesh, "name"_a, "vertices"_a, "triangles"_a,
           "color"_a = Vec3{0.5f, 0.5f, 0.5f},
           "Adds a mesh that is drawn as it is: vertices (N, 3), triangles (T, 3), linear colour.")
      .def(
          "add_snow_mesh", &add_snow_mesh, "name"_a, "positions"_a, "triangles"_a, "uv"_a,
          "normals"_a = py::none(), "color"_a = Vec3{0.5f, 0.5f, 0.5f}, "resolution"_a = 1024,
          "Adds a mesh that carries snow, bare until set_snow: positions (N, 3), triangles (T, 3), "
          "uv\n"
          "(T, 3, 2) in [0, 1], shading normals (T, 3, 3) along which snow grows (None: smooth\n"
          "everywhere), linear colour of the bare surface. resolution: texels of its map's edge, "
          "which\n"
          "decides how finely the mesh is cut; maps of other sizes are taken, too. Faces hang "
          "together\n"
          "by the vertices they share.")
      .def("set_snow_pose", &set_snow_pose, "name"_a, "positions"_a, "normals"_a = py::none(),
           "Moves a mesh with snow: positions (N, 3) and shading normals (T, 3, 3) or None.")
      .def("set_snow", &set_snow, "name"_a, "height"_a,
           "The snow on such a mesh, or on a tree (a map of its uv_snow): heights (H, W) in metres "
           "along\n"
           "the shading normals, row 0 = v 0,\n"
           "negative on the back, as SnowSimulation.output gives them.")
      .def("take_snow", &take_snow, "name"_a, "simulation"_a, "object"_a = "",
           "The snow on a mesh as it lies now on an object of a SnowSimulation (by default that of "
           "the\n"
           "same name). Where the simulation's engine is GL and of the same device, the map stays "
           "on "
           "the\n"
           "GPU, rounded by the thesis's Gaussian, and True is returned; else `output` is handed "
           "over.")
      .def("remove", &Renderer::remove, "name"_a, py::call_guard<py::gil_scoped_release>(),
           "Takes a tree or a mesh away.")
      .def("render", &render_picture, "camera"_a, "settings"_a = RenderSettings{},
           "A picture, (height, width, 4) uint8: sRGB, alpha 255 where something was drawn, row 0 "
           "at\n"
           "the bottom.")
      .def("statistics", &statistics,
           "Of the last picture: patches 'dropped', 'plain' and 'tessellated', 'triangles' drawn "
           "(the\n"
           "sun's picture not counted), 'wall_seconds' with reading back, 'gpu_seconds', and "
           "'passes':\n"
           "by name 'gpu_seconds', 'wall_seconds' and 'primitives'.")
      .def("triangles", &triangles, "name"_a, "camera"_a, "settings"_a = RenderSettings{},
           "World positions (T, 3, 3) of the triangles that the camera would be shown of a tree's "
           "bark\nor of a mesh with snow.")
      .def("levels", &levels, "tree"_a,
           "Of the last picture, for the quads of the tree's mesh: 'class' (F,), 0 dropped, 1 "
           "plain, 2\n"
           "tessellated, and 'edge' (F, 4), the level of the edge from each corner to the next.")
      .def(
          "snow_levels", &snow_levels, "name"_a,
          "The same of a mesh with snow, for its patches (its triangles, cut where they cover many "
          "texels):\n'class' (P,) and 'edge' (P, 3).")
      .def_property_readonly(
          "driver",
          [](const Renderer& self) {
            const gpu::GpuInfo& info = self.info();
            return info.renderer + ", " + info.version;
          },
          "Renderer and version of the driver.")
      .def("close", &Renderer::close, py::call_guard<py::gil_scoped_release>(),
           "Releases everything. Further calls raise RuntimeError.")
      .def(
          "__enter__", [](Renderer& self) -> Renderer& { return self; },
          py::return_value_policy::reference_internal)
      .def("__exit__", [](Renderer& self, const py::args&) {
        const py::gil_scoped_release release;
        self.close();
      });
}

}  // namespace snowbough::python
