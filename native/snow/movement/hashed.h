#pragma once

#include <array>
#include <cstdint>

namespace snowbough::snow {

/// A uniform number from 0 to 1 from a cube of space, a step and a ray (a counter-based hash:
/// finaliser of splitmix64, G. Steele, D. Lea, C. Flood, Fast splittable pseudorandom number
/// generators, 2014).
inline double hashed(const std::array<int64_t, 3>& key, uint32_t step, int ray, uint64_t salt) {
  uint64_t h = salt * 0x9E3779B97F4A7C15u + step;
  const auto mix = [&](uint64_t value) {
    h ^= value + 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
    h ^= h >> 31;
  };
  for (const int64_t part : key) mix(static_cast<uint64_t>(part));
  mix(static_cast<uint64_t>(ray));
  return static_cast<double>(h >> 11) * 0x1p-53;
}

}  // namespace snowbough::snow
