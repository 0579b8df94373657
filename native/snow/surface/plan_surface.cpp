#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "base/union_find.h"
#include "snow/surface/flip_edges.h"
#include "snow/surface/map_sampler.h"
#include "snow/surface/snow_surface.h"

// Makes a SnowSurface before any frame.

namespace snowbough::snow {
namespace {

/// Reach of the smoothing of heights over the surface, as a fraction of the depth.
constexpr float kSmoothing = 0.12f;
/// Cells within which the drawn snow has the volume of the map, and within which blankets have.
constexpr float kKept = 1.0f;
constexpr float kKeptWide = 3.0f;
/// Two neighbours with dents that differ by more than this fraction of the depth lie at a print's
/// wall.
constexpr float kWall = 0.1f;
/// Length of the edges of needles for which their cushions need a point, as a fraction of the
/// depth.
constexpr float kCushions = 0.07f;
/// Rounds in which folds are found: snow may fold beside those of the last one.
constexpr int kFoldRounds = 8;
/// The look that decides where snow ends.
const shared::SnowStyle kUsualStyle = shared::usual_style();

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
      sum += map_value(last.data(), resolution, map_sample(inside, resolution));
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

std::vector<float> up_of(const std::vector<glm::vec3>& normals) {
  std::vector<float> up;
  for (const glm::vec3& normal : normals) up.push_back(normal.z);
  return up;
}

SurfaceFrame frame_of(const std::vector<float>& map, float depth) {
  SurfaceFrame frame;
  frame.height = map.data();
  frame.open_depth = depth;
  return frame;
}

/// Samples of the heights that smooth less where the dented snow changes within an edge.
HeightSamples samples_of(const SurfaceMesh& mesh, const SurfaceSource& source, float reach,
                         const std::vector<float>& dented, float depth) {
  HeightSamples samples = height_samples(mesh, source, reach);
  if (dented.empty()) return samples;
  std::vector<float> height(samples.count());
  for (size_t p = 0; p < height.size(); ++p) {
    for (int32_t i = samples.begin[p]; i < samples.begin[p + 1]; ++i) {
      height[p] += samples.weight[i] * map_value(dented.data(), samples.resolution,
                                                 {samples.texel[i], samples.share[i]});
    }
  }
  std::vector<uint8_t> is_sharp(height.size(), 0);
  for (size_t p = 0; p < height.size(); ++p) {
    for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
      if (std::abs(height[samples.neighbour[i]] - height[p]) > kWall * depth) is_sharp[p] = 1;
    }
  }
  sharpen(samples, is_sharp);
  return samples;
}

/// Makes cushions of at most `most_points` points on the snow of `last`.
Cushions cushions_on(const SnowSurface& surface, const SurfaceFrame& last, int32_t most_points) {
  // Use the thickness from the map, because snow too thin to show on one needle counts for bridges.
  const std::vector<float> thickness =
      heights_now(surface, kUsualStyle, last, up_of(surface.points.normal)).thickness;
  Cushions cushions = find_cushions(surface.points.mesh, surface_points(surface, kUsualStyle, last),
                                    thickness, last.open_depth, most_points);
  for (const int32_t p : cushions.anchor) cushions.height.push_back(std::max(thickness[p], 1e-6f));
  return cushions;
}

/// Drops the faces of sheets that never show snow, because a sheet has no other side to hide them.
void drop_bare_sheets(SnowSurface& surface, const std::vector<float>& highest, float depth) {
  const std::vector<float> up = up_of(surface.points.normal);
  const auto shown_in = [&](const std::vector<float>& map) {
    return heights_now(surface, kUsualStyle, frame_of(map, depth), up).shown;
  };
  // Snow on the back has negative heights and must count as well.
  std::vector<float> below = highest;
  for (float& height : below) height = -height;
  const std::vector<float> shown = shown_in(highest), shown_below = shown_in(below);
  const auto shows = [&](int32_t p) {
    return surface.looks.is_sheet[p] == 0 || shown[p] > 0.0f || shown_below[p] > 0.0f;
  };
  SurfaceMesh& mesh = surface.points.mesh;
  size_t kept = 0;
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    const auto& [a, b, c] = mesh.triangle[t];
    if (!shows(a) && !shows(b) && !shows(c)) continue;
    mesh.triangle[kept] = mesh.triangle[t];
    mesh.uv[kept] = mesh.uv[t];
    mesh.normal[kept] = mesh.normal[t];
    mesh.base[kept] = mesh.base[t];
    ++kept;
  }
  mesh.triangle.resize(kept);
  mesh.uv.resize(kept);
  mesh.normal.resize(kept);
  mesh.base.resize(kept);
}

}  // namespace

