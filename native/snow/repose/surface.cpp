#include "snow/repose/surface.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"
#include "snow/scene/projection.h"
#include "snow/seams/curvature.h"

namespace snowbough::snow {

namespace {

/// Sums of the triangles' principal curvatures: twice the mean curvature at their corners.
std::vector<float> curvatures_of(const ObjectDescription& description,
                                 const std::vector<glm::vec3>& normals,
                                 const std::vector<glm::vec3>& positions) {
  const std::vector<LayerTerms> terms =
      layer_terms(description.topology.triangles, description.shading, normals, positions);
  std::vector<float> curvatures(terms.size() / 3);
  for (size_t t = 0; t < curvatures.size(); ++t) {
    curvatures[t] = 2.0f / 3.0f * (terms[3 * t].y + terms[3 * t + 1].y + terms[3 * t + 2].y);
  }
  return curvatures;
}

}  // namespace

void ReposeSurface::set_pose(const SceneObject& object, const std::vector<glm::vec3>& positions,
                             bool curved) {
  constexpr size_t kRun = 1024;
  object_ = &object;
  positions_ = &positions;
  normals_ =
      shading_normals(object.description.topology.triangles, object.description.shading, positions);
  curvatures_ =
      curved ? curvatures_of(object.description, normals_, positions) : std::vector<float>();
  Bounds bounds;
  for (const glm::vec3& position : positions) bounds.include(glm::dvec3(position));
  anchor_ = glm::vec3(0.5 * (bounds.low + bounds.high));
  const std::vector<int32_t>& indices = object.description.topology.triangles;
  triangles_.resize(indices.size() / 3);
  const size_t runs = (triangles_.size() + kRun - 1) / kRun;
  std::vector<double> areas(runs, 0.0);
  base::for_each_item(runs, 1, [&](size_t run) {
    for (size_t t = run * kRun; t < std::min(triangles_.size(), (run + 1) * kRun); ++t) {
      const auto corner = [&](size_t k) {
        return glm::dvec3(positions[static_cast<size_t>(indices[3 * t + k])]);
      };
      const glm::dvec3 cross = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
      const double size = glm::length(cross);
      const glm::dvec3 normal = size > 0.0 ? cross / size : glm::dvec3(0.0);
      triangles_[t] = glm::vec4(glm::vec3(normal), static_cast<float>(0.5 * size));
      areas[run] += 0.5 * size;
    }
  });
  double area = 0.0;
  for (const double part : areas) area += part;
  const auto texels = static_cast<double>(std::max<size_t>(1, object.table->texel.size()));
  int exponent = 0;
  std::frexp(std::max(area / texels, 1e-18), &exponent);
  unit_ = std::ldexp(1.0f / shared::kUnitsAMetre, exponent);
}

glm::vec3 ReposeSurface::point(int32_t triangle, glm::vec2 weights) const {
  const int32_t* corners =
      &object_->description.topology.triangles[3 * static_cast<size_t>(triangle)];
  const auto corner = [&](int k) {
    return (*positions_)[static_cast<size_t>(corners[k])] - anchor_;
  };
  const glm::vec3 a = corner(0);
  return a + weights.x * (corner(1) - a) + weights.y * (corner(2) - a);
}

/// Shading normal at a point of a triangle, by the weights of its second and third corner. With
/// face normals, snow would form terraces.
glm::vec3 ReposeSurface::shading_normal(size_t triangle, glm::vec2 weights) const {
  const glm::vec3 own(triangles_[triangle]);
  if (normals_.empty()) return own;
  const int32_t* numbers = &object_->description.shading[3 * triangle];
  const auto corner = [&](int k) {
    return numbers[k] < 0 ? own : normals_[static_cast<size_t>(numbers[k])];
  };
  const glm::vec3 a = corner(0);
  const glm::vec3 mean = a + weights.x * (corner(1) - a) + weights.y * (corner(2) - a);
  const float length = glm::length(mean);
  return length > 0.0f && glm::dot(mean, own) > 0.0f ? mean / length : own;
}

/// texel() of a texel with a single fragment, as most have, to the bit.
ReposeSurface::Texel ReposeSurface::only_fragment(size_t f) const {
  const TexelTable& table = *object_->table;
  const int32_t number = table.fragment_triangle[f];
  const auto t = static_cast<size_t>(number);
  const glm::vec4& triangle = triangles_[t];
  Texel texel;
  texel.area = table.fragment_share[f] * triangle.w;
  texel.two_sided = !object_->two_sided.empty() && object_->two_sided[t] != 0;
  if (texel.area <= 0.0f) return texel;
  // Sums from 0 on, so that no zero is negative.
  texel.up = (0.0f + texel.area * triangle.z) / texel.area;
  texel.point += point(number, table.fragment_barycentric[f]);
  texel.normal += shading_normal(t, table.fragment_barycentric[f]);
  if (!curvatures_.empty()) texel.curvature += curvatures_[t];
  const float length = glm::length(texel.normal);
  if (length > 0.0f) texel.normal /= length;
  return texel;
}

ReposeSurface::Texel ReposeSurface::texel(int32_t index) const {
  const TexelTable& table = *object_->table;
  const auto begin = static_cast<size_t>(table.fragment_begin[static_cast<size_t>(index)]);
  const auto end = static_cast<size_t>(table.fragment_begin[static_cast<size_t>(index) + 1]);
  if (end - begin == 1) return only_fragment(begin);
  Texel texel;
  float upper = 0.0f;
  float upper_up = 0.0f;
  float sum_up = 0.0f;
  for (size_t f = begin; f < end; ++f) {
    const glm::vec4& triangle = triangles_[static_cast<size_t>(table.fragment_triangle[f])];
    const float own = table.fragment_share[f] * triangle.w;
    texel.area += own;
    sum_up += own * triangle.z;
    upper += triangle.z > 0.0f ? own : 0.0f;
    upper_up += own * std::max(triangle.z, 0.0f);
    const auto number = static_cast<size_t>(table.fragment_triangle[f]);
    texel.two_sided =
        texel.two_sided || (!object_->two_sided.empty() && object_->two_sided[number] != 0);
  }
  if (texel.area <= 0.0f) return texel;
  // Snow lies on parts that face up, if there are any; on two-sided sheets, on one side.
  if (texel.two_sided) upper = upper_up = 0.0f;
  texel.up = (upper_up > 0.0f ? upper_up : sum_up) / texel.area;
  const float all = upper > 0.0f ? upper : texel.area;
  for (size_t f = begin; f < end; ++f) {
    const glm::vec4& triangle = triangles_[static_cast<size_t>(table.fragment_triangle[f])];
    if (upper > 0.0f && triangle.z <= 0.0f) continue;
    const float part = table.fragment_share[f] * triangle.w / all;
    const auto number = static_cast<size_t>(table.fragment_triangle[f]);
    texel.point += part * point(table.fragment_triangle[f], table.fragment_barycentric[f]);
    texel.normal += part * shading_normal(number, table.fragment_barycentric[f]);
    if (!curvatures_.empty()) texel.curvature += part * curvatures_[number];
  }
  const float length = glm::length(texel.normal);
  if (length > 0.0f) texel.normal /= length;
  return texel;
}

void ReposeSurface::fill_block(const ReposeLinks& links, int32_t block, ReposeTile& tile) const {
  tile.begin_pose();
  links.for_texels(block, object_->table->texel, [&](int32_t index, size_t cell) {
    const Texel own = texel(index);
    tile.x[cell] = own.point.x;
    tile.y[cell] = own.point.y;
    tile.z[cell] = own.point.z;
    tile.normal_z[cell] = own.normal.z;
    tile.up[cell] = own.up;
    tile.area[cell] = own.area;
    tile.curvature[cell] = own.curvature;
    tile.two_sided[cell] = own.two_sided ? 1 : 0;
    tile.any_two_sided = tile.any_two_sided || own.two_sided;
    tile.forward[cell] = links.forward[static_cast<size_t>(index)];
  });
  const int32_t* ends = &links.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links.ends[static_cast<size_t>(e)];
    const auto cell = static_cast<size_t>(end.cell % kTileCells);
    tile.links[cell] = static_cast<uint8_t>(
        std::clamp(end.links, static_cast<int32_t>(shared::kLinks), int32_t{255}));
    if (static_cast<size_t>(end.link) < links.across.size()) tile.forward[cell] |= kAtSeam;
  }
}

}  // namespace snowbough::snow
