#include <algorithm>
#include <stdexcept>
#include <utility>

#include "render/draw/matrix_rows.h"
#include "render/scene.h"

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

}  // namespace

Scene::Tree::Tree(const TreePatches& patches, const TreeLook& its_look)
    : buffers(patches),
      look(its_look),
      bone_count(patches.bone_count),
      levels(patches.levels),
      has_snow_places(patches.has_snow_places),
      largest_area(patches.largest_area),
      rest(patches.bone_count),
      camera_view(sizeof(shared::TreeView)),
      sun_view(sizeof(shared::TreeView)) {
  for (const shared::TreePatch& patch : patches.patches) {
    patch_edges.push_back(patch.edges);
  }
  for (const shared::TreeVertex& vertex : patches.vertices) {
    for (int k = 0; k < 4; ++k) {
      if (vertex.weights[k] > 0.0f) rest.add(vertex.bones[k], vec3(vertex.position));
    }
  }
  bounds = rest.at_rest();
}

Scene::Tree& Scene::tree(const std::string& name) const {
  const auto found = trees_.find(name);
  if (found == trees_.end()) throw std::invalid_argument("there is no tree '" + name + "'");
  return *found->second;
}

void Scene::add_tree(const std::string& name, const TreePatches& patches, const TreeLook& look) {
  ++revision_;
  require_new(name);
  trees_[name] = std::make_unique<Tree>(patches, look);
}

void Scene::set_leaves(const std::string& name, const LeafSource& leaves) {
  ++revision_;
  Tree& of = tree(name);
  LeafBuffers made(leaves, of.bone_count);
  of.leaves.reset();
  of.leaves.emplace(std::move(made));
  for (size_t i = 0; i < leaves.positions.size(); ++i) {
    of.rest.add(leaves.bone[i / 3], leaves.positions[i]);
    of.bounds.add(leaves.positions[i]);
  }
}

void Scene::set_bark(const std::string& name, const BarkSource& bark) {
  Tree& of = tree(name);
  of.buffers.images.emplace(bark, of.patch_edges.size());
}

void Scene::set_pose(const std::string& name, const std::vector<glm::mat4>& matrices) {
  ++revision_;
  Tree& of = tree(name);
  if (matrices.size() != static_cast<size_t>(of.bone_count)) {
    throw std::invalid_argument("tree '" + name + "' needs " + std::to_string(of.bone_count) +
                                " bone matrices, not " + std::to_string(matrices.size()));
  }
  const std::vector<vec4> rows = matrix_rows(matrices);
  of.buffers.bones.write(0, static_cast<int64_t>(rows.size() * sizeof(vec4)), rows.data());
  of.bounds = of.rest.posed(matrices);
}

Scene::Tree& Scene::tree_with_places(const std::string& name) const {
  Tree& of = tree(name);
  if (!of.has_snow_places) {
    throw std::invalid_argument("tree '" + name +
                                "' has no snow map coordinates: add it with snow_uv");
  }
  return of;
}

void Scene::set_snow(const std::string& name, const TreeSnow& snow) {
  ++revision_;
  Tree& of = tree_with_places(name);
  // Trees without snow use the shaders without snow.
  const bool is_bare = std::all_of(snow.values.begin(), snow.values.end(),
                                   [](float height) { return height == 0.0f; });
  if (is_bare) return of.buffers.set_snow(nullptr, snow.depths);
  auto map = std::make_shared<gpu::Texture>(GL_R32F, snow.width, snow.height, 0, GL_LINEAR);
  map->write(0, GL_RED, GL_FLOAT, snow.values.data());
  of.buffers.set_snow(std::move(map), snow.depths);
}

void Scene::share_snow(const std::string& name, std::shared_ptr<const gpu::Texture> heights,
                       const SnowDepths& depths) {
  ++revision_;
  tree_with_places(name).buffers.set_snow(std::move(heights), depths);
}

void Scene::prepare_trees(const RenderSettings& settings) {
  const auto each = [&](const char* pass, auto&& work) {
    const auto measured = timer_.measure(pass);
    for (const auto& [name, of] : trees_) work(*of);
  };
  each("pose", [&](Tree& of) { passes_.pose(of.buffers, of.camera_view); });
  each("edges", [&](Tree& of) { passes_.edge_levels(of.buffers, of.camera_view); });
  each("classify", [&](Tree& of) {
    passes_.patches.classify(of.buffers, of.buffers.camera, of.camera_view, settings.max_level);
    if (of.leaves) {
      leaf_passes_.classify(*of.leaves, &LeafBuffers::Part::camera, of.buffers.bones,
                            of.camera_view);
    }
  });
}

TreeLevels Scene::levels(const std::string& name) const {
  const Tree& of = tree(name);
  if (!statistics_) throw std::runtime_error("levels: render a picture first");
  const auto edges = of.buffers.edge_levels.read_all<float>();
  TreeLevels levels;
  levels.classes = of.buffers.camera.classes.read_all<uint32_t>();
  for (const glm::ivec4& patch : of.patch_edges) {
    levels.edges.push_back(
        {edges[patch.x >> 1], edges[patch.y >> 1], edges[patch.z >> 1], edges[patch.w >> 1]});
  }
  return levels;
}

}  // namespace snowbough::render
