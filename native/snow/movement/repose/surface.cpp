#include "snow/movement/repose/surface.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "base/simd.h"
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

/// Points, areas and upward parts of texels on one triangle (`surface`: xyz normal, w area in m2),
/// from their weights and shares. Returns whether all have an area.
SNOWBOUGH_WIDE bool find_surfaces(const ReposeSurface::Linear& points, const glm::vec4& surface,
                                  const glm::vec2* __restrict weights,
                                  const float* __restrict share, int32_t count,
                                  const ReposeSurface::Row& to) {
  const glm::vec3 a = points.first;
  const glm::vec3 b = points.to_second;
  const glm::vec3 c = points.to_third;
  const float whole = surface.w;
  const float normal_z = surface.z;
  float* __restrict const x = to.x;
  float* __restrict const y = to.y;
  float* __restrict const z = to.z;
  float* __restrict const area = to.area;
  float* __restrict const up = to.up;
  int32_t none = 0;
  // As in texel(), where sums begin with 0, so that no zero is negative.
  for (int32_t i = 0; i < count; ++i) {
    const glm::vec2 w = weights[i];
    x[i] = 0.0f + (a.x + w.x * b.x + w.y * c.x);
    y[i] = 0.0f + (a.y + w.x * b.y + w.y * c.y);
    z[i] = 0.0f + (a.z + w.x * b.z + w.y * c.z);
  }
  for (int32_t i = 0; i < count; ++i) {
    const float own = share[i] * whole;
    none |= own > 0.0f ? 0 : 1;
    area[i] = own;
    up[i] = (0.0f + own * normal_z) / own;
  }
  return none == 0;
}

/// Upward parts of the shading normals of texels on one triangle with the normal `face`.
SNOWBOUGH_WIDE void find_normals(const ReposeSurface::Linear& normals, const glm::vec3& face,
                                 const glm::vec2* __restrict weights, int32_t count,
                                 float* __restrict normal_z) {
  const glm::vec3 a = normals.first;
  const glm::vec3 b = normals.to_second;
  const glm::vec3 c = normals.to_third;
  const glm::vec3 own = face;
  for (int32_t i = 0; i < count; ++i) {
    const glm::vec2 w = weights[i];
    const float x = a.x + w.x * b.x + w.y * c.x;
    const float y = a.y + w.x * b.y + w.y * c.y;
    const float z = a.z + w.x * b.z + w.y * c.z;
    const float length = std::sqrt(x * x + y * y + z * z);
    const bool is_smooth = (length > 0.0f) & (x * own.x + y * own.y + z * own.z > 0.0f);
    // Numbers first, then one division each: a division under a condition would not vectorise.
    const float divisor = is_smooth ? length : 1.0f;
    const float mean_x = (is_smooth ? x : own.x) / divisor;
    const float mean_y = (is_smooth ? y : own.y) / divisor;
    const float mean_z = (is_smooth ? z : own.z) / divisor;
    const float again = std::sqrt(mean_x * mean_x + mean_y * mean_y + mean_z * mean_z);
    normal_z[i] = mean_z / (again > 0.0f ? again : 1.0f);
  }
}

void set(const ReposeSurface::Texel& texel, const ReposeSurface::Row& to) {
  *to.x = texel.point.x;
  *to.y = texel.point.y;
  *to.z = texel.point.z;
  *to.normal_z = texel.normal.z;
  *to.up = texel.up;
  *to.area = texel.area;
  *to.curvature = texel.curvature;
  *to.two_sided = texel.two_sided ? 1 : 0;
}

}  // namespace

void ReposeSurface::set_pose(const SceneObject& object, const TexelTable& table,
                             const std::vector<glm::vec3>& positions, bool curved) {
  constexpr size_t kRun = 1024;
  object_ = &object;
  table_ = &table;
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
  const auto texels = static_cast<double>(std::max<size_t>(1, table.texel.size()));
  int exponent = 0;
  std::frexp(std::max(area / texels, 1e-18), &exponent);
  unit_ = std::ldexp(1.0f / shared::kUnitsAMetre, exponent);
}

ReposeSurface::Linear ReposeSurface::points_of(size_t triangle) const {
  const int32_t* corners = &object_->description.topology.triangles[3 * triangle];
  const auto corner = [&](int k) {
    return (*positions_)[static_cast<size_t>(corners[k])] - anchor_;
  };
  return {corner(0), corner(1) - corner(0), corner(2) - corner(0)};
}

