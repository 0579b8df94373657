#include <pybind11/stl.h>

#include <optional>
#include <utility>

#include "base/thread_pool.h"
#include "python/render/arrays.h"
#include "python/render/bind_parts.h"

namespace snowbough::python {
namespace {

using namespace snowbough::render;

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
  const ReleasedGil release;
  renderer.add_mesh(name, source);
}

void set_instances(Renderer& renderer, const std::string& name, const InputArray<float>& matrices) {
  const std::vector<glm::mat4> columns = matrices_of(matrices);
  const ReleasedGil release;
  renderer.set_instances(name, columns);
}

py::array_t<float> render_light(Renderer& renderer, const Camera& camera,
                                const RenderSettings& settings, int32_t samples) {
  LightPicture picture;
  {
    const ReleasedGil release;
    picture = renderer.render_light(camera, settings, samples);
  }
  return to_numpy<float>(std::move(picture.rgba), {picture.height, picture.width, 4});
}

py::array_t<float> render_depth(Renderer& renderer, const Camera& camera,
                                const RenderSettings& settings) {
  DepthPicture picture;
  {
    const ReleasedGil release;
    picture = renderer.render_depth(camera, settings);
  }
  return to_numpy<float>(std::move(picture.depth), {picture.height, picture.width});
}

py::object take_frame(Renderer& renderer) {
  std::optional<PackedFrame> frame;
  {
    const ReleasedGil release;
    frame = renderer.take_frame();
  }
  if (!frame) return py::none();
  return py::make_tuple(frame->ticket,
                        to_numpy<float>(std::move(frame->words), {frame->height, frame->width}));
}

py::array_t<uint8_t> render_picture(Renderer& renderer, const Camera& camera,
                                    const RenderSettings& settings) {
  Picture picture;
  {
    const ReleasedGil release;
    picture = renderer.render(camera, settings);
  }
  return to_numpy<uint8_t>(std::move(picture.rgba), {picture.height, picture.width, 4});
}

py::dict statistics(const Renderer& renderer) {
  FrameStatistics frame;
  {
    const ReleasedGil release;
    frame = renderer.statistics();
  }
  py::dict dict;
  dict["dropped"] = frame.dropped;
  dict["plain"] = frame.plain;
  dict["tessellated"] = frame.tessellated;
  dict["triangles"] = frame.triangles;
  dict["dispatches"] = frame.calls.dispatches;
  dict["draws"] = frame.calls.draws;
  dict["buffer_bytes"] = frame.buffer_bytes;
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
    const ReleasedGil release;
    corners = renderer.triangles(tree, camera, settings);
  }
  const auto count = static_cast<py::ssize_t>(corners.size() / 3);
  return to_numpy<float>(std::move(corners), {count, 3, 3});
}

}  // namespace

void bind_render(py::module_& module) {
  using namespace py::literals;
  bind_render_options(module);
  RendererClass renderer(
      module, "Renderer",
      R"(Draws trees and snow off-screen in real time: a tree's four-sided base is uploaded once and
tessellated on the GPU, patch by patch. Needs OpenGL 4.5; works on software renderers, slowly.
Raises RuntimeError if no context can be created, and for every call after close. A context
manager: leaving it closes the renderer.

Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, sections 3.4 and 4.2.2.)");
  renderer
      .def(py::init([](const std::string& device, bool waits) {
             const ReleasedGil release;
             base::start_thread_pool();
             return HeldWithoutGil<Renderer>(new Renderer(device, waits));
           }),
           "device"_a = "", "waits"_a = true,
           R"(waits=False: returns before the context exists, and calls that change the scene return
before the change is done; take_frame raises their errors.)")
      .def("add_mesh", &add_mesh, "name"_a, "vertices"_a, "triangles"_a,
           "color"_a = Vec3{0.5f, 0.5f, 0.5f}, "normals"_a = py::none(), "uv"_a = py::none(),
           "materials"_a = py::none(), "colors"_a = std::vector<Vec3>{},
           "images"_a = std::vector<py::object>{},
           R"(Adds a mesh that is drawn without tessellation, from both sides: vertices (N, 3),
triangles (T, 3); linear colour. Per corner: normals (T, 3, 3) instead of smooth ones, uv (T, 3, 2)
in its images. materials (T,), colors and images as in set_leaves; without colors it has one
material of `color`.)")
      .def("set_instances", &set_instances, "name"_a, "matrices"_a,
           "Sets the instances of a mesh or a tree: (P, 4, 4), a matrix for each from its own "
           "space, or that of the pose, to the world.")
      .def("remove", &Renderer::remove, "name"_a, py::call_guard<ReleasedGil>(),
           "Removes a tree or a mesh.")
      .def("render", &render_picture, "camera"_a, "settings"_a = RenderSettings{},
           R"(A picture, (height, width, 4) uint8: sRGB, alpha 255 where something was drawn, row 0
at the bottom.)")
      .def("render_light", &render_light, "camera"_a, "settings"_a = RenderSettings{},
           "samples"_a = 1,
           "Linear light, (height, width, 4) float32, row 0 at the bottom: the mean of `samples` "
           "pictures,\neach shifted within the pixel's filter. Alpha is the covered fraction of a "
           "pixel; uncovered\npixels have the background's light.")
      .def("render_depth", &render_depth, "camera"_a, "settings"_a = RenderSettings{},
           "OpenGL's depth buffer of a picture, (height, width) float32, row 0 at the bottom: 0 is "
           "the near\nplane; 1 is the far plane and the background.")
      .def("request_frame", &Renderer::request_frame, "camera"_a, "settings"_a = RenderSettings{},
           py::call_guard<ReleasedGil>(),
           "Requests a picture and returns its ticket at once. Replaces a request that has not "
           "started.")
      .def("take_frame", &take_frame,
           R"(The newest picture since the last call, (ticket, (height, width) float32), or None.
Does not wait, but must be called regularly for pictures to arrive. A pixel's bits are 0x3F000000 +
red, green and blue of a byte each: 255 * (c / (1 + c))^(1 / 2.2) of linear light c.)")
      .def_property_readonly("is_busy", &Renderer::is_busy,
                             "Whether a requested picture has not arrived yet.")
      .def_property_readonly("is_ready", &Renderer::is_ready,
                             "Whether `driver` returns without waiting.")
      .def("statistics", &statistics,
           R"(Statistics of the last picture: patches 'dropped', 'plain' and 'tessellated',
'triangles' drawn (without the shadow map), calls of OpenGL ('dispatches' and 'draws') with the
shadow map's, 'buffer_bytes' of all buffers on the GPU, 'wall_seconds' including read-back, 'gpu_seconds', and
'passes': by name 'gpu_seconds', 'wall_seconds' and 'primitives'.)")
      .def("triangles", &triangles, "name"_a, "camera"_a, "settings"_a = RenderSettings{},
           "World positions (T, 3, 3) of a tree's triangles as tessellated for the camera.")
      .def_property_readonly(
          "driver",
          [](const Renderer& self) {
            const gpu::GpuInfo& info = self.info();
            return info.renderer + ", " + info.version;
          },
          "Renderer and version of the driver.")
      .def("close", &Renderer::close, py::call_guard<ReleasedGil>(),
           "Releases everything. Further calls raise RuntimeError.")
      .def(
          "__enter__", [](Renderer& self) -> Renderer& { return self; },
          py::return_value_policy::reference_internal)
      .def("__exit__", [](Renderer& self, const py::args&) {
        const ReleasedGil release;
        self.close();
      });
  bind_render_trees(module, renderer);
  bind_render_snow(renderer);
}

}  // namespace snowbough::python
