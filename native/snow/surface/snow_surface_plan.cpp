#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "base/parallel_for.h"
#include "base/union_find.h"
#include "shaders/lib/snow_point.h"
#include "snow/surface/flip_edges.h"
#include "snow/surface/map_sampler.h"
#include "snow/surface/snow_surface.h"
#include "snow/surface/vectors.h"

// Computes SnowSurface's constants of points before any frame.

namespace snowbough::snow {
namespace {

/// Assumed thickness of a sheet, which has no back side, as a fraction of the square root of its
/// area.
constexpr float kSheetThickness = 0.012f;
/// Reach of the smoothing of heights over the surface, as a fraction of the depth.
constexpr float kSmoothing = 0.12f;
/// Reach of the smoothing of normals, as a fraction of the depth.
constexpr float kCrease = 0.3f;
/// Half of Phong tessellation is exact on a sphere.
constexpr float kCurvature = 0.5f;

void check(const SurfaceSource& source, const std::vector<float>& map) {
  const auto texels = static_cast<size_t>(source.topology.resolution) * source.topology.resolution;
  if (source.topology.resolution < 2 || map.size() != texels) {
    throw std::invalid_argument(
        "a height map must have resolution x resolution texels, at least 2 x 2");
  }
  if (source.positions.size() < static_cast<size_t>(source.topology.vertex_count)) {
    throw std::invalid_argument("positions must have a row for each vertex");
  }
  if (!source.shading.empty() && source.shading.size() != source.topology.triangles.size()) {
    throw std::invalid_argument("shading must have shape (T, 3)");
  }
}

/// Flips each connected part of the receiver's mesh so that its snow lies on the front.
SurfaceMesh snow_side_out(SurfaceMesh mesh, const std::vector<float>& last, int32_t resolution) {
  base::UnionFind joined(mesh.position.size());
  for (const auto& [a, b, c] : mesh.triangle) joined.join(joined.join(a, b), c);
  const std::vector<int32_t> part = std::move(joined).all();
  std::vector<double> volume(mesh.position.size(), 0.0);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    float sum = 0.0f;
    for (int k = 0; k < 3; ++k) {
      const glm::vec2 inside =
          (mesh.uv[t][k] * 2.0f + mesh.uv[t][(k + 1) % 3] + mesh.uv[t][(k + 2) % 3]) * 0.25f;
      sum += map_value(last.data(), resolution, map_place(inside, resolution));
    }
    volume[part[mesh.triangle[t][0]]] +=
        static_cast<double>(sum) * glm::length(triangle_cross(mesh, t));
  }
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    if (volume[part[mesh.triangle[t][0]]] >= 0.0) continue;
    std::swap(mesh.triangle[t][1], mesh.triangle[t][2]);
    std::swap(mesh.uv[t][1], mesh.uv[t][2]);
    std::swap(mesh.normal[t][1], mesh.normal[t][2]);
    for (glm::vec3& normal : mesh.normal[t]) normal = -normal;
  }
  return mesh;
}

}  // namespace

SnowSurface::SnowSurface(const SurfaceSource& source, const std::vector<float>& last,
                         const std::vector<float>& highest, const SurfacePlan& plan)
    : resolution_(source.topology.resolution),
      triangles_(source.topology.triangles),
      planned_positions_(source.positions) {
  check(source, last);
  check(source, highest);
  const float depth = plan.density.depth;
  if (!(depth > 0.0f)) throw std::invalid_argument("depth must be over 0");
  const SurfaceMesh receiver = snow_side_out(receiver_mesh(source), last, resolution_);
  if (receiver.triangle.empty()) {
    faces_.begin = {0};
    sample_begin_ = neighbour_begin_ = {0};
    return;
  }
  const base::TriangleTree tree(receiver.position, receiver.triangle,
                                {0, static_cast<int32_t>(receiver.triangle.size())});
  const Rims rims(receiver, tree, source.shading, 1.15f * rim_zone(depth), far_zone(depth),
                  rim_strip(depth));
  const RimZones zones(receiver, rims, depth);
  // Cushions get half of the points.
  const bool needles = are_needles(receiver, depth);
  SurfaceDensity density = plan.density;
  if (needles) density.most_points = std::max(density.most_points / 2, 1);
  RefinedSurface refined =
      refined_surface(receiver, rims, zones, {last.data(), highest.data(), resolution_}, density);
  mesh_ = std::move(refined.mesh);
  coarsened_ = refined.coarsened;
  find_carriers(source);
  find_samples();
  find_neighbours(kSmoothing * depth);
  find_normals(kCrease * depth);
  find_noise(plan);
  find_thickness(tree, depth);
  find_fronts(rims, zones, plan);
  find_convexity(depth);
  find_presence(plan, last);
  // The points stay fixed; the edges are flipped to follow the snow.
  SurfaceFrame frame;
  frame.height = last.data();
  frame.open_depth = depth;
  flip_edges(mesh_, points(frame));
  find_samples();
  find_neighbours(kSmoothing * depth);
  find_bumps(plan, points(frame));
  if (needles) {
    const auto lying = static_cast<int32_t>(lying_points());
    find_cushions(depth, last, std::max(plan.density.most_points - lying, density.most_points));
  }
  drop_bare_sheets(highest, depth);
  make_faces();
}

