#include "render/tree/patch_bounds.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "shaders/lib/limb_section.h"

namespace snowbough::render {
namespace {

using glm::vec3;

/// Number of samples per side for the bulge of a patch, and the margin for points between the
/// samples.
constexpr int kBulgeSamples = 5;
constexpr float kBulgeMargin = 1.05f;

}  // namespace

void bound_patches(TreePatches& tree) {
  for (shared::TreePatch& patch : tree.patches) {
    std::array<vec3, 4> corner;
    float bark = 0.0f;
    for (int k = 0; k < 4; ++k) {
      corner[k] = vec3(tree.vertices[patch.vertices[k]].position);
      bark = std::max(bark, tree.vertices[patch.vertices[k]].position.w);
    }
    const vec3 centre = 0.25f * (corner[0] + corner[1] + corner[2] + corner[3]);
    float radius = 0.0f, farthest = 0.0f, rest = 0.0f;
    for (int k = 0; k < 4; ++k) {
      radius = std::max(radius, glm::distance(centre, corner[k]));
      const shared::TreeEdge& edge = tree.edges[patch.edges[k] >> 1];
      rest = std::max({rest, glm::length(vec3(patch.rest[k])), glm::length(vec3(edge.first_rest)),
                       glm::length(vec3(edge.last_rest))});
    }
    std::vector<int32_t> sections = {patch.limb.x};
    for (int k = 0; k < 4; ++k) {
      const shared::TreeEdge& edge = tree.edges[patch.edges[k] >> 1];
      sections.push_back(edge.ends.z);
      sections.push_back(edge.ends.w);
    }
    for (int i = 0; i < kBulgeSamples * kBulgeSamples; ++i) {
      const float u = static_cast<float>(i % kBulgeSamples) / (kBulgeSamples - 1);
      const float v = static_cast<float>(i / kBulgeSamples) / (kBulgeSamples - 1);
      const vec3 p =
          glm::mix(glm::mix(corner[0], corner[1], u), glm::mix(corner[3], corner[2], u), v);
      for (const int32_t section : sections) {
        const vec3 q = section >= 0 ? shared::on_limb(tree.sections[section], p) : p;
        farthest = std::max(farthest, glm::distance(centre, q));
      }
    }
    patch.rest[1].w = std::max(kBulgeMargin * farthest - radius, 0.0f) + rest + bark;
  }
}

}  // namespace snowbough::render
