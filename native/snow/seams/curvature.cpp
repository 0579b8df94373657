#include "snow/seams/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "snow/seams/layer_height.h"

namespace snowbough::snow {
namespace {

constexpr LayerTerms kFlat{1.0f, 0.0f, 0.0f};
/// Minimum cosine between normal and face: beyond about 80 degrees heights would explode.
constexpr float kMinCosine = 0.2f;

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 1e-30f ? v / length : glm::vec3(0.0f);
}

float angle_between(const glm::vec3& a, const glm::vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

struct Face {
  glm::vec3 p[3];
  /// Length: twice the area.
  glm::vec3 normal;
};

Face face_of(const std::vector<int32_t>& triangles, const std::vector<glm::vec3>& positions,
             size_t t) {
  Face face;
  for (size_t k = 0; k < 3; ++k) face.p[k] = positions[static_cast<size_t>(triangles[3 * t + k])];
  face.normal = glm::cross(face.p[1] - face.p[0], face.p[2] - face.p[0]);
  return face;
}

/// At one point of a triangle, for unit normals N: the coefficients of ((P_u + t N_u) x (P_v + t
/// N_v)) . N by powers of the height t, integrated over t.
LayerTerms terms_at(const glm::vec3& p_u, const glm::vec3& p_v, const glm::vec3 (&normal)[3],
                    glm::vec2 at) {
  const glm::vec3 mean = normal[0] * (1.0f - at.x - at.y) + normal[1] * at.x + normal[2] * at.y;
  const float length = glm::length(mean);
  if (!(length > 1e-6f)) return LayerTerms(0.0f);
  const glm::vec3 n = mean / length;
  const auto turned = [&](const glm::vec3& step) {
    return (step - n * glm::dot(n, step)) / length;
  };
  const glm::vec3 n_u = turned(normal[1] - normal[0]);
  const glm::vec3 n_v = turned(normal[2] - normal[0]);
  const glm::vec3 bend = glm::cross(p_u, n_v) + glm::cross(n_u, p_v);
  return {glm::dot(glm::cross(p_u, p_v), n), 0.5f * glm::dot(bend, n),
          glm::dot(glm::cross(n_u, n_v), n) / 3.0f};
}

/// Terms of the prism between a triangle and its displaced copy: the mean of three points, exact
/// for linear and quadratic terms.
LayerTerms prism_terms(const Face& face, const glm::vec3 (&normal)[3]) {
  const float area = glm::length(face.normal);
  if (!(area > 1e-30f)) return kFlat;
  const glm::vec3 p_u = face.p[1] - face.p[0];
  const glm::vec3 p_v = face.p[2] - face.p[0];
  LayerTerms sum(0.0f);
  for (const glm::vec2 at : {glm::vec2(1.0f, 1.0f), {4.0f, 1.0f}, {1.0f, 4.0f}}) {
    sum += terms_at(p_u, p_v, normal, at / 6.0f);
  }
  sum /= 3.0f * area;
  return {std::max(kMinCosine, sum.x), sum.y, sum.z};
}

}  // namespace

std::vector<glm::vec3> shading_normals(const std::vector<int32_t>& triangles,
                                       const std::vector<int32_t>& shading,
                                       const std::vector<glm::vec3>& positions) {
  const int32_t numbers =
      shading.empty() ? 0 : *std::max_element(shading.begin(), shading.end()) + 1;
  std::vector<glm::vec3> normals(static_cast<size_t>(std::max(numbers, 0)), glm::vec3(0.0f));
  for (size_t t = 0; t < shading.size() / 3; ++t) {
    const Face face = face_of(triangles, positions, t);
    const glm::vec3 normal = unit(face.normal);
    for (size_t k = 0; k < 3; ++k) {
      const int32_t number = shading[3 * t + k];
      if (number < 0) continue;
      normals[static_cast<size_t>(number)] +=
          normal * angle_between(face.p[(k + 1) % 3] - face.p[k], face.p[(k + 2) % 3] - face.p[k]);
    }
  }
  for (glm::vec3& normal : normals) normal = unit(normal);
  return normals;
}

std::vector<LayerTerms> layer_terms(const std::vector<int32_t>& triangles,
                                    const std::vector<int32_t>& shading,
                                    const std::vector<glm::vec3>& normals,
                                    const std::vector<glm::vec3>& positions) {
  if (normals.empty()) return {};
  std::vector<LayerTerms> sum(normals.size(), LayerTerms(0.0f));
  std::vector<float> area(normals.size(), 0.0f);
  for (size_t t = 0; t < shading.size() / 3; ++t) {
    const Face face = face_of(triangles, positions, t);
    glm::vec3 normal[3];
    for (size_t k = 0; k < 3; ++k) {
      const int32_t number = shading[3 * t + k];
      normal[k] = number < 0 ? unit(face.normal) : normals[static_cast<size_t>(number)];
    }
    const LayerTerms terms = prism_terms(face, normal);
    const float weight = glm::length(face.normal);
    for (size_t k = 0; k < 3; ++k) {
      const int32_t number = shading[3 * t + k];
      if (number < 0) continue;
      sum[static_cast<size_t>(number)] += weight * terms;
      area[static_cast<size_t>(number)] += weight;
    }
  }
  std::vector<LayerTerms> corners(shading.size(), kFlat);
  for (size_t c = 0; c < shading.size(); ++c) {
    const int32_t number = shading[c];
    if (number >= 0 && area[static_cast<size_t>(number)] > 0.0f) {
      corners[c] = sum[static_cast<size_t>(number)] / area[static_cast<size_t>(number)];
    }
  }
  return corners;
}

void show_layers(const TexelTable& table, const std::vector<LayerTerms>& terms,
                 std::vector<float>& map, int32_t threads) {
  if (terms.empty()) return;
  constexpr size_t kBlock = 256;
  const size_t count = table.texel.size();
  base::for_each_item(
      (count + kBlock - 1) / kBlock, 32,
      [&](size_t block) {
        LayerBlock<kBlock> layer;
        std::array<int32_t, kBlock> texel;
        int32_t filled = 0;
        for (size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
          const float held = map[static_cast<size_t>(table.texel[i])];
          if (held == 0.0f) continue;
          const LayerTerms* corner = terms.data() + 3 * static_cast<size_t>(table.triangle[i]);
          const glm::vec2 w = table.barycentric[i];
          const LayerTerms own = corner[0] * (1.0f - w.x - w.y) + corner[1] * w.x + corner[2] * w.y;
          texel[static_cast<size_t>(filled)] = table.texel[i];
          layer.set(filled++, held, own);
        }
        raise_layers(layer.view(), filled);
        for (int32_t k = 0; k < filled; ++k) {
          map[static_cast<size_t>(texel[static_cast<size_t>(k)])] =
              layer.height[static_cast<size_t>(k)];
        }
      },
      threads);
}

}  // namespace snowbough::snow