PointCounts wanted_points(const SurfaceSource& source, float depth) {
  // A map whose columns are slopes, from downwards to upwards: faces that are not too steep carry
  // the full depth. Sheets that face downwards carry it on their backs; bodies have an underside,
  // too, which must not win.
  constexpr int32_t kSlopes = 64;
  constexpr float kSteepest = 0.5f, kCarries = 0.75f, kBack = 0.9f;
  std::vector<float> map, cover;
  for (int32_t i = 0; i < kSlopes * kSlopes; ++i) {
    const float up = 2.0f * (static_cast<float>(i % kSlopes) + 0.5f) / kSlopes - 1.0f;
    const float part = std::clamp((std::abs(up) - kSteepest) / (kCarries - kSteepest), 0.0f, 1.0f);
    map.push_back((up < 0.0f ? -kBack : 1.0f) * part * depth);
    cover.push_back(std::max(map.back(), 0.0f));
  }
  const auto map_slopes = [](SurfaceMesh& mesh) {
    for (size_t t = 0; t < mesh.triangle.size(); ++t) {
      for (int k = 0; k < 3; ++k) mesh.uv[t][k] = {0.5f + 0.5f * mesh.normal[t][k].z, 0.5f};
    }
  };
  SurfaceMesh receiver = receiver_mesh(source);
  if (receiver.triangle.empty()) return {};
  map_slopes(receiver);
  receiver = snow_side_out(std::move(receiver), map, kSlopes);
  map_slopes(receiver);
  const base::TriangleTree tree(receiver.position, receiver.triangle,
                                {0, static_cast<int32_t>(receiver.triangle.size())});
  const Rims rims(receiver, tree, source.shading, rim_zone(depth), far_zone(depth),
                  rim_strip(depth));
  const bool needles = are_needles(receiver, depth);
  const RimZones zones(receiver, rims, depth, needles);
  PointCounts counts =
      wanted_points(receiver, rims, zones, {cover.data(), cover.data(), nullptr, kSlopes}, depth);
  // The cushions on needles, which have no hems.
  if (needles) {
    for (const Rim& rim : rims.all()) {
      counts.hems += glm::distance(rim.from, rim.to) / (kCushions * depth);
    }
  }
  return counts;
}

SnowSurface plan_surface(const SurfaceSource& source, const std::vector<float>& last,
                         const std::vector<float>& highest, const std::vector<float>& dents,
                         const SurfacePlan& plan, const std::vector<Neighbour>& neighbours) {
  check(source, last);
  check(source, highest);
  std::vector<float> dented;
  if (!dents.empty()) {
    check(source, dents);
    for (size_t i = 0; i < last.size(); ++i) dented.push_back(std::abs(last[i]) - dents[i]);
  }
  const float depth = plan.density.depth;
  if (!(depth > 0.0f)) throw std::invalid_argument("depth must be over 0");
  const int32_t resolution = source.topology.resolution;
  SnowSurface surface;
  surface.triangles = source.topology.triangles;
  surface.positions = source.positions;
  const SurfaceMesh receiver = snow_side_out(receiver_mesh(source), last, resolution);
  if (receiver.triangle.empty()) {
    surface.samples = height_samples({}, source, 1.0f);
    return surface;
  }
  const base::TriangleTree tree(receiver.position, receiver.triangle,
                                {0, static_cast<int32_t>(receiver.triangle.size())});
  const Rims rims(receiver, tree, source.shading, 1.15f * rim_zone(depth), far_zone(depth),
                  rim_strip(depth));
  const bool needles = are_needles(receiver, depth);
  const RimZones zones(receiver, rims, depth, needles);
  // Cushions get half of the points.
  SurfaceDensity density = plan.density;
  if (needles) density.most_points = std::max(density.most_points / 2, 1);
  RefinedSurface refined = refined_surface(
      receiver, rims, zones,
      {last.data(), highest.data(), dented.empty() ? nullptr : dented.data(), resolution}, density);
  surface.coarsened = refined.coarsened;

  const float smoothing = kSmoothing * depth;
  const glm::vec3 shift = plan.noise_shift();
  SurfacePoints& points = surface.points;
  points = carried_points(std::move(refined.mesh), source);
  std::vector<RimZones::Zone> zone;
  zones.find(points.mesh, zone);
  surface.samples = samples_of(points.mesh, source, smoothing, dented, depth);
  surface.volume = VolumeBalance(points.mesh.position, kKept * depth);
  find_normals(points, surface.samples, depth);
  surface.fronts =
      find_fronts(points, surface.samples.area, sampled_heights(surface.samples, last.data()), zone,
                  rims, receiver, tree, Beyond(neighbours), plan.wind, shift, depth, needles);
  smooth_joins(surface.fronts, surface.samples);
  // Cushions join the snow of needles.
  if (needles) surface.fronts.blanket = {};
  if (!surface.fronts.blanket.empty()) {
    surface.wide_volume = VolumeBalance(points.mesh.position, kKeptWide * depth);
  }
  surface.looks = point_looks(points, surface.samples, zone, tree, shift, depth);

  const SurfaceFrame frame = frame_of(last, depth);
  const SurfaceHeightsNow heights = heights_now(surface, kUsualStyle, frame, up_of(points.normal));
  find_presence(surface.fronts, points, surface.samples, heights.thickness, heights.shown, depth);
  std::vector<glm::vec3> drawn = surface_points(surface, kUsualStyle, frame);
  std::vector<glm::vec3> out(points.count(), glm::vec3(0.0f));
  for (size_t f = 0; f < surface.fronts.count(); ++f) {
    out[surface.fronts.point[f]] = surface.fronts.front[f].level_out;
  }
  // Cushions cover needles.
  for (int round = 0; !needles && round < kFoldRounds; ++round) {
    if (!add_folds(surface.folds, points, drawn, heights.shown, out)) break;
    drawn = surface_points(surface, kUsualStyle, frame);
  }
  // The points stay fixed; the edges are flipped to follow the snow.
  flip_edges(points.mesh, drawn);
  surface.samples = samples_of(points.mesh, source, smoothing, dented, depth);
  set_relief(surface.looks, surface_points(surface, kUsualStyle, frame), shift, depth);
  if (needles) {
    const int32_t left = plan.density.most_points - static_cast<int32_t>(points.count());
    surface.cushions = cushions_on(surface, frame, std::max(left, density.most_points));
  }
  drop_bare_sheets(surface, highest, depth);
  surface.faces = surface_faces(points.mesh, surface.cushions);
  return surface;
}

}  // namespace snowbough::snow
