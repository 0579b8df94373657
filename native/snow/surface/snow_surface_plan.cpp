#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>

#include "base/parallel_for.h"
#include "base/union_find.h"
#include "shaders/lib/snow_noise.h"
#include "snow/surface/flip_edges.h"
#include "snow/surface/map_sampler.h"
#include "snow/surface/snow_surface.h"

// What SnowSurface knows of its points before any frame.

namespace snowbough::snow {
namespace {

using shared::layered_noise;

/// Part of the thickness below a point that bare places may sink into.
constexpr float kSinkPart = 0.45f;
/// A part of the receiver that has no other side counts as so much of its size thick.
constexpr float kSheetThickness = 0.012f;
/// Smoothing over the surface reaches so far, as a part of the depth.
constexpr float kSmoothing = 0.12f;
/// And of normals.
constexpr float kCrease = 0.3f;
/// Overhang on the lee side in a horizontal wind, as a part of the height.
constexpr float kLee = 0.4f;
/// Points at least so far into their zone say how high the snow behind a rim is.
constexpr float kInland = 0.6f;
/// Half of Phong tessellation is exact on a sphere.
constexpr float kCurvature = 0.5f;

float eased(float x, float from, float to) {
  return shared::eased(x, from, to);
}

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 1e-12f ? v / length : glm::vec3(0.0f);
}

/// What is added to places in noise, so that receivers differ.
glm::vec3 noise_shift(const SurfacePlan& plan) {
  return glm::vec3(3.1f, 7.7f, 5.3f) * static_cast<float>(plan.seed % 9973u) * 0.1f;
}

void check(const SurfaceSource& source, const std::vector<float>& map) {
  const auto texels = static_cast<size_t>(source.topology.resolution) * source.topology.resolution;
  if (source.topology.resolution < 2 || map.size() != texels) {
    throw std::invalid_argument(
        "a height map must have as many texels as the receiver's resolution says");
  }
  if (source.positions.size() < static_cast<size_t>(source.topology.vertex_count)) {
    throw std::invalid_argument("positions must have a row for each vertex");
  }
  if (!source.shading.empty() && source.shading.size() != source.topology.triangles.size()) {
    throw std::invalid_argument("shading must have shape (T, 3)");
  }
}

/// The receiver's mesh with each connected part turned so that its snow lies in front.
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
      vertex_count_(source.topology.vertex_count),
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
  const Rims rims(receiver, tree, source.shading, 1.15f * rim_zone(depth), far_zone(depth));
  const RimZones zones(receiver, rims, depth);
  mesh_ = refined_surface(receiver, rims, zones, {last.data(), highest.data(), resolution_},
                          plan.density);
  find_carriers(source);
  find_samples();
  find_neighbours(kSmoothing * depth);
  find_normals(kCrease * depth);
  find_noise(plan);
  find_thickness(tree);
  find_fronts(rims, zones, plan);
  find_presence(plan, last);
  // Points stay, faces follow the snow.
  SurfaceFrame frame;
  frame.height = last.data();
  frame.open_depth = depth;
  flip_edges(mesh_, points(frame));
  find_samples();
  find_neighbours(kSmoothing * depth);
  find_bumps(plan, points(frame));
  if (are_needles(receiver, depth)) find_cushions(depth, last);
  drop_bare_sheets(highest, depth);
  make_faces();
}

