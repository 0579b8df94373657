#include <pybind11/stl.h>

#include <array>
#include <cstring>
#include <glm/mat4x4.hpp>
#include <memory>
#include <optional>
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

void add_tree(Renderer& renderer, const std::string& name, const py::object& tree, float bark_depth,
              const Vec3& bark_dark, const Vec3& bark_light) {
  const TreeSource source = py::isinstance<py::dict>(tree)
                                ? tree_source(py::cast<py::dict>(tree))
                                : tree_source(py::cast<const BoundMesh&>(tree).mesh);
  const py::gil_scoped_release release;
  renderer.add_tree(name, source, {bark_depth, to_vec3(bark_dark), to_vec3(bark_light)});
}

std::vector<glm::mat4> matrices_of(const InputArray<float>& rows) {
  require_shape(rows, {-1, 4, 4}, "matrices");
  std::vector<glm::mat4> matrices = elements<glm::mat4>(rows);
  for (glm::mat4& matrix : matrices) matrix = glm::transpose(matrix);
  return matrices;
}

void set_pose(Renderer& renderer, const std::string& tree, const InputArray<float>& matrices) {
  const std::vector<glm::mat4> columns = matrices_of(matrices);
  const py::gil_scoped_release release;
  renderer.set_pose(tree, columns);
}

Image image_of(const py::object& image) {
  if (image.is_none()) return {};
  const auto rgba = py::cast<InputArray<uint8_t>>(image);
  require_shape(rgba, {-1, -1, 4}, "an image");
  return {static_cast<int32_t>(rgba.shape(1)), static_cast<int32_t>(rgba.shape(0)),
          elements<uint8_t>(rgba)};
}

std::vector<Material> materials_of(const std::vector<Vec3>& colors,
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
  source.materials = materials_of(colors, images);
  const py::gil_scoped_release release;
  renderer.set_leaves(tree, source);
}

/// (T, 3, Columns) as one element a corner; None: none.
template <typename Element>
std::vector<Element> corners_of(const py::object& given, py::ssize_t triangles, const char* what) {
  if (given.is_none()) return {};
  const auto array = py::cast<InputArray<float>>(given);
  require_shape(array, {triangles, 3, sizeof(Element) / sizeof(float)}, what);
  return elements<Element>(array);
}

void add_mesh(Renderer& renderer, const std::string& name, const InputArray<float>& vertices,
              const InputArray<int32_t>& triangles, const Vec3& color, const py::object& normals,
              const py::object& uv, const py::object& materials, const std::vector<Vec3>& colors,
              const std::vector<py::object>& images) {
  MeshSource source;
  source.vertices = rows_from_numpy<glm::vec3, float, 3>(vertices, "vertices");
  source.triangles = rows_from_numpy<std::array<int32_t, 3>, int32_t, 3>(triangles, "triangles");
  const auto count = static_cast<py::ssize_t>(source.triangles.size());
  source.normals = corners_of<glm::vec3>(normals, count, "normals");
  source.uv = corners_of<glm::vec2>(uv, count, "uv");
  if (!materials.is_none()) {
    const auto array = py::cast<InputArray<int32_t>>(materials);
    require_shape(array, {count}, "materials");
    source.material = elements<int32_t>(array);
  }
  source.materials = materials_of(colors.empty() ? std::vector<Vec3>{color} : colors, images);
  const py::gil_scoped_release release;
  renderer.add_mesh(name, source);
}

void set_places(Renderer& renderer, const std::string& mesh, const InputArray<float>& matrices) {
  const std::vector<glm::mat4> columns = matrices_of(matrices);
  const py::gil_scoped_release release;
  renderer.set_places(mesh, columns);
}

void set_mesh_snow(Renderer& renderer, const std::string& mesh, const py::object& heights,
                   const py::object& uv) {
  MeshSnow snow;
  if (!heights.is_none()) {
    const auto map = py::cast<InputArray<float>>(heights);
    const auto corners = py::cast<InputArray<float>>(uv);
    require_shape(map, {-1, -1}, "heights");
    require_shape(corners, {-1, 3, 2}, "uv");
    snow = {elements<glm::vec2>(corners), static_cast<int32_t>(map.shape(1)),
            static_cast<int32_t>(map.shape(0)), elements<float>(map)};
  }
  const py::gil_scoped_release release;
  renderer.set_mesh_snow(mesh, snow);
}

