#pragma once

#include <cstdint>
#include <limits>
#include <numbers>

#include "snow/step/engine/engine_request.h"

namespace snowbough::snow {

/// Settings of a simulation. A new number is a field here and a row of kNumberSettings, which says
/// what it means.
struct SimulationSettings {
  double pixel_size = 0.01;
  double noise_density = 1.0;
  double flutter = 0.0;
  double max_depth = 1.0;
  double slide_half_life = 2.0;
  double repose = 65.0 / 180.0 * std::numbers::pi;
  double cohesion = 0.0;
  double adhesion = 0.0;
  double rising = 0.0;
  double density = 100.0;
  double sun_share = 0.7;
  double unevenness = 0.25;
  double rain = 0.0;
  double soak = 0.002;
  double wet_spread = 0.05;
  double drying = 4.0;
  double drift = 0.0;
  double blur_radius = 0.0;
  double throw_speed = 0.3;
  double spread = 0.12;
  double heap_grain = 0.06;
  uint32_t seed = 0;
  /// Whether snow that leaves a map lands on what lies below, and meets the snow of other
  /// receivers, if repose is on; and whether its fall takes time.
  bool landing = true;
  bool fall_time = true;
  /// Whether heaps are as round and as steep as those of sand: see ReposeLimits::is_granular.
  bool granular = false;
  /// Whether to follow melted snow and rain as water: see MeltSettings.
  bool wet = false;
  /// Whether to record what flies: see SnowSimulation::take_flying.
  bool points = false;
  /// Largest edge of an occlusion tile in pixels: a power of two from 64 to 4096. It changes memory
  /// use and speed, never the result.
  int32_t tile_size = 2048;
  /// Engine that runs the passes; see EngineChoice.
  EngineRequest engine = {};
  /// True: the constructor waits for the engine and throws if there is none. False: the first call
  /// that needs the engine does so, and objects can be added while the driver loads.
  bool wait_for_gpu = true;
};

/// A setting that is a number. Checks and the Python module read these rows.
struct NumberSetting {
  /// Name in Python.
  const char* name;
  double SimulationSettings::*field;
  /// Valid values, as numbers and in words.
  double least = 0.0;
  double most = std::numeric_limits<double>::max();
  const char* range;
  /// For the Python docstring.
  const char* meaning;
  /// Whether change_settings can change it.
  bool can_change = true;
};

/// The smallest number over 0.
inline constexpr double kOverZero = std::numeric_limits<double>::denorm_min();

inline constexpr NumberSetting kNumberSettings[] = {
    {.name = "pixel_size",
     .field = &SimulationSettings::pixel_size,
     .least = kOverZero,
     .range = "over 0 metres",
     .meaning = "edge of an occlusion pixel",
     .can_change = false},
    {.name = "noise_density",
     .field = &SimulationSettings::noise_density,
     .least = kOverZero,
     .most = 1.0,
     .range = "over 0 and at most 1",
     .meaning = "fraction of pixels that receive snow in a step; these receive 1 / noise_density "
                "times as much"},
    {.name = "flutter",
     .field = &SimulationSettings::flutter,
     .most = 1.5708,
     .range = "0 to pi / 2 radians",
     .meaning = "largest angle between a flake's path and the fall direction. At pi / 2 dust comes "
                "from the whole sky, most from above, as the light of an even sky does"},
    {.name = "max_depth",
     .field = &SimulationSettings::max_depth,
     .range = "0 metres or more",
     .meaning = "depth that level ground holds before snow slides"},
    {.name = "slide_half_life",
     .field = &SimulationSettings::slide_half_life,
     .range = "0 seconds or more",
     .meaning = "time in which the snow beyond a slope's capacity halves"},
    {.name = "repose",
     .field = &SimulationSettings::repose,
     .least = kOverZero,
     .most = 1.5708,
     .range = "over 0 and at most pi / 2 radians",
     .meaning = "angle of repose from level: steeper snow moves to lower neighbours or falls over "
                "a rim, which counts as slid, and walls lose their snow within a second. At pi / 2 "
                "snow stays where it fell, also on walls"},
    {.name = "cohesion",
     .field = &SimulationSettings::cohesion,
     .range = "0 metres or more",
     .meaning = "height at which a vertical snow face stays up. Smooth surfaces that curve about "
                "as tightly as that, such as twigs, carry steeper snow"},
    {.name = "adhesion",
     .field = &SimulationSettings::adhesion,
     .most = 1.0,
     .range = "0 to 1",
     .meaning = "fraction of max_depth that sticks to walls and undersides"},
    {.name = "rising",
     .field = &SimulationSettings::rising,
     .most = 1.0,
     .range = "0 to 1",
     .meaning =
         "depth that comes from below onto open undersides, as a fraction of what falls onto "
         "level ground"},
    {.name = "density",
     .field = &SimulationSettings::density,
     .least = 1.0,
     .most = 20000.0,
     .range = "1 to 20000 kg/m3",
     .meaning = "density of the snow, which gives so much water"},
    {.name = "sun_share",
     .field = &SimulationSettings::sun_share,
     .most = 1.0,
     .range = "0 to 1",
     .meaning = "part of the thaw of open ground that comes from the sun"},
    {.name = "unevenness",
     .field = &SimulationSettings::unevenness,
     .most = 1.0,
     .range = "0 to 1",
     .meaning = "how uneven snow melts: in patches, and faster beside bare ground"},
    {.name = "rain",
     .field = &SimulationSettings::rain,
     .most = 1.0,
     .range = "0 to 1 metre per second",
     .meaning = "water that falls on open ground, along the direction of the snow; it only wets"},
    {.name = "soak",
     .field = &SimulationSettings::soak,
     .least = 1e-6,
     .most = 1.0,
     .range = "0.000001 to 1 metre",
     .meaning = "water that a surface soaks up before more runs off"},
    {.name = "wet_spread",
     .field = &SimulationSettings::wet_spread,
     .most = 10.0,
     .range = "0 to 10 metres",
     .meaning = "distance over which water soaks sideways in a second"},
    {.name = "drying",
     .field = &SimulationSettings::drying,
     .least = kOverZero,
     .range = "over 0 seconds",
     .meaning = "half-life of water on bare ground in the sun"},
    {.name = "drift",
     .field = &SimulationSettings::drift,
     .most = 100.0,
     .range = "0 to 100 m2 per second",
     .meaning = "lying snow that the wind carries past each metre across it on open ground, in m3 "
                "per second; 0: no drifts"},
    {.name = "blur_radius",
     .field = &SimulationSettings::blur_radius,
     .range = "0 metres or more",
     .meaning = "standard deviation of the blur of output; the stored map stays unblurred",
     .can_change = false},
    {.name = "throw_speed",
     .field = &SimulationSettings::throw_speed,
     .most = 100.0,
     .range = "0 to 100 metres per second",
     .meaning = "horizontal speed at which snow leaves an edge"},
    {.name = "spread",
     .field = &SimulationSettings::spread,
     .most = 10.0,
     .range = "0 to 10",
     .meaning = "slope by which falling snow spreads to all sides"},
    {.name = "heap_grain",
     .field = &SimulationSettings::heap_grain,
     .least = 1e-4,
     .most = 100.0,
     .range = "0.0001 to 100 metres",
     .meaning = "radius over which falling snow lands"},
};

}  // namespace snowbough::snow