void SnowSurface::find_carriers(const SurfaceSource& source) {
  const size_t count = lying_points();
  carrier_triangle_.assign(count, -1);
  carrier_weight_.assign(count, glm::vec2(0.0f));
  curvature_.assign(count, glm::vec3(0.0f));
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    for (const int32_t p : mesh_.triangle[t]) {
      if (carrier_triangle_[p] < 0) carrier_triangle_[p] = mesh_.base[t];
    }
  }
  for (size_t p = 0; p < count; ++p) {
    const int32_t* corner = &triangles_[static_cast<size_t>(carrier_triangle_[p]) * 3];
    const glm::dvec3 a(planned_positions_[corner[0]]);
    const glm::dvec3 ab = glm::dvec3(planned_positions_[corner[1]]) - a;
    const glm::dvec3 ac = glm::dvec3(planned_positions_[corner[2]]) - a;
    const glm::dvec3 ap = glm::dvec3(mesh_.position[p]) - a;
    const double bb = glm::dot(ab, ab), bc = glm::dot(ab, ac), cc = glm::dot(ac, ac);
    const double pb = glm::dot(ap, ab), pc = glm::dot(ap, ac);
    const double area = bb * cc - bc * bc;
    if (area > 0.0) {
      carrier_weight_[p] = glm::vec2((cc * pb - bc * pc) / area, (bb * pc - bc * pb) / area);
    }
  }
  if (source.shading.empty()) return;
  // Half of Phong tessellation: T. Boubekeur, M. Alexa, Phong Tessellation, SIGGRAPH Asia 2008.
  // Normals of the receiver's vertices are those that the surface has there.
  std::vector<glm::vec3> normal(planned_positions_.size(), glm::vec3(0.0f));
  for (size_t c = 0; c < triangles_.size(); c += 3) {
    const glm::vec3 cross =
        glm::cross(planned_positions_[triangles_[c + 1]] - planned_positions_[triangles_[c]],
                   planned_positions_[triangles_[c + 2]] - planned_positions_[triangles_[c]]);
    for (size_t k = 0; k < 3; ++k) {
      if (source.shading[c + k] >= 0) normal[triangles_[c + k]] += cross;
    }
  }
  for (glm::vec3& n : normal) n = unit(n);
  for (size_t p = 0; p < count; ++p) {
    const size_t c = static_cast<size_t>(carrier_triangle_[p]) * 3;
    if (source.shading[c] < 0 || source.shading[c + 1] < 0 || source.shading[c + 2] < 0) continue;
    const glm::vec2 w = carrier_weight_[p];
    const std::array<float, 3> weight{1.0f - w.x - w.y, w.x, w.y};
    glm::vec3 way(0.0f);
    for (size_t k = 0; k < 3; ++k) {
      const int32_t v = triangles_[c + k];
      way -= weight[k] * glm::dot(mesh_.position[p] - planned_positions_[v], normal[v]) * normal[v];
    }
    curvature_[p] = kCurvature * way;
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
    // Where charts meet at an edge the side that faces the sky says how high the snow is.
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
    const glm::vec3 way = mesh_.position[a] - mesh_.position[b];
    const float weight = 0.5f * std::exp(-glm::dot(way, way) / (reach * reach));
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
  // Over creases between flat faces snow bends as softly as it is deep.
  constexpr int kRounds = 12;
  std::vector<glm::vec3> before;
  for (int round = 0; round < kRounds; ++round) {
    before = normal_;
    base::for_each_item(lying_points(), 1024, [&](size_t p) {
      glm::vec3 sum = before[p];
      for (int32_t i = neighbour_begin_[p]; i < neighbour_begin_[p + 1]; ++i) {
        const glm::vec3 way = mesh_.position[p] - mesh_.position[neighbour_[i]];
        sum += before[neighbour_[i]] * (0.5f * std::exp(-glm::dot(way, way) / (reach * reach)));
      }
      normal_[p] = unit(sum);
    });
  }
}

void SnowSurface::find_noise(const SurfacePlan& plan) {
  const float d = plan.density.depth;
  const glm::vec3 shift = noise_shift(plan);
  point_.resize(lying_points());
  base::for_each_item(lying_points(), 1024, [&](size_t p) {
    // Lengths in parts of the depth, so that noise is the same at any scale.
    const glm::vec3 at = mesh_.position[p] / d + shift;
    shared::SnowPoint& point = point_[p];
    point.patches = layered_noise(at + 50.0f, {2.2f, 1.0f, 0.45f}, 0.8f);
    point.hem = layered_noise(at, {3.0f, 1.5f, 0.6f}, 0.7f);
    point.relief = layered_noise(at + 21.0f, {4.0f, 1.7f, 0.8f}, 0.65f);
    point.bumps = 0.0f;
    point.deepest = 1e9f;
  });
}

