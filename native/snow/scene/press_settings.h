#pragma once

namespace snowbough::snow {

/// What an object does to the snow that it touches.
struct PressSettings {
  enum class Kind {
    kNone,
    /// It packs snow below itself and pushes a part aside: feet, wheels.
    kPress,
    /// It pushes all snow ahead and aside: blades.
    kPlough,
    /// It removes the snow: brooms, hands, wipers.
    kClear,
  };
  Kind kind = Kind::kNone;
  /// Density in kg/m3 up to which snow is packed, at least kFreshDensity; packed snow carries.
  double packed_density = 400.0;
  /// Fraction of the displaced snow that is pushed aside instead of packed.
  double pushed_aside = 0.2;
  /// Radius in metres over which snow that is pushed aside spreads.
  double rim_width = 0.05;
  /// Height in metres up to which walls of packed snow stand.
  double walls_stand = 0.3;
  /// Whether it stops the wind that carries snow, whatever `kind` is; a tree does not.
  bool blocks_wind = true;
};

/// Density of fresh snow in kg/m3.
inline constexpr double kFreshDensity = 100.0;

}  // namespace snowbough::snow
