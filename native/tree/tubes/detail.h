#pragma once

namespace snowbough::tree {

/// How fine a tree's surface is.
enum class Detail {
  /// For looking at: trunks of eight sides, bends as few faces as they need.
  kDraft,
  /// For engines that draw many trees.
  kGame,
  /// What an artist wants to see first: trunks of sixteen sides, limbs that bend by less than 25
  /// degrees from face to face.
  kDefault,
  /// For close-ups: trunks of 32 sides.
  kFilm,
};

/// What a level of detail asks for.
struct DetailSettings {
  /// Most sides of a limb: 8, 16 or 32. The thinnest have four.
  int most_sides = 16;
  /// How far the middle of a side may lie inside the round limb, as a share of the tree's height:
  /// at a given distance of the camera, in pixels. The sides of every limb follow from it.
  double side_error = 1.5e-4;
  /// A limb turns by at most this many radians from one row of faces to the next but one.
  double turn = 0.17;
  /// The same for limbs of four sides.
  double thin_turn = 0.17;
  /// How far the curve of the thinnest limbs may stray from their joints' straight segments, as a
  /// share of the tree's height: the further, the softer it bends. From close by less is seen of
  /// the bends and more of the limb's place.
  double thin_stray = 5e-4;
  /// Faces that the level aims at: side_error grows until they are enough, or no limb has more
  /// than four sides. A tree whose four-sided base has many faces may have `per_base` times those.
  int faces = 55000;
  double per_base = 2.5;
};

DetailSettings detail_settings(Detail detail);

/// A limb thicker than this share of the tree's height, as radius, begins with eight sides where it
/// leaves one with more than four: with four there is no room for a fillet. The forks of thinner
/// ones nobody sees.
inline constexpr double kLeastFork = 4e-4;

}  // namespace snowbough::tree
