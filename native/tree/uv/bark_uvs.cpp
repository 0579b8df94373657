#include "tree/uv/bark_uvs.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// v of the four corners of every ring of a limb, and every ring's circumference.
struct LimbTexture {
  std::vector<std::array<double, 4>> v;
  std::vector<double> circumference;
};

double circumference(const Surface& surface, const Ring& ring) {
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    sum += glm::distance(surface.vertices[ring.vertices[k]],
                         surface.vertices[ring.vertices[(k + 1) % 4]]);
  }
  return sum;
}

LimbTexture measure_limb(const Surface& surface, const LimbSurface& limb, double start) {
  LimbTexture texture;
  for (const Ring& ring : limb.rings) {
    texture.circumference.push_back(circumference(surface, ring));
  }
  texture.v.resize(limb.rings.size());
  texture.v[0].fill(start);
  for (size_t r = 0; r + 1 < limb.rings.size(); ++r) {
    std::array<double, 4> edges{};
    double mean = 0.0;
    for (int k = 0; k < 4; ++k) {
      edges[k] = glm::distance(surface.vertices[limb.rings[r].vertices[k]],
                               surface.vertices[limb.rings[r + 1].vertices[k]]);
      mean += 0.25 * edges[k];
    }
    const double scale = 2.0 / (texture.circumference[r] + texture.circumference[r + 1]);
    const double next = (r == 0 ? start : texture.v[r][0]) + mean * scale;
    texture.v[r + 1].fill(next);
    if (r == 0 && !limb.continues_parent) {
      // The texture is cut along a skewed hole instead of being distorted.
      for (int k = 0; k < 4; ++k) {
        texture.v[0][k] = next - edges[k] * scale;
      }
    }
  }
  return texture;
}

}  // namespace

std::vector<QuadUv> layout_bark_uvs(const Surface& surface) {
  std::vector<LimbTexture> textures(surface.limbs.size());
  // A continuing child shares its first ring with the parent's last one.
  std::vector<int32_t> ends_at(surface.vertices.size(), -1);
  for (size_t b = 0; b < surface.limbs.size(); ++b) {
    const LimbSurface& limb = surface.limbs[b];
    double start = 0.0;
    if (limb.continues_parent) {
      start = textures[ends_at[limb.rings[0].vertices[0]]].v.back()[0];
    }
    textures[b] = measure_limb(surface, limb, start);
    for (int32_t vertex : limb.rings.back().vertices) {
      ends_at[vertex] = static_cast<int32_t>(b);
    }
  }

  std::vector<QuadUv> uvs(surface.quads.size());
  for (size_t f = 0; f < surface.quads.size(); ++f) {
    const FaceOrigin& origin = surface.origins[f];
    const LimbSurface& limb = surface.limbs[origin.branch];
    const LimbTexture& texture = textures[origin.branch];
    const int32_t row = origin.row;
    const double u = 0.25 * origin.side;
    if (origin.part == FacePart::kTipCap || origin.part == FacePart::kRootCap) {
      const Ring& ring = limb.rings[row];
      const double scale = 1.0 / texture.circumference[row];
      const glm::dvec3 x = glm::normalize(surface.vertices[ring.vertices[0]] - ring.centre);
      const glm::dvec3 y = glm::cross(ring.normal, x);
      for (int k = 0; k < 4; ++k) {
        const glm::dvec3 p = surface.vertices[surface.quads[f][k]] - ring.centre;
        uvs[f][k] = {static_cast<float>(0.5 + glm::dot(p, x) * scale),
                     static_cast<float>(texture.v[row][0] + glm::dot(p, y) * scale)};
      }
      continue;
    }
    const int side = origin.side, after = (origin.side + 1) % 4;
    const double low = texture.v[row][side], low_after = texture.v[row][after];
    const double high = texture.v[row + 1][side];
    const QuadUv wall = {glm::vec2(u, low), glm::vec2(u + 0.25, low_after),
                         glm::vec2(u + 0.25, high), glm::vec2(u, high)};
    if (origin.part == FacePart::kWall) {
      uvs[f] = wall;
      continue;
    }
    // The inner corners of an inset are interpolated on the knuckle's side.
    const Ring& a = limb.rings[row];
    const Ring& b = limb.rings[row + 1];
    const glm::dvec3 p0 = surface.vertices[a.vertices[side]],
                     p1 = surface.vertices[a.vertices[after]];
    const glm::dvec3 p2 = surface.vertices[b.vertices[after]],
                     p3 = surface.vertices[b.vertices[side]];
    const glm::dvec3 x_axis = 0.5 * (p1 + p2 - p0 - p3), y_axis = 0.5 * (p2 + p3 - p0 - p1);
    const glm::dvec3 middle = 0.25 * (p0 + p1 + p2 + p3);
    uvs[f][0] = wall[origin.inset];
    uvs[f][1] = wall[(origin.inset + 1) % 4];
    for (int k = 2; k < 4; ++k) {
      const glm::dvec3 p = surface.vertices[surface.quads[f][k]] - middle;
      const double x = 0.5 + glm::dot(p, x_axis) / glm::dot(x_axis, x_axis);
      const double y = 0.5 + glm::dot(p, y_axis) / glm::dot(y_axis, y_axis);
      uvs[f][k] = {static_cast<float>(u + 0.25 * x), static_cast<float>(low + (high - low) * y)};
    }
  }
  return uvs;
}

}  // namespace snowbough::tree