void SnowSurface::find_carriers(const SurfaceSource& source) {
  const size_t count = lying_points();
  carrier_triangle_.assign(count, -1);
  carrier_weight_.assign(count, glm::vec2(0.0f));
  curvature_.assign(count, glm::vec3(0.0f));
  // Choose the receiver triangle that contains the point: a triangle of the surface may span two of
  // them.
  std::vector<float> inside(count, 0.0f);
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    const int32_t base = mesh_.base[t];
    const int32_t* corner = &triangles_[static_cast<size_t>(base) * 3];
    const glm::dvec3 a(planned_positions_[corner[0]]);
    const glm::dvec3 ab = glm::dvec3(planned_positions_[corner[1]]) - a;
    const glm::dvec3 ac = glm::dvec3(planned_positions_[corner[2]]) - a;
    const double bb = glm::dot(ab, ab), bc = glm::dot(ab, ac), cc = glm::dot(ac, ac);
    const double area = bb * cc - bc * bc;
    for (const int32_t p : mesh_.triangle[t]) {
      if (carrier_triangle_[p] == base) continue;
      const glm::dvec3 ap = glm::dvec3(mesh_.position[p]) - a;
      const double pb = glm::dot(ap, ab), pc = glm::dot(ap, ac);
      glm::vec2 weight(0.0f);
      if (area > 0.0) weight = {(cc * pb - bc * pc) / area, (bb * pc - bc * pb) / area};
      // The tolerance keeps rounding from choosing between triangles that share the point.
      const float least = std::min({weight.x, weight.y, 1.0f - weight.x - weight.y, 0.0f});
      if (carrier_triangle_[p] >= 0 && least <= inside[p] + 1e-4f) continue;
      carrier_triangle_[p] = base;
      carrier_weight_[p] = weight;
      inside[p] = least;
    }
  }
  if (source.shading.empty()) return;
  // Half of Phong tessellation: T. Boubekeur, M. Alexa, Phong Tessellation, SIGGRAPH Asia 2008.
  // Corners with the same shading number share a normal.
  std::vector<glm::vec3> normal(
      static_cast<size_t>(
          std::max(*std::max_element(source.shading.begin(), source.shading.end()), 0)) +
          1,
      glm::vec3(0.0f));
  for (size_t c = 0; c < triangles_.size(); c += 3) {
    const glm::vec3 cross =
        glm::cross(planned_positions_[triangles_[c + 1]] - planned_positions_[triangles_[c]],
                   planned_positions_[triangles_[c + 2]] - planned_positions_[triangles_[c]]);
    for (size_t k = 0; k < 3; ++k) {
      if (source.shading[c + k] >= 0) normal[source.shading[c + k]] += cross;
    }
  }
  for (glm::vec3& n : normal) n = unit(n);
  for (size_t p = 0; p < count; ++p) {
    const size_t c = static_cast<size_t>(carrier_triangle_[p]) * 3;
    if (source.shading[c] < 0 || source.shading[c + 1] < 0 || source.shading[c + 2] < 0) continue;
    const glm::vec2 w = carrier_weight_[p];
    const std::array<float, 3> weight{1.0f - w.x - w.y, w.x, w.y};
    glm::vec3 shift(0.0f);
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec3& n = normal[source.shading[c + k]];
      shift -=
          weight[k] * glm::dot(mesh_.position[p] - planned_positions_[triangles_[c + k]], n) * n;
    }
    curvature_[p] = kCurvature * shift;
  }
}

