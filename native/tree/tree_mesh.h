#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace snowbough::tree {

/// Which part of a limb's strip a quad is: what the UV layout and the LODs need to know.
enum class FacePart : uint8_t {
  /// Side wall of a limb between two consecutive rings.
  kWall,
  /// One of the four quads around the smaller hole at a knuckle's side; belongs to the parent's limb.
  kInset,
  /// The quad that closes a tip or a root.
  kTipCap,
  kRootCap,
};

/// Where a quad comes from. A limb is one branch (index into Skeleton::branches).
struct FaceOrigin {
  /// The branch whose strip the quad lies in.
  int32_t branch = -1;
  /// Row along the limb: the quad spans ring `row` to ring `row + 1`, counted from the limb's root.
  int32_t row = 0;
  /// Side 0..3 around the limb; for kInset the knuckle's side that it fills, for caps 0.
  int32_t side = 0;
  /// For kInset 0..3: which edge of the knuckle's side it lies along; otherwise 0.
  int32_t inset = 0;
  FacePart part = FacePart::kWall;
};

/// The bones of the armature: one a skeleton segment, parents before children.
struct Bones {
  std::vector<glm::vec3> heads;
  std::vector<glm::vec3> tails;
  /// -1 for a root bone.
  std::vector<int32_t> parents;
  /// "<branch>.<segment>", unique.
  std::vector<std::string> names;
  /// Index of the branch the bone belongs to, and that branch's level.
  std::vector<int32_t> branches;
  std::vector<int32_t> levels;
  /// Limb radius at head and tail in metres.
  std::vector<float> head_radii;
  std::vector<float> tail_radii;
};

using Quad = std::array<int32_t, 4>;
using QuadUv = std::array<glm::vec2, 4>;

/// One closed, rigged, unwrapped surface around a skeleton. Metres, Z up, right-handed; quads wind
/// anticlockwise seen from outside.
struct TreeMesh {
  std::vector<glm::vec3> vertices;
  std::vector<Quad> quads;
  /// Per quad corner, in the order of `quads`; v = 0 at the bottom.
  std::vector<QuadUv> uv_bark;
  std::vector<QuadUv> uv_snow;
  std::vector<int32_t> branch_level;
  std::vector<FaceOrigin> origins;
  /// Per vertex: up to four bones, weight 0 where unused; weights sum to 1.
  std::vector<std::array<int32_t, 4>> bone_indices;
  std::vector<std::array<float, 4>> bone_weights;
  Bones bones;
  /// Things the user should know (children clamped to their parent, room that was short).
  std::vector<std::string> warnings;
};

}  // namespace snowbough::tree
