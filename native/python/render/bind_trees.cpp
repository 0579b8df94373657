#include <pybind11/stl.h>

#include <utility>

#include "python/bound_mesh.h"
#include "python/render/arrays.h"
#include "python/render/bind_parts.h"
#include "python/render/tree_source.h"

namespace snowbough::python {
namespace {

using namespace snowbough::render;

void add_tree(Renderer& renderer, const std::string& name, const py::object& tree, float bark_depth,
              const Vec3& bark_dark, const Vec3& bark_light) {
  const TreeSource source = py::isinstance<py::dict>(tree)
                                ? tree_source(py::cast<py::dict>(tree))
                                : tree_source(py::cast<const BoundMesh&>(tree).mesh);
  const ReleasedGil release;
  renderer.add_tree(name, source, {bark_depth, to_vec3(bark_dark), to_vec3(bark_light)});
}

void set_pose(Renderer& renderer, const std::string& tree, const InputArray<float>& matrices) {
  const std::vector<glm::mat4> columns = matrices_of(matrices);
  const ReleasedGil release;
  renderer.set_pose(tree, columns);
}

void set_bark(Renderer& renderer, const std::string& tree, const InputArray<float>& uv,
              const InputArray<int32_t>& materials, const std::vector<Vec3>& colors,
              const std::vector<py::object>& images) {
  require_shape(uv, {-1, 4, 2}, "uv");
  require_shape(materials, {uv.shape(0)}, "materials");
  const BarkSource source{elements<std::array<glm::vec2, 4>>(uv), elements<int32_t>(materials),
                          materials_of(colors, images)};
  const ReleasedGil release;
  renderer.set_bark(tree, source);
}

void set_leaves(Renderer& renderer, const std::string& tree, const InputArray<float>& triangles,
                const InputArray<int32_t>& bones, const py::object& uv, const py::object& materials,
                const std::vector<Vec3>& colors, const std::vector<py::object>& images) {
  require_shape(triangles, {-1, 3, 3}, "triangles");
  require_finite(triangles, "triangles");
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
  const ReleasedGil release;
  renderer.set_leaves(tree, source);
}

py::dict levels(const Renderer& renderer, const std::string& tree) {
  TreeLevels found;
  {
    const ReleasedGil release;
    found = renderer.levels(tree);
  }
  const auto count = static_cast<py::ssize_t>(found.classes.size());
  py::dict dict;
  dict["class"] = to_numpy<uint32_t>(std::move(found.classes), {count});
  dict["edge"] = to_numpy<float>(std::move(found.edges), {count, 4});
  return dict;
}

}  // namespace

void bind_render_trees(py::module_& module, RendererClass& to) {
  using namespace py::literals;
  module.def(
      "tree_arrays", [](const BoundMesh& mesh) { return tree_arrays(tree_source(mesh.mesh)); },
      "mesh"_a,
      R"(The input of Renderer.add_tree from a TreeMesh of detail BASE, as arrays by name, for storing
in a file.)");
  to.def("add_tree", &add_tree, "name"_a, "mesh"_a, "bark_depth"_a = TreeLook{}.bark_depth,
         "bark_dark"_a = Vec3{0.045f, 0.03f, 0.02f}, "bark_light"_a = Vec3{0.24f, 0.18f, 0.13f},
         R"(Adds a BASE TreeMesh, or its tree_arrays, in its rest pose. bark_depth: amplitude of
the bark's displacement as a fraction of the limb's radius, 0 to 1; colours are linear.)")
      .def("share_tree", &Renderer::share_tree, "name"_a, "tree"_a, py::call_guard<ReleasedGil>(),
           R"(Adds a tree that shares base, bark and leaves with another one, in its rest pose and
without snow. Both are drawn by the same calls; a change of bark or leaves changes both.)")
      .def("set_bark", &set_bark, "tree"_a, "uv"_a, "materials"_a, "colors"_a,
           "images"_a = std::vector<py::object>{},
           R"(Gives a tree's bark images instead of its two colours: coordinates uv (Q, 4, 2) of the
corners of the base's quads, materials (Q,), colors and images as in set_leaves. The bark's
displacement stays.)")
      .def("set_pose", &set_pose, "tree"_a, "matrices"_a,
           "Poses a tree: (B, 4, 4), one matrix per bone from its rest pose to the pose.")
      .def("set_leaves", &set_leaves, "tree"_a, "triangles"_a, "bones"_a, "uv"_a = py::none(),
           "materials"_a = py::none(), "colors"_a = std::vector<Vec3>{{0.1f, 0.25f, 0.05f}},
           "images"_a = std::vector<py::object>{},
           R"(Gives a tree leaves: triangles (T, 3, 3) in metres in the rest pose, the bone (T,) of
each, texture coordinates uv (T, 3, 2), materials (T,) as indices into colors (linear) and images
((H, W, 4) uint8, sRGB and alpha, row 0 at the bottom, or None). An alpha below one half makes a
hole.)")
      .def("levels", &levels, "tree"_a,
           R"(Levels of the last picture, per quad of the tree's mesh: 'class' (F,), 0 dropped, 1
plain, 2 tessellated, and 'edge' (F, 4), the level of the edge from each corner to the next.)");
}

}  // namespace snowbough::python