void SnowSurface::find_samples() {
  const size_t count = lying_points();
  struct Sample {
    int32_t point;
    glm::vec2 uv;
    float weight;
  };
  std::vector<Sample> samples;
  sample_texel_.clear();
  sample_share_.clear();
  sample_weight_.clear();
  area_.assign(count, 0.0f);
  side_.assign(count, 1.0f);
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    const glm::vec3 cross = triangle_cross(mesh_, t);
    const float area = 0.5f * glm::length(cross);
    // Where charts meet at an edge, the chart that faces the sky determines the height of the snow.
    const float level = std::clamp(area > 0.0f ? 0.5f * cross.z / area : 0.0f, 0.0f, 1.0f);
    const int32_t* corner = &triangles_[static_cast<size_t>(mesh_.base[t]) * 3];
    const glm::vec3 own = glm::cross(planned_positions_[corner[1]] - planned_positions_[corner[0]],
                                     planned_positions_[corner[2]] - planned_positions_[corner[0]]);
    const float side = glm::dot(own, cross) < 0.0f ? -1.0f : 1.0f;
    for (int k = 0; k < 3; ++k) {
      const int32_t p = mesh_.triangle[t][k];
      area_[p] += area / 3.0f;
      side_[p] = side;
      samples.push_back({p, mesh_.uv[t][k], area * (0.02f + level * level)});
    }
  }
  std::stable_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    if (a.point != b.point) return a.point < b.point;
    return a.uv.x != b.uv.x ? a.uv.x < b.uv.x : a.uv.y < b.uv.y;
  });
  sample_begin_.assign(count + 1, 0);
  for (size_t i = 0; i < samples.size();) {
    const auto p = static_cast<size_t>(samples[i].point);
    const auto first = sample_weight_.size();
    float sum = 0.0f;
    for (; i < samples.size() && samples[i].point == static_cast<int32_t>(p); ++i) {
      const bool again =
          sample_weight_.size() > first && i > 0 && samples[i].uv == samples[i - 1].uv;
      if (!again) {
        const MapPlace place = map_place(samples[i].uv, resolution_);
        sample_texel_.push_back(place.texel);
        sample_share_.push_back(place.share);
        sample_weight_.push_back(0.0f);
      }
      sample_weight_.back() += samples[i].weight;
      sum += samples[i].weight;
    }
    for (size_t s = first; s < sample_weight_.size(); ++s) {
      sample_weight_[s] = sum > 0.0f ? sample_weight_[s] / sum
                                     : 1.0f / static_cast<float>(sample_weight_.size() - first);
    }
    sample_begin_[p + 1] = static_cast<int32_t>(sample_weight_.size());
  }
}

void SnowSurface::find_neighbours(float reach) {
  const SurfaceEdges edges = surface_edges(mesh_.triangle);
  neighbour_begin_.assign(lying_points() + 1, 0);
  for (const auto& [a, b] : edges.ends) {
    ++neighbour_begin_[a + 1];
    ++neighbour_begin_[b + 1];
  }
  for (size_t p = 0; p < lying_points(); ++p) neighbour_begin_[p + 1] += neighbour_begin_[p];
  neighbour_.resize(edges.ends.size() * 2);
  neighbour_weight_.resize(neighbour_.size());
  std::vector<int32_t> next(neighbour_begin_.begin(), neighbour_begin_.end() - 1);
  for (const auto& [a, b] : edges.ends) {
    const glm::vec3 between = mesh_.position[a] - mesh_.position[b];
    const float weight = 0.5f * std::exp(-glm::dot(between, between) / (reach * reach));
    neighbour_[next[a]] = b;
    neighbour_weight_[next[a]++] = weight;
    neighbour_[next[b]] = a;
    neighbour_weight_[next[b]++] = weight;
  }
}

