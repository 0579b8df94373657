#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

namespace snowbough::tree {

/// The part of a limb's strip to which a quad belongs, for UV layout and levels of detail.
enum class FacePart : uint8_t {
  /// Side wall of a limb between two consecutive rings.
  kWall,
  /// One of the four quads around a smaller hole in a knuckle's side; belongs to the parent limb.
  kInset,
  /// The quad that closes a tip, or a root.
  kTipCap,
  kRootCap,
};

/// The origin of a quad. A limb is one branch (index into Skeleton::branches).
///
/// Corners of a wall quad: 0 = ring `row`, corner `side`; 1 = ring `row`, corner `side + 1`; 2 =
/// ring `row + 1`, corner `side + 1`; 3 = ring `row + 1`, corner `side` (corner numbers modulo 4).
/// An inset quad has the knuckle side's edge from corner `inset` to `inset + 1` (numbered as in
/// that wall quad) as corners 0 and 1, and the hole's edge as corners 2 and 3. Caps: `row` is the
/// number of rows of the limb for kTipCap and 0 for kRootCap; corner 0 is the ring's corner 0.
///
/// A limb's ring 0 is the root's own ring, the parent's end ring (continues_parent), or the hole in
/// the parent's side: the corners 0..3 of the knuckle side in the order of the missing wall quad,
/// or the inner corners of its inset.
struct FaceOrigin {
  /// The branch of the quad's strip.
  int32_t branch = -1;
  /// Row along the limb: the quad spans ring `row` to ring `row + 1`, counted from the limb's root.
  int32_t row = 0;
  /// Side 0..3 around the limb, anticlockwise seen from the tip; for kInset the knuckle's side, for
  /// caps 0.
  int32_t side = 0;
  /// For kInset 0..3: the edge of the knuckle's side along which it lies; otherwise 0.
  int32_t inset = 0;
  FacePart part = FacePart::kWall;

  bool operator==(const FaceOrigin&) const = default;
};

/// The section of a limb between two rings, as a round cone on an infinite line. Metres.
struct LimbSection {
  glm::dvec3 begin{0.0};
  /// Unit vector.
  glm::dvec3 axis{0.0};
  double length = 0.0;
  double begin_radius = 0.0;
  double end_radius = 0.0;
  /// Begins at a hole in a parent's side: it becomes round only over its first width, otherwise a
  /// branch that leaves at a flat angle would bulge out of its parent at its heel.
  bool from_hole = false;
};

/// The bones of the armature: one per skeleton segment, parents before children.
struct Bones {
  std::vector<glm::vec3> heads;
  std::vector<glm::vec3> tails;
  /// -1 for a root bone.
  std::vector<int32_t> parents;
  /// "<branch>.<segment>", unique.
  std::vector<std::string> names;
  /// The bone's branch, and that branch's level.
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
  /// Per quad; with a detail the parts of a base quad are consecutive and share its origin.
  std::vector<FaceOrigin> origins;
  /// Per branch: 1 if its strip continues its parent's end ring, 0 if it starts at a hole in the
  /// parent's side or is a root.
  std::vector<uint8_t> continues_parent;
  /// Per branch: the branch whose surface it leaves, or -1. Of two stems with one parent in the
  /// skeleton, the second may leave the first.
  std::vector<int32_t> branch_parents;
  /// Per branch: number of rows of its strip at level 0; its rings are 0..branch_rows.
  std::vector<int32_t> branch_rows;
  /// Only of the four-sided base, else empty: the limbs' round shape, branch_rows entries per
  /// branch.
  std::vector<LimbSection> sections;
  /// Per vertex: up to four bones, weight 0 where unused; weights sum to 1.
  std::vector<std::array<int32_t, 4>> bone_indices;
  std::vector<std::array<float, 4>> bone_weights;
  Bones bones;
  /// Messages for the user (children clamped to their parent, missing room).
  std::vector<std::string> warnings;
  /// With a detail: the four-sided base from which the mesh was refined.
  std::shared_ptr<const TreeMesh> base;
};

}  // namespace snowbough::tree
