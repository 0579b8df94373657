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
  /// One of the four quads around the smaller hole at a knuckle's side; the parent limb's.
  kInset,
  /// The quad that closes a tip or a root.
  kTipCap,
  kRootCap,
};

/// Where a quad comes from. A limb is one branch (index into Skeleton::branches).
///
/// Corners of a wall quad: 0 = ring `row`, corner `side`; 1 = ring `row`, corner `side + 1`; 2 =
/// ring `row + 1`, corner `side + 1`; 3 = ring `row + 1`, corner `side` (corner numbers modulo 4).
/// An inset quad has the knuckle side's edge from corner `inset` to `inset + 1` (numbered as in
/// that wall quad) as corners 0 and 1, and the hole's edge as corners 2 and 3. Caps: `row` is the
/// number of rows of the limb for kTipCap and 0 for kRootCap; corner 0 is the ring's corner 0.
///
/// A limb's ring 0 is the root's own ring, the parent's end ring (continues_parent), or the hole in
/// the parent's side: the knuckle side's own corners 0..3 in the order of the wall quad that is
/// missing there, or the inner corners of its inset.
struct FaceOrigin {
  /// The branch whose strip the quad lies in.
  int32_t branch = -1;
  /// Row along the limb: the quad spans ring `row` to ring `row + 1`, counted from the limb's root.
  int32_t row = 0;
  /// Side 0..3 around the limb, anticlockwise seen from the tip; for kInset the knuckle's side that
  /// it fills, for caps 0.
  int32_t side = 0;
  /// For kInset 0..3: which edge of the knuckle's side it lies along; otherwise 0.
  int32_t inset = 0;
  FacePart part = FacePart::kWall;
};

/// The stretch of a limb between two of its rings, as a round cone on an infinite line. Metres.
struct LimbSection {
  glm::dvec3 begin{0.0};
  /// Unit vector.
  glm::dvec3 axis{0.0};
  double length = 0.0;
  double begin_radius = 0.0;
  double end_radius = 0.0;
  /// Begins at a hole in a parent's side: becomes round over its first width only, or the heel of a
  /// branch that leaves at a flat angle would swell out of its parent.
  bool from_hole = false;
  /// Branches that continue one another are one limb.
  int32_t limb = -1;
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
  /// Per quad; with lod > 0 each base quad's 4^lod parts follow one another and share its origin.
  std::vector<FaceOrigin> origins;
  /// Per branch: 1 where its strip goes on from its parent's end ring, 0 where it grows out of a
  /// hole in the parent's side or is a root.
  std::vector<uint8_t> continues_parent;
  /// Per branch: rows of its strip at level 0; its rings are 0..branch_rows.
  std::vector<int32_t> branch_rows;
  /// Of the four-sided base alone, else empty: the limbs' round shape, branch_rows a branch.
  std::vector<LimbSection> sections;
  /// Per vertex: up to four bones, weight 0 where unused; weights sum to 1.
  std::vector<std::array<int32_t, 4>> bone_indices;
  std::vector<std::array<float, 4>> bone_weights;
  Bones bones;
  /// Things the user should know (children clamped to their parent, room that was short).
  std::vector<std::string> warnings;
};

}  // namespace snowbough::tree