void SnowSurface::find_thickness(const base::TriangleTree& tree) {
  base::UnionFind joined(lying_points());
  for (const auto& [a, b, c] : mesh_.triangle) joined.join(joined.join(a, b), c);
  const std::vector<int32_t> part = std::move(joined).all();
  std::vector<float> part_area(lying_points(), 0.0f);
  for (size_t p = 0; p < lying_points(); ++p) part_area[part[p]] += area_[p];
  is_sheet_.assign(lying_points(), 0);
  base::for_each_item(lying_points(), 256, [&](size_t p) {
    const glm::dvec3 way(-normal_[p]);
    const double below = tree.distance_along(0, glm::dvec3(mesh_.position[p]), way, 1e-5);
    const float sheet = kSheetThickness * std::sqrt(part_area[part[p]]);
    is_sheet_[p] = std::isfinite(below) ? 0 : 1;
    const float thickness = std::isfinite(below) ? static_cast<float>(below) : sheet;
    point_[p].deepest = std::max(kSinkPart * thickness, 1e-5f);
  });
}

void SnowSurface::find_fronts(const Rims& rims, const RimZones& zones, const SurfacePlan& plan) {
  if (rims.all().empty()) return;
  const float depth = plan.density.depth;
  std::vector<RimZones::Zone> zone;
  zones.find(mesh_, zone);

  // What lies behind rims.
  std::vector<CellGrid::Box> boxes;
  std::vector<int32_t> inland;
  for (size_t p = 0; p < lying_points(); ++p) {
    if (!zone[p].place.is_far_off && zone[p].share > kInland) {
      boxes.push_back({mesh_.position[p], mesh_.position[p]});
      inland.push_back(static_cast<int32_t>(p));
    }
  }
  const CellGrid grid(boxes, 0.25f * depth);

  for (size_t p = 0; p < lying_points(); ++p) {
    if (zone[p].place.is_far_off || zone[p].share >= 1.0f || zone[p].share < -1.6f) continue;
    front_point_.push_back(static_cast<int32_t>(p));
  }
  front_.resize(front_point_.size());
  front_inland_.resize(front_.size());
  front_weight_.resize(front_.size());
  const glm::vec3 shift = noise_shift(plan);
  base::for_each_item(front_.size(), 64, [&](size_t f) {
    const auto p = static_cast<size_t>(front_point_[f]);
    const RimZones::Zone& here = zone[p];
    shared::SnowFront& front = front_[f];
    front.distance = here.place.distance;
    front.zone = here.support;
    front.far_zone = here.far;
    front.has_far = here.place.has_far ? 1.0f : 0.0f;
    front.out = here.place.out;
    front.level_out = here.place.level_out;
    front.down = here.place.down;
    front.eave = std::clamp(-here.place.out.z, 0.0f, 1.0f) * front.has_far;
    const glm::vec3 support = here.place.distance >= 0.0f ? here.place.support : glm::vec3(0, 0, 1);
    const glm::vec3 lift = unit(0.7f * glm::vec3(0, 0, 1) + 0.3f * support);
    front.lift = lift / std::max(glm::dot(lift, support), 0.5f);
    const glm::vec3 at = here.place.foot / depth + shift;
    front.noise_slow = std::clamp(layered_noise(at + 9.0f, {3.0f, 1.4f, 0.6f}, 0.75f), -1.3f, 1.3f);
    front.noise_fast = std::clamp(layered_noise(at + 31.0f, {2.4f, 1.0f, 0.5f}, 0.8f), -1.3f, 1.3f);
    front.noise_shoulder = layered_noise(at + 77.0f, {3.0f, 1.2f, 0.0f}, 0.6f);
    const float lee = glm::dot(glm::vec2(here.place.level_out), plan.wind);
    front.lee = kLee * std::max(lee, 0.0f);
    const Rims::Opposite opposite = rims.opposite(here.place, shared::kBridgedGap * depth);
    front.bridged = opposite.nearness;
    front.half_gap = 0.5f * opposite.gap + 0.0005f;
    front.half_step = 0.5f * opposite.step;

    const glm::vec3 behind = here.place.foot - here.place.out * (here.support * 1.02f);
    struct Found {
      float distance;
      int32_t point;
    };
    std::vector<Found> found;
    // A needle's tip is a rim on its own, too small for a front.
    front.presence = eased(here.room / depth, 0.03f, 0.09f);
    const float farthest = front.presence > 0.0f ? 3.0f * depth : 0.0f;
    for (float reach = 0.15f * depth; reach < farthest && found.size() < 4; reach *= 1.7f) {
      found.clear();
      grid.visit(behind - reach, behind + reach, [&](int32_t i) {
        const int32_t q = inland[i];
        const float distance = glm::distance(mesh_.position[q], behind);
        if (distance < reach) found.push_back({distance, q});
      });
    }
    std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
      return a.distance != b.distance ? a.distance < b.distance : a.point < b.point;
    });
    glm::ivec4 point(static_cast<int32_t>(p));
    glm::vec4 weight(0.0f);
    for (int k = 0; k < 4 && k < static_cast<int>(found.size()); ++k) {
      point[k] = found[k].point;
      weight[k] = 1.0f / (found[k].distance + 0.025f * depth);
    }
    if (found.empty()) weight[0] = 1.0f;
    front_inland_[f] = point;
    front_weight_[f] = weight / (weight.x + weight.y + weight.z + weight.w);
  });
  // On a cap shaded smooth, means of normals lean over the rim.
  for (size_t p = 0; p < lying_points(); ++p) {
    if (zone[p].place.is_far_off || zone[p].share < -1e-4f) continue;
    const float near = eased(zone[p].share, 1.15f, 0.6f);
    normal_[p] = unit(glm::mix(normal_[p], zone[p].place.support, near));
  }
}

