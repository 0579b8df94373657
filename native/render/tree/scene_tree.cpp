#include "render/tree/scene_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "render/draw/matrix_rows.h"
#include "shaders/lib/snow_point.h"

namespace snowbough::render {
namespace {

using glm::mat4;
using glm::vec3;
using glm::vec4;

/// Greatest length of the rows of a matrix, as in shaders/tree_classify.comp.glsl.
float stretch_of(const mat4& matrix) {
  float longest = 0.0f;
  for (int row = 0; row < 3; ++row) {
    longest = std::max(longest, glm::length(vec3(matrix[0][row], matrix[1][row], matrix[2][row])));
  }
  return longest;
}

}  // namespace

SceneTree::SceneTree(TreeShared& all, std::shared_ptr<TreeModel> model)
    : all_(all), model_(std::move(model)) {
  pose_.assign(static_cast<size_t>(model_->bone_count), mat4(1.0f));
  const std::vector<vec4> rows = matrix_rows(pose_);
  first_bone_ = all_.bones.add(rows.data(), pose_.size());
  find_bounds();
}

SceneTree::~SceneTree() {
  remove_snow();
  all_.bones.remove(first_bone_, pose_.size());
}

void SceneTree::set_pose(const std::vector<mat4>& matrices) {
  pose_ = matrices;
  const std::vector<vec4> rows = matrix_rows(matrices);
  all_.bones.write(first_bone_, rows.data(), matrices.size());
  find_bounds();
}

void SceneTree::set_instances(const std::vector<mat4>& matrices) {
  matrices_ = matrices;
  find_bounds();
}

void SceneTree::find_bounds() {
  const Box posed = model_->rest.posed(pose_);
  float stretch = 0.0f;
  for (const mat4& bone : pose_) stretch = std::max(stretch, stretch_of(bone));
  bounds_ = Box();
  spheres_.clear();
  for (const mat4& matrix : matrices_) {
    const Box box = posed.moved(matrix);
    bounds_.add(box);
    const float margin = model_->bulge * std::max(stretch * stretch_of(matrix), 1.0f);
    spheres_.emplace_back(box.centre(), 0.5f * glm::length(box.size()) + margin + snow_reach_);
  }
}

void SceneTree::make_map(int32_t width, int32_t height, const SnowLook& look) {
  look_ = look;
  if (map_.x == width && map_.y == height) return;
  remove_snow();
  map_ = all_.snow.add(width, height);
}

void SceneTree::set_snow(int32_t width, int32_t height, const float* heights,
                         const SnowLook& look) {
  make_map(width, height, look);
  all_.snow.write(map_, heights);
  float deepest = 0.0f;
  const float* const end = heights + static_cast<int64_t>(width) * height;
  for (const float* h = heights; h != end; ++h) deepest = std::max(deepest, std::abs(*h));
  snow_reach_ = shared::farthest_offset(deepest, look.style);
  find_bounds();
}

void SceneTree::set_snow(const gpu::Texture& heights, const SnowLook& look) {
  make_map(heights.width(), heights.height(), look);
  all_.snow.copy(map_, heights);
  // Its depth is known only to the GPU.
  snow_reach_ = std::numeric_limits<float>::infinity();
  find_bounds();
}

void SceneTree::remove_snow() {
  if (map_.x > 0) all_.snow.remove(map_);
  map_ = glm::ivec4(0);
  snow_reach_ = 0.0f;
  find_bounds();
}

shared::TreeInstance SceneTree::instance(size_t number) const {
  shared::TreeInstance made = model_->instance();
  const std::vector<vec4> rows = matrix_rows(std::span(&matrices_[number], 1));
  std::copy(rows.begin(), rows.end(), made.to_world);
  made.own.w = first_bone_;
  made.map = map_;
  made.snow = vec4(look_.open, look_.last, 0.0f, 0.0f);
  made.style = look_.style;
  return made;
}

}  // namespace snowbough::render