void SnowSurface::find_normals(float reach) {
  normal_.assign(lying_points(), glm::vec3(0.0f));
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    const glm::vec3 cross = triangle_cross(mesh_, t);
    const float area = glm::length(cross);
    const float level = area > 0.0f ? std::clamp(cross.z / area, 0.0f, 1.0f) : 0.0f;
    for (int k = 0; k < 3; ++k) {
      normal_[mesh_.triangle[t][k]] += mesh_.normal[t][k] * (area * (0.02f + level * level));
    }
  }
  for (glm::vec3& normal : normal_) normal = unit(normal);
  // Snow bends over creases between flat faces with a radius of about its depth.
  constexpr int kRounds = 12;
  std::vector<glm::vec3> before;
  for (int round = 0; round < kRounds; ++round) {
    before = normal_;
    base::for_each_item(lying_points(), 1024, [&](size_t p) {
      glm::vec3 sum = before[p];
      for (int32_t i = neighbour_begin_[p]; i < neighbour_begin_[p + 1]; ++i) {
        const glm::vec3 apart = mesh_.position[p] - mesh_.position[neighbour_[i]];
        sum += before[neighbour_[i]] * (0.5f * std::exp(-glm::dot(apart, apart) / (reach * reach)));
      }
      normal_[p] = unit(sum);
    });
  }
}

void SnowSurface::find_noise(const SurfacePlan& plan) {
  const float d = plan.density.depth;
  const glm::vec3 shift = plan.noise_shift();
  point_.resize(lying_points());
  base::for_each_item(lying_points(), 1024, [&](size_t p) {
    point_[p] = shared::point_noise(mesh_.position[p] / d + shift);
  });
}

void SnowSurface::find_thickness(const base::TriangleTree& tree, float depth) {
  base::UnionFind joined(lying_points());
  for (const auto& [a, b, c] : mesh_.triangle) joined.join(joined.join(a, b), c);
  const std::vector<int32_t> part = std::move(joined).all();
  std::vector<float> part_area(lying_points(), 0.0f);
  for (size_t p = 0; p < lying_points(); ++p) part_area[part[p]] += area_[p];
  is_sheet_.assign(lying_points(), 0);
  base::for_each_item(lying_points(), 256, [&](size_t p) {
    const glm::dvec3 inwards(-normal_[p]);
    const double below = tree.distance_along(0, glm::dvec3(mesh_.position[p]), inwards, 1e-5);
    const float sheet = kSheetThickness * std::sqrt(part_area[part[p]]);
    is_sheet_[p] = std::isfinite(below) ? 0 : 1;
    const float thickness = std::isfinite(below) ? static_cast<float>(below) : sheet;
    point_[p] = shared::on_carrier(point_[p], thickness, depth);
  });
}

void SnowSurface::find_convexity(float depth) {
  // Compute the area of a surface offset by this height.
  const float height = 0.1f * depth;
  std::vector<float> outer(lying_points(), 0.0f);
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    const auto& [a, b, c] = mesh_.triangle[t];
    const glm::vec3 raised = mesh_.position[a] + height * normal_[a];
    const float area =
        0.5f * glm::length(glm::cross(mesh_.position[b] + height * normal_[b] - raised,
                                      mesh_.position[c] + height * normal_[c] - raised));
    for (const int32_t p : mesh_.triangle[t]) outer[p] += area / 3.0f;
  }
  std::vector<float> convexity(lying_points(), 0.0f);
  for (size_t p = 0; p < convexity.size(); ++p) {
    if (area_[p] > 0.0f) convexity[p] = std::max((outer[p] / area_[p] - 1.0f) / height, 0.0f);
  }
  constexpr int kRounds = 4;
  smooth(convexity, kRounds);
  for (size_t p = 0; p < convexity.size(); ++p) point_[p].convexity = convexity[p];
}

void SnowSurface::find_bumps(const SurfacePlan& plan, const std::vector<glm::vec3>& shown) {
  const float d = plan.density.depth;
  const glm::vec3 shift = plan.noise_shift();
  base::for_each_item(lying_points(), 1024, [&](size_t p) {
    point_[p].bumps = shared::bump_noise(shown[p] / d + shift);
  });
}

void SnowSurface::find_cushions(float depth, const std::vector<float>& last, int32_t most_points) {
  SurfaceFrame frame;
  frame.height = last.data();
  frame.open_depth = depth;
  // Use the thickness from the map, because snow too thin to show on one needle counts for bridges.
  const std::vector<float> thickness = heights(frame, normal_).thickness;
  cushions_ = snow::find_cushions(mesh_, points(frame), thickness, depth, most_points);
  for (const int32_t p : cushions_.anchor) cushion_height_.push_back(std::max(thickness[p], 1e-6f));
}

}  // namespace snowbough::snow
