#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/resources.h"
#include "render/draw/cached_buffer.h"
#include "render/draw/patch_lists.h"
#include "render/draw/work_list.h"
#include "render/tree/scene_tree.h"

namespace snowbough::render {

/// The patches and leaves of a chain that one picture shows.
struct TreeLists {
  /// A batch per set of bark images. All trees without images are in the first batches.
  PatchList bark;
  /// A batch per material.
  PatchList leaves;
};

/// Instances of trees that go through one chain of passes, with the buffers of a frame.
struct TreeChain {
  const TreeStore* store = nullptr;
  const TreeShared* all = nullptr;
  /// True if one of its trees has snow.
  bool has_snow = false;
  std::vector<shared::TreeInstance> instances;
  /// Of each instance.
  std::vector<const SceneTree*> trees;
  WorkList vertices;
  WorkList edges;
  TreeLists camera;
  TreeLists sun;
  /// Of each batch of bark: its images, or null.
  std::vector<const gpu::Texture*> bark_images;
  /// Of each batch of leaves.
  std::vector<const LeafPart*> leaf_parts;

  CachedBuffer<shared::TreeInstance> instance_buffer;
  gpu::Buffer posed{0};
  gpu::Buffer edge_levels{0};
  /// Of the patches in the lists, the same for every view from one eye.
  gpu::Buffer growths{0};
};

/// The instances of trees in a frame. It leaves out trees outside the pictures, and of distant
/// trees the patches and leaves that are certainly dropped. So the work of a frame depends on how
/// much of the trees is seen, and the number of passes only on the size of the buffers: instances
/// go into one chain as long as its buffers fit into a storage block.
class Forest {
 public:
  /// `most_bytes`: greatest size of a buffer.
  explicit Forest(int64_t most_bytes) : most_bytes_(most_bytes) {}

  /// `sun`: null if the frame draws no shadow map.
  void gather(const std::vector<const SceneTree*>& trees, const TreeShared& all,
              const shared::TreeView& camera, const shared::TreeView* sun);
  std::span<TreeChain> chains() { return {chains_.data(), used_}; }
  std::span<const TreeChain> chains() const { return {chains_.data(), used_}; }

 private:
  /// An instance in a frame: the pictures that show it, and its largest scale, see drop_point.
  struct Seen {
    bool by_camera = false;
    bool by_sun = false;
    float scale = 0.0f;
  };
  /// Numbers of an instance's items that are needed.
  struct Needed {
    int32_t vertices = 0;
    int32_t edges = 0;
    int32_t patches = 0;
    int64_t leaves = 0;
  };
  Needed needed(const SceneTree& tree, const Seen& seen, const shared::TreeView& view) const;
  void add(const SceneTree& tree, size_t number, const Seen& seen, const Needed& needed);
  void begin_chain(const TreeStore& store, const TreeShared& all);
  void add_leaves(TreeChain& chain);
  void end_chain();

  int64_t most_bytes_;
  std::vector<TreeChain> chains_;
  size_t used_ = 0;
  /// Of the instances of the last chain in use, and the sums of their items.
  std::vector<Seen> seen_;
  Needed sums_;
};

}  // namespace snowbough::render
