#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/movement/hashed.h"

namespace snowbough::snow {

/// Snow that has begun to fly in a step: what falls off an edge or a bough, until it lands, and
/// what a blade throws up, until it comes down. It is for show only; where the snow itself is, the
/// other passes know.
struct FlyingSnow {
  /// Index of the receiver that it has left.
  int32_t object = 0;
  /// World position in metres and velocity in m/s at the end of the step.
  glm::vec3 point{0.0f};
  glm::vec3 velocity{0.0f};
  /// m3 of fresh snow.
  float volume = 0.0f;
  /// Until it lands; snow that falls in a snowfall may be on its map sooner.
  float seconds = 0.0f;
};

inline constexpr double kGravity = 9.81;

/// A cube of space and a step, for random numbers.
struct FlightSeed {
  std::array<int64_t, 3> cube{};
  uint32_t step = 0;
  int ray = 0;
  /// Of this flight, 0 to 1.
  double number(uint64_t salt) const { return hashed(cube, step, ray, salt); }
};

/// Adds snow that left `flight.point` with `flight.velocity` at a random time within the last `dt`
/// seconds and flies for `flight.seconds`.
inline void add_flight(FlyingSnow flight, const FlightSeed& seed, double dt,
                       std::vector<FlyingSnow>& flying) {
  constexpr uint64_t kTimeSalt = 7;
  const auto age = static_cast<float>(dt * seed.number(kTimeSalt));
  if (!(age < flight.seconds)) return;
  const auto gravity = static_cast<float>(kGravity);
  flight.point += age * flight.velocity;
  flight.point.z -= 0.5f * gravity * age * age;
  flight.velocity.z -= gravity * age;
  flight.seconds -= age;
  flying.push_back(flight);
}

}  // namespace snowbough::snow
