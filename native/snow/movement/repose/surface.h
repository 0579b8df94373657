#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "snow/movement/repose/tile_ground.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// An object's surface in the current pose, for repose.
class ReposeSurface {
 public:
  /// The bare surface of a texel.
  struct Texel {
    glm::vec3 point{0.0f};
    /// Shading normal, times the part of the area on which snow can lie.
    glm::vec3 normal{0.0f};
    float area = 0.0f;
    /// Sum of the principal curvatures in 1/m.
    float curvature = 0.0f;
    /// Upward part of the faces on which snow can lie; if they are too small a part of the texel,
    /// it is a wall.
    float up = 0.0f;
    bool two_sided = false;
  };

  /// Evaluates the triangles; `object`, its texels and `positions` must stay until the last call.
  /// `curved`: also compute curvatures, which are 0 otherwise.
  void set_pose(const SceneObject& object, const TexelTable& table,
                const std::vector<glm::vec3>& positions, bool curved);

  /// Volume in m3 of the unit in which snow moves: a power of two; a texel of mean area under a
  /// metre of snow holds about shared::kUnitsAMetre of them.
  float unit() const { return unit_; }

  /// The point in the pose to which points are relative.
  const glm::vec3& anchor() const { return anchor_; }

  /// `index`: of the texel in the TexelTable.
  Texel texel(int32_t index) const;

  /// Where to write the properties of consecutive texels: the first element of an array each.
  struct Row {
    float *x, *y, *z;
    float* normal_z;
    float* up;
    float* area;
    float* curvature;
    uint8_t* two_sided;

    Row at(size_t i) const {
      return {x + i, y + i, z + i, normal_z + i, up + i, area + i, curvature + i, two_sided + i};
    }
  };
  /// texel() of the `count` texels from `first` on, to the bit; faster where several lie on one
  /// triangle.
  void texels(int32_t first, int32_t count, const Row& to) const;

  /// Fills in a block's cells, after TileGround::begin_pose.
  void fill_block(const ReposeLinks& links, int32_t block, TileGround& ground) const;

  /// A vector that is linear on a triangle: at its first corner, and the differences to the others.
  struct Linear {
    glm::vec3 first, to_second, to_third;
    glm::vec3 at(glm::vec2 weights) const {
      return first + weights.x * to_second + weights.y * to_third;
    }
  };
  /// A point of a triangle, relative to the anchor, by the weights of its second and third corner.
  glm::vec3 point(int32_t triangle, glm::vec2 weights) const {
    return points_of(static_cast<size_t>(triangle)).at(weights);
  }
  glm::vec3 point(const ReposeLinks::Point& at) const { return point(at.triangle, at.weights); }

 private:
  bool on_one_triangle(size_t f, int32_t count, const Row& to) const;
  Linear points_of(size_t triangle) const;
  Linear normals_of(size_t triangle) const;
  glm::vec3 shading_normal(size_t triangle, glm::vec2 weights) const;

  const SceneObject* object_ = nullptr;
  const TexelTable* table_ = nullptr;
  const std::vector<glm::vec3>* positions_ = nullptr;
  /// xyz: normal, w: area in m2.
  std::vector<glm::vec4> triangles_;
  /// By number in the object's shading, see shading_normals.
  std::vector<glm::vec3> normals_;
  /// Of triangles, as in Texel; empty if nothing is shaded smooth or curvatures are not needed.
  std::vector<float> curvatures_;
  glm::vec3 anchor_{0.0f};
  float unit_ = 1.0f;
};

}  // namespace snowbough::snow