void SnowSurface::find_presence(const SurfacePlan& plan, const std::vector<float>& last) {
  SurfaceFrame frame;
  frame.height = last.data();
  frame.open_depth = plan.density.depth;
  // Fronts are only where snow lies behind the rim in the end.
  const std::vector<float> shown = shown_heights(frame);
  for (size_t f = 0; f < front_.size(); ++f) {
    float inland = 0.0f;
    for (int k = 0; k < 4; ++k) inland += front_weight_[f][k] * shown[front_inland_[f][k]];
    front_[f].presence *= eased(inland / plan.density.depth, 0.06f, 0.3f);
  }
}

void SnowSurface::find_bumps(const SurfacePlan& plan, const std::vector<glm::vec3>& shown) {
  const float d = plan.density.depth;
  const glm::vec3 shift = noise_shift(plan);
  base::for_each_item(lying_points(), 1024, [&](size_t p) {
    point_[p].bumps = layered_noise(shown[p] / d + shift + 70.0f, {1.1f, 0.5f, 0.0f}, 0.6f);
  });
}

void SnowSurface::drop_bare_sheets(const std::vector<float>& highest, float depth) {
  SurfaceFrame frame;
  frame.height = highest.data();
  frame.open_depth = depth;
  std::vector<uint8_t> shows(lying_points(), 0);
  const std::vector<float> shown = shown_heights(frame);
  // Heights that are negative on the back count there as well.
  std::vector<float> below = highest;
  for (float& height : below) height = -height;
  frame.height = below.data();
  const std::vector<float> shown_below = shown_heights(frame);
  for (size_t p = 0; p < shows.size(); ++p) {
    shows[p] = is_sheet_[p] == 0 || shown[p] > 0.0f || shown_below[p] > 0.0f ? 1 : 0;
  }
  SurfaceMesh kept = mesh_;
  kept.triangle.clear();
  kept.uv.clear();
  kept.normal.clear();
  kept.base.clear();
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    const auto& [a, b, c] = mesh_.triangle[t];
    if (shows[a] == 0 && shows[b] == 0 && shows[c] == 0) continue;
    kept.triangle.push_back(mesh_.triangle[t]);
    kept.uv.push_back(mesh_.uv[t]);
    kept.normal.push_back(mesh_.normal[t]);
    kept.base.push_back(mesh_.base[t]);
  }
  mesh_ = std::move(kept);
}

void SnowSurface::find_cushions(float depth, const std::vector<float>& last) {
  SurfaceFrame frame;
  frame.height = last.data();
  frame.open_depth = depth;
  // What is too thin to show on a needle alone counts.
  const std::vector<float> thickness = heights(frame, normal_).thickness;
  cushions_ = snow::find_cushions(mesh_, points(frame), thickness, depth);
  for (const int32_t p : cushions_.anchor) cushion_height_.push_back(std::max(thickness[p], 1e-6f));
}

