#pragma once

namespace snowbough::tree {

/// Level of detail of a tree's surface.
enum class Detail {
  /// For previews: trunks of eight sides, as few faces as possible in bends.
  kDraft,
  /// For engines that draw many trees.
  kGame,
  /// For artists: trunks of sixteen sides, limbs that bend by less than 25 degrees from face to
  /// face.
  kDefault,
  /// For close-ups: trunks of 32 sides.
  kFilm,
};

/// Parameters of a level of detail.
struct DetailSettings {
  /// Maximum number of sides of a limb: 8, 16 or 32. The thinnest limbs have four.
  int most_sides = 16;
  /// Maximum distance of a side's middle from the round limb, as a fraction of the tree's height:
  /// at a given camera distance, an error in pixels. It determines every limb's number of sides.
  double side_error = 1.5e-4;
  /// Maximum turn of a limb, in radians, from one row of faces to the next but one.
  double turn = 0.17;
  /// The same for limbs of four sides.
  double thin_turn = 0.17;
  /// Maximum deviation of the thinnest limbs' curve from the straight segments between joints, as a
  /// fraction of the tree's height: larger values give softer bends, smaller ones keep the limb's
  /// place, which matters more in close-ups.
  double thin_stray = 5e-4;
  /// Target number of faces: side_error grows until it is met, or no limb has more than four sides.
  /// A tree whose four-sided base has many faces may have `per_base` times that number.
  int faces = 55000;
  double per_base = 2.5;
};

DetailSettings detail_settings(Detail detail);

/// A limb with a radius above this fraction of the tree's height begins with eight sides where it
/// leaves a limb with more than four, since four leave no room for a fillet. Forks of thinner limbs
/// are not visible.
inline constexpr double kMinFork = 4e-4;

}  // namespace snowbough::tree
