#include "render/tree/forest.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

/// Upper bound of the growth of patches and leaves, in least widths of a limb in the picture.
constexpr float kGrowth = 6.0f;

bool is_outside(const shared::TreeView& view, const vec3& centre, float radius) {
  return std::any_of(std::begin(view.planes), std::end(view.planes), [&](const vec4& plane) {
    return glm::dot(plane, vec4(centre, 1.0f)) < -radius;
  });
}

int64_t bytes_of(int64_t count, size_t size) {
  return count * static_cast<int64_t>(size);
}

}  // namespace

Forest::Needed Forest::needed(const SceneTree& tree, const Seen& seen,
                              const shared::TreeView& view) const {
  const TreeModel& model = *tree.model();
  const float least = view.tessellation.w;
  // Half of the target is the least width that is tessellated, under snow a sixth (thin_limbs.h).
  const float round_from = view.tessellation.z / ((tree.has_snow() ? 12.0f : 4.0f) * least);
  const bool drops = view.thesis.w < 0.5f && least > 0.0f;
  Needed made;
  made.patches =
      drops ? model.order.needed(seen.scale, tree.snow_reach(), round_from) : model.patch_count();
  if (made.patches > 0) {
    made.vertices = model.used_vertices[static_cast<size_t>(made.patches) - 1];
    made.edges = model.used_edges[static_cast<size_t>(made.patches) - 1];
  }
  for (const LeafPart& part : model.leaves) made.leaves += reached(part.drop_points, seen.scale);
  return made;
}

void Forest::begin_chain(const TreeStore& store, const TreeShared& all) {
  if (used_ == chains_.size()) chains_.emplace_back();
  TreeChain& chain = chains_[used_++];
  chain.store = &store;
  chain.all = &all;
  chain.has_snow = false;
  chain.instances.clear();
  chain.trees.clear();
  chain.vertices.clear();
  chain.edges.clear();
  for (TreeLists* lists : {&chain.camera, &chain.sun}) {
    lists->bark.clear();
    lists->leaves.clear();
  }
  chain.bark_images.clear();
  chain.leaf_parts.clear();
  seen_.clear();
  sums_ = {};
}

void Forest::add(const SceneTree& tree, size_t number, const Seen& seen, const Needed& needed) {
  TreeChain& chain = chains_[used_ - 1];
  const TreeModel& model = *tree.model();
  const gpu::Texture* images = model.bark_images ? &*model.bark_images : nullptr;
  if (!chain.bark_images.empty() && chain.bark_images.back() != images) {
    chain.camera.bark.end_batch();
    chain.sun.bark.end_batch();
  }
  if (chain.bark_images.empty() || chain.bark_images.back() != images) {
    chain.bark_images.push_back(images);
  }
  const auto index = static_cast<int32_t>(chain.instances.size());
  shared::TreeInstance instance = tree.instance(number);
  instance.own.x = sums_.vertices;
  instance.own.y = sums_.edges;
  instance.own.z = sums_.patches;
  chain.instances.push_back(instance);
  chain.trees.push_back(&tree);
  chain.has_snow = chain.has_snow || tree.has_snow();
  chain.vertices.add(index, 0, needed.vertices);
  chain.edges.add(index, 0, needed.edges);
  if (seen.by_camera) chain.camera.bark.add(index, 0, needed.patches);
  if (seen.by_sun) chain.sun.bark.add(index, 0, needed.patches);
  seen_.push_back(seen);
  sums_.vertices += needed.vertices;
  sums_.edges += needed.edges;
  sums_.patches += needed.patches;
  sums_.leaves += needed.leaves;
}

void Forest::add_leaves(TreeChain& chain) {
  for (size_t begin = 0, end = 0; begin < chain.trees.size(); begin = end) {
    const TreeModel* model = chain.trees[begin]->model().get();
    while (end < chain.trees.size() && chain.trees[end]->model().get() == model) ++end;
    for (const LeafPart& part : model->leaves) {
      for (size_t i = begin; i < end; ++i) {
        const int32_t count = reached(part.drop_points, seen_[i].scale);
        const auto index = static_cast<int32_t>(i);
        if (seen_[i].by_camera) chain.camera.leaves.add(index, part.first_triangle, count);
        if (seen_[i].by_sun) chain.sun.leaves.add(index, part.first_triangle, count);
      }
      chain.camera.leaves.end_batch();
      chain.sun.leaves.end_batch();
      chain.leaf_parts.push_back(&part);
    }
  }
}

void Forest::end_chain() {
  if (used_ == 0) return;
  TreeChain& chain = chains_[used_ - 1];
  chain.camera.bark.end_batch();
  chain.sun.bark.end_batch();
  add_leaves(chain);
  make_room(chain.posed, bytes_of(sums_.vertices, sizeof(shared::PosedVertex)));
  make_room(chain.edge_levels, bytes_of(sums_.edges, sizeof(float)));
  make_room(chain.growths, bytes_of(sums_.patches, sizeof(shared::PatchGrowth)));
  chain.instance_buffer.update(chain.instances);
}

void Forest::gather(const std::vector<const SceneTree*>& trees, const TreeShared& all,
                    const shared::TreeView& camera, const shared::TreeView* sun) {
  used_ = 0;
  const float least = camera.tessellation.w;
  for (const SceneTree* tree : trees) {
    for (size_t number = 0; number < tree->matrices().size(); ++number) {
      const vec4& sphere = tree->sphere(number);
      const vec3 centre(sphere);
      const float away = glm::distance(vec3(camera.eye), centre);
      const float radius = sphere.w + kGrowth * least * (away + sphere.w) / camera.eye.w;
      const float nearest = std::max(away - sphere.w, 1e-6f);
      const Seen seen{
          !is_outside(camera, centre, radius), sun != nullptr && !is_outside(*sun, centre, radius),
          least > 0.0f ? camera.eye.w / (nearest * least) : std::numeric_limits<float>::infinity()};
      if (!seen.by_camera && !seen.by_sun) continue;
      const Needed more = needed(*tree, seen, camera);
      if (more.patches + more.leaves == 0) continue;
      const bool fits = bytes_of(int64_t{sums_.vertices} + more.vertices,
                                 sizeof(shared::PosedVertex)) <= most_bytes_ &&
                        bytes_of(int64_t{sums_.patches} + more.patches,
                                 sizeof(shared::PatchGrowth)) <= most_bytes_ &&
                        bytes_of(sums_.leaves + more.leaves, sizeof(glm::ivec2)) <= most_bytes_;
      if (used_ == 0 || chains_[used_ - 1].store != tree->model()->store.get() || !fits) {
        end_chain();
        begin_chain(*tree->model()->store, all);
      }
      add(*tree, number, seen, more);
    }
  }
  end_chain();
}

}  // namespace snowbough::render