void SnowSurface::make_faces() {
  // Two triangles that are nearly one plane and one chart become a quad, which takes a third less
  // memory in Blender.
  const SurfaceEdges edges = surface_edges(mesh_.triangle);
  const std::vector<glm::vec3> normals = triangle_normals(mesh_);
  struct Side {
    int32_t triangle = -1;
    int32_t k = 0;
  };
  std::vector<std::array<Side, 2>> sides(edges.ends.size());
  std::vector<int32_t> count(edges.ends.size(), 0);
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int32_t e = edges.of_triangle[t][k];
      if (count[e] < 2) sides[e][count[e]] = {static_cast<int32_t>(t), k};
      ++count[e];
    }
  }
  struct Pair {
    float cost;
    int32_t edge;
  };
  std::vector<Pair> pairs;
  for (size_t e = 0; e < edges.ends.size(); ++e) {
    if (count[e] != 2) continue;
    const auto [a, b] = sides[e];
    if (glm::dot(normals[a.triangle], normals[b.triangle]) < 0.97f) continue;
    const auto& uv = mesh_.uv;
    if (uv[a.triangle][a.k] != uv[b.triangle][(b.k + 1) % 3] ||
        uv[a.triangle][(a.k + 1) % 3] != uv[b.triangle][b.k]) {
      continue;
    }
    // Corners of the quad, and how far its worst angle is from a right one.
    const std::array<int32_t, 4> corner{
        mesh_.triangle[a.triangle][(a.k + 2) % 3], mesh_.triangle[a.triangle][a.k],
        mesh_.triangle[b.triangle][(b.k + 2) % 3], mesh_.triangle[b.triangle][b.k]};
    float worst = 0.0f;
    for (size_t k = 0; k < 4; ++k) {
      const glm::vec3 in = unit(mesh_.position[corner[(k + 3) % 4]] - mesh_.position[corner[k]]);
      const glm::vec3 out = unit(mesh_.position[corner[(k + 1) % 4]] - mesh_.position[corner[k]]);
      const float turn = glm::dot(glm::cross(out, in), normals[a.triangle]);
      worst = std::max(worst, turn > 0.1f ? std::abs(glm::dot(in, out)) : 9.0f);
    }
    if (worst < 0.9f) pairs.push_back({worst, static_cast<int32_t>(e)});
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.edge < b.edge;
  });
  std::vector<int32_t> partner(mesh_.triangle.size(), -1);
  for (const Pair& pair : pairs) {
    const auto [a, b] = sides[pair.edge];
    if (partner[a.triangle] >= 0 || partner[b.triangle] >= 0) continue;
    partner[a.triangle] = pair.edge;
    partner[b.triangle] = pair.edge;
  }
  faces_.begin.push_back(0);
  const auto add = [&](int32_t t, int k) {
    faces_.corner.push_back(mesh_.triangle[t][k % 3]);
    faces_.uv.push_back(mesh_.uv[t][k % 3]);
  };
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    const auto own = static_cast<int32_t>(t);
    if (partner[t] < 0) {
      for (int k = 0; k < 3; ++k) add(own, k);
    } else {
      const auto [a, b] = sides[partner[t]];
      if (a.triangle != own) continue;
      add(a.triangle, a.k + 2);
      add(a.triangle, a.k);
      add(b.triangle, b.k + 2);
      add(b.triangle, b.k);
    }
    faces_.begin.push_back(static_cast<int32_t>(faces_.corner.size()));
  }
  // A cushion has its anchor's place in the map.
  std::vector<glm::vec2> uv(lying_points(), glm::vec2(0.0f));
  for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
    for (int k = 0; k < 3; ++k) uv[mesh_.triangle[t][k]] = mesh_.uv[t][k];
  }
  for (const auto& quad : cushions_.quads) {
    for (const int32_t c : quad) {
      faces_.corner.push_back(static_cast<int32_t>(lying_points()) + c);
      faces_.uv.push_back(uv[cushions_.anchor[c]]);
    }
    faces_.begin.push_back(static_cast<int32_t>(faces_.corner.size()));
  }
}

}  // namespace snowbough::snow