py::array_t<float> render_light(Renderer& renderer, const Camera& camera,
                                const RenderSettings& settings, int32_t samples) {
  LightPicture picture;
  {
    const py::gil_scoped_release release;
    picture = renderer.render_light(camera, settings, samples);
  }
  return to_numpy<float>(std::move(picture.rgba), {picture.height, picture.width, 4});
}

py::object take_frame(Renderer& renderer) {
  std::optional<PackedFrame> frame;
  {
    const py::gil_scoped_release release;
    frame = renderer.take_frame();
  }
  if (!frame) return py::none();
  return py::make_tuple(frame->ticket,
                        to_numpy<float>(std::move(frame->words), {frame->height, frame->width}));
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

/// A 4 x 4 matrix, rows first as numpy writes them, or None.
template <typename Options>
void matrix_field(OptionsClass<Options>& to, const char* name,
                  std::optional<glm::mat4> Options::*member, const char* doc) {
  to.python().def_property(
      name,
      [member](const Options& self) -> py::object {
        const std::optional<glm::mat4>& matrix = self.*member;
        if (!matrix) return py::none();
        const glm::mat4 rows = glm::transpose(*matrix);
        return py::array_t<float>({4, 4}, &rows[0][0]);
      },
      [member](Options& self, const py::object& value) {
        (self.*member).reset();
        if (value.is_none()) return;
        const auto rows = py::cast<InputArray<float>>(value);
        require_shape(rows, {4, 4}, "a matrix");
        self.*member = glm::transpose(elements<glm::mat4>(rows)[0]);
      },
      doc);
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
  OptionsClass<Camera> camera(module, "Camera",
                              "A camera, its fields set by keyword: a pinhole, or whatever two "
                              "matrices say. Metres, radians.");
  camera.field("eye", &Camera::eye, "Where it stands, (3,).")
      .field("target", &Camera::target, "What it looks at, (3,).")
      .field("up", &Camera::up, "What is up in the picture, (3,).")
      .field("field_of_view", &Camera::field_of_view, "From the bottom to the top, radians.")
      .field("near", &Camera::near, "Metres; 0: from the scene's size.")
      .field("far", &Camera::far, "Metres; 0: from the scene's size.")
      .field("width", &Camera::width, "Pixels.")
      .field("height", &Camera::height, "Pixels.");
  matrix_field(
      camera, "view", &Camera::view,
      "(4, 4) from the world to the camera's space, as OpenGL's; with `projection` instead "
      "of all but the size.");
  matrix_field(camera, "projection", &Camera::projection,
               "(4, 4) from the camera's space to clip space, in perspective or orthographic.");
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
      .field("draft", &RenderSettings::draft,
             "Of frames: keeps the shadow map of the frame before where only the camera moved.")
      .field("sun_direction", &RenderSettings::sun_direction, "Towards the sun, (3,).")
      .field("sun_color", &RenderSettings::sun_color, "Linear light on what faces the sun.")
      .field("sky_color", &RenderSettings::sky_color, "Linear light on what faces up.")
      .field("ground_color", &RenderSettings::ground_color, "Linear light on what faces down.")
      .field("snowfall", &RenderSettings::snowfall,
             "Falling flakes, a Snowfall; not in wireframes.")
      .field("shadow_resolution", &RenderSettings::shadow_resolution,
             "Edge of the shadow map in texels; 0: no shadows.");
  settings.python().def_property(
      "background",
      [](const RenderSettings& self) -> py::object {
        if (!self.background) return py::none();
        return py::make_tuple(self.background->x, self.background->y, self.background->z);
      },
      [](RenderSettings& self, const std::optional<Vec3>& value) {
        self.background.reset();
        if (value) self.background = to_vec3(*value);
      },
      "Linear light behind everything, (3,); None: the sky's.");
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
  module.def(
      "tree_arrays", [](const BoundMesh& mesh) { return tree_arrays(tree_source(mesh.mesh)); },
      "mesh"_a,
      "What Renderer.add_tree needs of a TreeMesh of lod=0, as arrays by name that a file can "
      "keep.");
  py::class_<Renderer, HeldWithoutGil<Renderer>>(
      module, "Renderer",
      "Draws trees and snow off-screen in real time: a tree's four-sided base is uploaded once and "
      "tessellated\n"
      "on the GPU, patch by patch. Needs OpenGL 4.5; works on software renderers, slowly. Raises\n"
      "RuntimeError where no context can be made, and for every call once it is closed. A context\n"
      "manager: leaving it closes the renderer.\n\n"
      "Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, sections 3.4 and "
      "4.2.2.")
      .def(
          py::init([](const std::string& device, bool waits) {
            const py::gil_scoped_release release;
            base::start_thread_pool();
            return HeldWithoutGil<Renderer>(new Renderer(device, waits));
          }),
          "device"_a = "", "waits"_a = true,
          "waits=False: returns before there is a context, and so do all calls that change what is "
          "drawn\nbefore that is done; what goes wrong is raised by take_frame.")
      .def("add_tree", &add_tree, "name"_a, "mesh"_a, "bark_depth"_a = TreeLook{}.bark_depth,
           "bark_dark"_a = Vec3{0.045f, 0.03f, 0.02f}, "bark_light"_a = Vec3{0.24f, 0.18f, 0.13f},
           "Adds a TreeMesh of lod=0, or what tree_arrays gave for it, in its rest pose. "
           "bark_depth: how far bark rises and falls, "
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
      .def(
          "add_mesh", &add_mesh, "name"_a, "vertices"_a, "triangles"_a,
          "color"_a = Vec3{0.5f, 0.5f, 0.5f}, "normals"_a = py::none(), "uv"_a = py::none(),
          "materials"_a = py::none(), "colors"_a = std::vector<Vec3>{},
          "images"_a = std::vector<py::object>{},
          "Adds a mesh that is drawn as it is, from both sides: vertices (N, 3), triangles (T, 3); "
          "linear\ncolour. By corner: normals (T, 3, 3) in place of smooth ones, uv (T, 3, 2) in "
          "its images. materials\n(T,), colors and images as set_leaves's; without colors it has "
          "one material of `color`.")
      .def("set_places", &set_places, "mesh"_a, "matrices"_a,
           "Where a mesh is: (P, 4, 4), a matrix a place from its own space to the world.")
      .def("set_mesh_snow", &set_mesh_snow, "mesh"_a, "heights"_a = py::none(), "uv"_a = py::none(),
           "Lets snow lie on a mesh: heights (H, W) in metres, row 0 at v = 0, and coordinates uv "
           "(T, 3, 2)\nof its corners there. None: no snow.")
      .def(
          "add_snow_mesh", &add_snow_mesh, "name"_a, "positions"_a, "triangles"_a, "uv"_a,
          "normals"_a = py::none(), "color"_a = Vec3{0.5f, 0.5f, 0.5f}, "resolution"_a = 1024,
          "draws_base"_a = true,
          "Adds a mesh that carries snow, bare until set_snow: positions (N, 3), triangles (T, 3), "
          "uv\n"
          "(T, 3, 2) in [0, 1], shading normals (T, 3, 3) along which snow grows (None: smooth\n"
          "everywhere), linear colour of the bare surface. resolution: texels of its map's edge, "
          "which\n"
          "decides how finely the mesh is cut; maps of other sizes are taken, too. Faces hang "
          "together\n"
          "by the vertices they share. draws_base=False: only snow is drawn, over a mesh that "
          "add_mesh "
          "draws.")
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
      .def("render_light", &render_light, "camera"_a, "settings"_a = RenderSettings{},
           "samples"_a = 1,
           "Linear light, (height, width, 4) float32, row 0 at the bottom: means of pictures that "
           "are shifted\nwithin a pixel's filter. Alpha is the share in which something was drawn; "
           "the rest shows the\nbackground's light.")
      .def(
          "request_frame", &Renderer::request_frame, "camera"_a, "settings"_a = RenderSettings{},
          py::call_guard<py::gil_scoped_release>(),
          "Asks for a picture and returns its ticket at once; one that was asked for before and is "
          "not begun\nis forgotten.")
      .def("take_frame", &take_frame,
           "The newest picture that has arrived since the last call, (ticket, (height, width) "
           "float32), or None.\nWaits for nothing; pictures arrive only while it is called from "
           "time to time. A pixel's bits are\n0x3F000000 + red, green and blue of a byte each: 255 "
           "* (c / (1 + c))^(1 / 2.2) of linear light c.")
      .def_property_readonly("is_busy", &Renderer::is_busy,
                             "Whether a picture that was asked for has not arrived yet.")
      .def_property_readonly("is_ready", &Renderer::is_ready,
                             "Whether `driver` can be asked without waiting.")
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