/// The normals of a smooth-shaded triangle's corners.
ReposeSurface::Linear ReposeSurface::normals_of(size_t triangle) const {
  const int32_t* numbers = &object_->description.shading[3 * triangle];
  const auto corner = [&](int k) {
    return numbers[k] < 0 ? glm::vec3(triangles_[triangle])
                          : normals_[static_cast<size_t>(numbers[k])];
  };
  return {corner(0), corner(1) - corner(0), corner(2) - corner(0)};
}

/// Shading normal at a point of a triangle, by the weights of its second and third corner. With
/// face normals, snow would form terraces.
glm::vec3 ReposeSurface::shading_normal(size_t triangle, glm::vec2 weights) const {
  const glm::vec3 own(triangles_[triangle]);
  if (normals_.empty()) return own;
  const glm::vec3 mean = normals_of(triangle).at(weights);
  const float length = glm::length(mean);
  return length > 0.0f && glm::dot(mean, own) > 0.0f ? mean / length : own;
}

ReposeSurface::Texel ReposeSurface::texel(int32_t index) const {
  const TexelTable& table = *table_;
  const auto begin = static_cast<size_t>(table.fragment_begin[static_cast<size_t>(index)]);
  const auto end = static_cast<size_t>(table.fragment_begin[static_cast<size_t>(index) + 1]);
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
  if (upper > 0.0f && !shared::is_wall(texel.up)) texel.up = upper_up / upper;
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
  // A column stands on the part that carries snow.
  texel.normal *= all / texel.area;
  return texel;
}

/// Evaluates `count` texels that have a single fragment each, from fragment `f` on, all on one
/// triangle; returns false if any has no area.
bool ReposeSurface::on_one_triangle(size_t f, int32_t count, const Row& to) const {
  const TexelTable& table = *table_;
  const auto t = static_cast<size_t>(table.fragment_triangle[f]);
  const glm::vec4& triangle = triangles_[t];
  const glm::vec2* const weights = &table.fragment_barycentric[f];
  const float* const share = &table.fragment_share[f];
  if (!find_surfaces(points_of(t), triangle, weights, share, count, to)) return false;
  if (normals_.empty()) {
    const float length = glm::length(glm::vec3(triangle));
    std::fill_n(to.normal_z, count, length > 0.0f ? triangle.z / length : triangle.z);
  } else {
    find_normals(normals_of(t), glm::vec3(triangle), weights, count, to.normal_z);
  }
  std::fill_n(to.curvature, count, curvatures_.empty() ? 0.0f : curvatures_[t]);
  std::fill_n(to.two_sided, count,
              object_->two_sided.empty() || object_->two_sided[t] == 0 ? uint8_t{0} : uint8_t{1});
  return true;
}

void ReposeSurface::texels(int32_t first, int32_t count, const Row& to) const {
  const TexelTable& table = *table_;
  const int32_t* const begin = &table.fragment_begin[static_cast<size_t>(first)];
  for (int32_t i = 0; i < count;) {
    const int32_t f = begin[i];
    const int32_t* const triangle = &table.fragment_triangle[static_cast<size_t>(f)];
    int32_t alike = 0;
    while (i + alike < count && begin[i + alike + 1] - f == alike + 1 &&
           triangle[alike] == *triangle) {
      ++alike;
    }
    const Row own = to.at(static_cast<size_t>(i));
    if (alike == 0 || !on_one_triangle(static_cast<size_t>(f), alike, own)) {
      set(texel(first + i), own);
      alike = 1;
    }
    i += alike;
  }
}

void ReposeSurface::fill_block(const ReposeLinks& links, int32_t block, TileGround& ground) const {
  const Row all{ground.x.data(),         ground.y.data(),        ground.z.data(),
                ground.normal_z.data(),  ground.up.data(),       ground.area.data(),
                ground.curvature.data(), ground.two_sided.data()};
  links.for_runs(block, table_->texel, [&](int32_t first, int32_t count, size_t cell) {
    texels(first, count, all.at(cell));
  });
  ground.any_two_sided = std::any_of(ground.two_sided.begin(), ground.two_sided.end(),
                                     [](uint8_t two_sided) { return two_sided != 0; });
  std::copy_n(links.forward_of(block), kTileCells, ground.forward.begin());
  const int32_t* ends = &links.end_begin[static_cast<size_t>(block)];
  for (int32_t e = ends[0]; e < ends[1]; ++e) {
    const ReposeLinks::End& end = links.ends[static_cast<size_t>(e)];
    const auto cell = static_cast<size_t>(end.cell % kTileCells);
    ground.link_count[cell] = static_cast<uint8_t>(
        std::clamp(end.links, static_cast<int32_t>(shared::kLinks), int32_t{255}));
    if (static_cast<size_t>(end.link) < links.across.size()) ground.forward[cell] |= kAtSeam;
  }
}

}  // namespace snowbough::snow
