#include "tree/crossings/fingerprints.h"

#include <bit>

namespace snowbough::tree {
namespace {

/// Hash in which each of 64 bits changes about half of the result's.
///
/// Source: S. Vigna's SplitMix64, after G. L. Steele, D. Lea and C. H. Flood, "Fast Splittable
/// Pseudorandom Number Generators", OOPSLA 2014.
uint64_t mixed(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

uint64_t mixed(uint64_t print, uint64_t next) {
  return mixed(print * 0x9e3779b97f4a7c15u + next);
}

}  // namespace

Fingerprints::Fingerprints(const Surface& surface)
    : surface_(surface), number_(surface.vertices.size(), -1) {}

uint64_t Fingerprints::of(std::span<const int32_t> faces) {
  const int64_t first = next_;
  uint64_t print = faces.size();
  for (const int32_t face : faces) {
    for (const int32_t v : surface_.quads[face]) {
      if (number_[v] >= first) {
        print = mixed(print, static_cast<uint64_t>(number_[v] - first));
        continue;
      }
      // A new vertex is hashed by its position in floats, as in the intersection tests.
      number_[v] = next_++;
      const glm::vec3 p(surface_.vertices[v]);
      print =
          mixed(print, uint64_t{std::bit_cast<uint32_t>(p.x)} << 32 | std::bit_cast<uint32_t>(p.y));
      print = mixed(print, std::bit_cast<uint32_t>(p.z));
    }
  }
  return print;
}

}  // namespace snowbough::tree
