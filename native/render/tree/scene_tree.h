#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "render/data/sources.h"
#include "render/draw/arena.h"
#include "render/tree/snow_pages.h"
#include "render/tree/tree_model.h"

namespace snowbough::render {

/// What the trees of a scene share: the poses of all, three matrix rows per bone, and the snow
/// maps.
struct TreeShared {
  explicit TreeShared(int64_t most_bytes) : bones(3 * sizeof(glm::vec4), most_bytes) {}

  Arena bones;
  SnowPages snow;
};

/// A tree of a scene: a model in a pose, with its snow, in one or more instances. GPU thread.
class SceneTree {
 public:
  /// In the rest pose, one instance, without snow. `all` must outlive it.
  SceneTree(TreeShared& all, std::shared_ptr<TreeModel> model);
  ~SceneTree();
  SceneTree(const SceneTree&) = delete;
  SceneTree& operator=(const SceneTree&) = delete;

  const std::shared_ptr<TreeModel>& model() const { return model_; }
  /// `matrices`: one per bone.
  void set_pose(const std::vector<glm::mat4>& matrices);
  void set_instances(const std::vector<glm::mat4>& matrices);
  /// Sets the heights of the snow: width x height, row 0 at v = 0.
  void set_snow(int32_t width, int32_t height, const float* heights, const SnowLook& look);
  void set_snow(const gpu::Texture& heights, const SnowLook& look);
  void remove_snow();
  /// Computes the bounds after the model has changed.
  void find_bounds();

  const std::vector<glm::mat4>& matrices() const { return matrices_; }
  bool has_snow() const { return map_.x > 0; }
  /// Upper bound of the distance between the bark and the snow on it, in metres.
  float snow_reach() const { return snow_reach_; }
  /// The box around its bones' points in all instances.
  const Box& bounds() const { return bounds_; }
  /// A sphere around all that an instance draws; w: the radius.
  const glm::vec4& sphere(size_t number) const { return spheres_[number]; }
  /// The fields of an instance except those of the frame.
  shared::TreeInstance instance(size_t number) const;

 private:
  void make_map(int32_t width, int32_t height, const SnowLook& look);

  TreeShared& all_;
  std::shared_ptr<TreeModel> model_;
  int32_t first_bone_ = 0;
  std::vector<glm::mat4> pose_;
  std::vector<glm::mat4> matrices_{glm::mat4(1.0f)};
  /// Of the snow, as in TreeInstance.
  glm::ivec4 map_{0};
  SnowLook look_;
  float snow_reach_ = 0.0f;
  Box bounds_;
  std::vector<glm::vec4> spheres_;
};

}  // namespace snowbough::render
