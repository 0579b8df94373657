#include "snow/surface/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel_for.h"
#include "snow/surface/blanket.h"
#include "snow/surface/flip_edges.h"
#include "snow/surface/map_sampler.h"

namespace snowbough::snow {
namespace {

// Lengths are fractions of the snow depth on open ground unless stated otherwise.
/// Target edge lengths of level snow, of smooth deep snow on curved places, of bare faces, and of
/// snow that ends on steep or curved places.
constexpr float kLevelEdge = 0.45f;
constexpr float kMaxLevelEdge = 2.0f;
/// Level snow never gets edges shorter than this, in metres: under a thin layer a large ground
/// would take the points of all hems.
constexpr float kMinLevelEdge = 0.03f;
constexpr float kCurvedEdge = 0.17f;
constexpr float kBareEdge = 4.0f;
constexpr float kEndingEdge = 0.1f;
/// On steep places, snow thinner than this is near its border.
constexpr float kEnding = 0.45f;
/// On level places, snow thinner than this is near its border.
constexpr float kBorder = 0.15f;
/// Least target edge length.
constexpr float kMinEdge = 0.085f;
/// Target edge lengths near rims: before the cuts along the rims, and along the rims afterwards, at
/// the hem and at the inner border of the zone.
constexpr float kRimEdge = 1.1f;
constexpr float kAlongHem = 0.15f;
constexpr float kAlongInland = 0.36f;
/// Fractions of the zone between which edges along the rims grow from the first to the second.
constexpr float kHemEnds = 0.1f;
constexpr float kInlandBegins = 0.6f;
/// Edges along the rims of narrow tops shrink in proportion to the width of the zone, down to this
/// factor.
constexpr float kMinAlong = 0.6f;
/// Target edge length at the feet of steps that snow may hide.
constexpr float kFootEdge = 0.25f;
/// Growth of the target edge length per metre of distance from a rim's zone, in metres.
constexpr float kGrowth = 0.35f;
/// Greatest difference between the height in the middle of an edge and the mean of its ends, for
/// deep and for thin snow; and the height below which snow is thin.
constexpr float kOffDeep = 0.04f;
constexpr float kOffThin = 0.015f;
constexpr float kThin = 0.3f;
/// The same, and the edge length, from which on an edge is split however few points there may be;
/// and the factor on edge lengths from which on points are few.
constexpr float kOffAnyway = 0.25f;
constexpr float kAnywayEdge = 0.6f;
constexpr float kCoarse = 2.0f;
/// The same for prints, and the target edge length at their walls.
constexpr float kOffDent = 0.04f;
constexpr float kDentEdge = 0.03f;
/// Snow higher than this, in metres or as a fraction of the depth, is shown.
constexpr float kShown = 0.0022f;
constexpr float kShownShare = 0.04f;
/// Points farther from a rim than this are not bare because of the rim.
constexpr float kOffRim = 0.35f;
/// Points nearer to a rim are low because of it.
constexpr float kAtRim = 0.2f;
/// Number of rings of bare faces that are kept around the snow.
constexpr int kRings = 3;
/// Length of the far face that is kept below rims.
constexpr float kKeptFar = 0.5f;
/// If the normals at an edge's ends differ by more than this distance, the surface is curved.
constexpr float kBends = 0.12f;

/// Positions of the cuts parallel to rims, as fractions of the zone; dense where the front curves;
/// negative on the far face, 0 after the last one.
/// They are made while target edge lengths exceed the default by less than `coarseness`.
struct Cuts {
  float coarseness;
  std::array<float, 14> shares;
};
constexpr std::array<Cuts, 4> kCuts{
    {{1.35f,
      {0.05f, 0.12f, 0.2f, 0.29f, 0.39f, 0.5f, 0.63f, 0.8f, 1.0f, -0.15f, -0.32f, -0.5f, -0.68f,
       -1.0f}},
     {2.6f, {0.07f, 0.18f, 0.32f, 0.5f, 0.72f, 1.0f, -0.2f, -0.45f, -0.68f}},
     {4.0f, {0.12f, 0.29f, 0.5f, 1.0f, -0.32f, -0.68f}},
     {8.0f, {0.2f, 0.6f, -0.45f}}}};
/// Two points lie on one cut if their fractions of the zone differ by less than this.
constexpr float kOneCut = 0.03f;
/// Two points lie in one row of a strip if their distances from the rim differ by less than this
/// fraction of the distance between rows.
constexpr float kOneRow = 0.3f;
/// An edge does not cross the middle of a top if both of its ends lie farther into their zones.
constexpr float kAcross = 0.9f;
/// The middle of an edge across a corner may lie farther into the zone than its ends by this
/// fraction of the zone.
constexpr float kCorner = 0.1f;
/// Rims whose outward directions have a smaller cosine lie opposite to each other.
constexpr float kOpposite = -0.5f;
/// Edges on the strip of a rim, such as a bevel, are cut only if they are longer than this: the
/// strip's own edges are rows, too.
constexpr float kStripEdge = 0.12f;
constexpr float kOnStrip = 0.65f;
/// A cut is skipped if it is nearer to an end of the edge than this fraction of the edge.
constexpr float kSnap = 0.15f;

/// Factors on the target edge lengths of one attempt.
struct Coarseness {
  float hems = 1.0f;
  float level = 1.0f;
};

/// The target edge length of level snow, in metres.
float level_edge(const SurfaceDensity& density, const Coarseness& coarseness) {
  const float depths = std::min(kLevelEdge * density.scale * coarseness.level, kMaxLevelEdge);
  return std::max(depths * density.depth * coarseness.hems, kMinLevelEdge);
}

/// Refines one receiver at one density.
class Refiner {
 public:
  Refiner(const Rims& rims, const RimZones& zones, const SurfaceHeights& heights,
          const SurfaceDensity& density, const Coarseness& coarseness, const SurfaceMesh& receiver)
      : rims_(rims),
        zones_(zones),
        heights_(heights),
        unit_(density.depth * density.scale * coarseness.hems),
        level_edge_(level_edge(density, coarseness)),
        depth_(density.depth),
        least_edge_((heights.dented != nullptr ? kDentEdge : kMinEdge) * unit_),
        is_coarse_(coarseness.hems > kCoarse),
        shown_(std::min(kShown, kShownShare * density.depth)),
        most_(static_cast<size_t>(density.most_points) * 2),
        mesh_(receiver) {}

  SurfaceMesh run() {
    constexpr int kRounds = 26;
    for (int round = 0; round < kRounds && halve(); ++round) {
    }
    if (!rims_.all().empty() && cuts() != nullptr) {
      constexpr int kCutRounds = 6, kAlongRounds = 12;
      for (int round = 0; round < kCutRounds && cut_parallel(); ++round) {
      }
      for (int round = 0; round < kAlongRounds && cut_along(); ++round) {
      }
    }
    return kept();
  }

 private:
  bool is_full() const { return mesh_.position.size() > most_; }

  float height_at(const float* map, const glm::vec2& uv) const {
    return std::abs(map_value(map, heights_.resolution, map_sample(uv, heights_.resolution)));
  }

  /// Heights at the points, averaged over their corners.
  std::vector<float> point_heights() const {
    std::vector<float> sum(mesh_.position.size(), 0.0f);
    std::vector<float> count(mesh_.position.size(), 0.0f);
    for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        sum[mesh_.triangle[t][k]] += height_at(heights_.last, mesh_.uv[t][k]);
        count[mesh_.triangle[t][k]] += 1.0f;
      }
    }
    for (size_t p = 0; p < sum.size(); ++p) sum[p] /= std::max(count[p], 1.0f);
    return sum;
  }

  /// The greatest height at each point and at the points around it.
  std::vector<float> heights_around(const std::vector<float>& heights) const {
    std::vector<float> around = heights;
    for (const auto& corners : mesh_.triangle) {
      const float most = std::max({heights[corners[0]], heights[corners[1]], heights[corners[2]]});
      for (const int32_t p : corners) around[p] = std::max(around[p], most);
    }
    return around;
  }

  /// The target length of the edge from corner k to corner k + 1 of a triangle.
  float wanted_length(size_t triangle, int k, float length, const std::vector<float>& heights,
                      const std::vector<float>& around) const {
    const int next = (k + 1) % 3;
    const std::array<int32_t, 2> ends{mesh_.triangle[triangle][k], mesh_.triangle[triangle][next]};
    const glm::vec2 uv = (mesh_.uv[triangle][k] + mesh_.uv[triangle][next]) * 0.5f;
    const glm::vec3& a = mesh_.normal[triangle][k];
    const glm::vec3& b = mesh_.normal[triangle][next];
    const float height = height_at(heights_.last, uv);
    const float mean = (heights[ends[0]] + heights[ends[1]]) * 0.5f;
    const bool covered =
        std::max(height, mean) > shown_ || height_at(heights_.highest, uv) > shown_;
    const bool bends = glm::distance(a, b) > kBends;
    const float up = std::min(a.z, b.z);
    float wanted = covered ? level_edge_ : kBareEdge * unit_;
    if (bends) wanted = std::min(wanted, (covered ? kCurvedEdge : 0.5f) * unit_);
    if (covered && up < 0.93f && std::min(height, mean) < kEnding * depth_) {
      wanted = std::min(wanted, kEndingEdge * unit_);
    }
    // Where shelter thins out level snow, its border needs the same edge length, and so do the bare
    // faces along a border: the smoothed heights end there.
    const bool thins_out = std::min(height, mean) < kBorder * depth_ &&
                           std::max(around[ends[0]], around[ends[1]]) > shown_;
    if (thins_out) wanted = std::min(wanted, kEndingEdge * unit_);
    const float off = std::abs(height - mean);
    if (off > kOffDeep * depth_ || (off > kOffThin * depth_ && height < kThin * depth_)) {
      wanted = std::min(wanted, std::max(0.6f * length, kMinEdge * unit_));
    }
    // Otherwise a heap on a small top would be flat.
    if (is_coarse_ && off > kOffAnyway * depth_ && length > kAnywayEdge * depth_) return 0.0f;
    if (heights_.dented != nullptr) wanted = std::min(wanted, dent_length(triangle, k, length));
    if (!rims_.all().empty()) {
      const bool at_foot = covered && (at_foot_[ends[0]] != 0 || at_foot_[ends[1]] != 0);
      if (at_foot) wanted = std::min(wanted, kFootEdge * unit_);
      const float distance = 0.5f * (rim_distance_[ends[0]] + rim_distance_[ends[1]]);
      const float off_zone = distance - rim_zone(depth_) * 0.8f;
      // In the zone the front determines the shape, not the map, unless the snow ends there below
      // another piece.
      if (off_zone < 0.0f) {
        const bool ends_there =
            std::min(heights[ends[0]], heights[ends[1]]) < shown_ &&
            std::max(heights[ends[0]], heights[ends[1]]) > kBorder * depth_ &&
            std::min(rim_distance_[ends[0]], rim_distance_[ends[1]]) > kOffRim * depth_;
        // A body within the zone, such as the earth in a pot, has no rows along the rim.
        const size_t lower = heights[ends[0]] < heights[ends[1]] ? 0 : 1;
        const bool is_own_shape =
            off > kOffAnyway * depth_ && rim_distance_[ends[lower]] > kAtRim * depth_;
        if (is_own_shape) return std::max(0.6f * length, kFootEdge * unit_);
        return (ends_there ? kEndingEdge : at_foot ? kFootEdge : kRimEdge) * unit_;
      }
      wanted = std::min(wanted, kRimEdge * unit_ + kGrowth * off_zone);
    }
    return wanted;
  }

  /// The target length at the walls of prints.
  float dent_length(size_t triangle, int k, float length) const {
    const auto height = [&](const glm::vec2& uv) {
      return map_value(heights_.dented, heights_.resolution, map_sample(uv, heights_.resolution));
    };
    const glm::vec2& a = mesh_.uv[triangle][k];
    const glm::vec2& b = mesh_.uv[triangle][(k + 1) % 3];
    const float off = std::abs(height((a + b) * 0.5f) - 0.5f * (height(a) + height(b)));
    return off > kOffDent * depth_ ? std::max(0.6f * length, least_edge_)
                                   : std::numeric_limits<float>::infinity();
  }

  /// Computes the distance to the nearest rim for new points.
  void find_rim_distances() {
    const size_t known = rim_distance_.size();
    rim_distance_.resize(mesh_.position.size(), rim_zone(depth_) * 1.15f);
    at_foot_.resize(mesh_.position.size(), 0);
    if (rims_.all().empty()) return;
    std::vector<int32_t> corner(mesh_.position.size() - known, -1);
    for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const auto p = static_cast<size_t>(mesh_.triangle[t][k]);
        if (p >= known) corner[p - known] = static_cast<int32_t>(t * 3) + k;
      }
    }
    base::for_each_item(corner.size(), 256, [&](size_t i) {
      if (corner[i] < 0) return;
      const auto t = static_cast<size_t>(corner[i]) / 3;
      const glm::vec3& at = mesh_.position[known + i];
      const glm::vec3& normal = mesh_.normal[t][corner[i] % 3];
      rim_distance_[known + i] = rims_.distance(at, normal, zones_.part(mesh_.base[t]), true);
      at_foot_[known + i] = is_at_foot(rims_, at, normal, depth_) ? 1 : 0;
    });
  }

  /// Halves the edges that are too long, once. Returns true if it split an edge.
  bool halve() {
    if (is_full()) return false;
    const SurfaceEdges edges = surface_edges(mesh_.triangle);
    const std::vector<float> heights = point_heights();
    const std::vector<float> around = heights_around(heights);
    find_rim_distances();
    std::vector<uint8_t> marked(edges.ends.size(), 0);
    std::vector<int32_t> seen_from(edges.ends.size(), -1);
    for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
      for (int k = 0; k < 3; ++k)
        seen_from[edges.of_triangle[t][k]] = static_cast<int32_t>(t * 3 + k);
    }
    base::for_each_item(edges.ends.size(), 1024, [&](size_t e) {
      const auto& ends = edges.ends[e];
      const float length = glm::distance(mesh_.position[ends[0]], mesh_.position[ends[1]]);
      if (length < least_edge_) return;
      const auto t = static_cast<size_t>(seen_from[e]) / 3;
      marked[e] = length > wanted_length(t, seen_from[e] % 3, length, heights, around) ? 1 : 0;
    });
    if (std::find(marked.begin(), marked.end(), 1) == marked.end()) return false;
    const std::vector<uint8_t> spared = sliver_diagonals(mesh_, edges);
    const bool any_spared = std::find(spared.begin(), spared.end(), 1) != spared.end();
    mark_longest(mesh_, edges, spared, marked);
    std::vector<float> share(marked.size());
    for (size_t e = 0; e < marked.size(); ++e) {
      share[e] = marked[e] != 0 && spared[e] == 0 ? 0.5f : 0.0f;
    }
    split_edges(mesh_, edges, share);
    if (any_spared) flip_edges(mesh_, mesh_.position);
    return true;
  }

  /// Splits edges at the shares that share_of(p, q) returns for their ends, 0 for an edge that
  /// stays whole. Returns true if it split an edge.
  template <typename ShareOf>
  bool split_at(const ShareOf& share_of) {
    if (is_full()) return false;
    const SurfaceEdges edges = surface_edges(mesh_.triangle);
    zones_.find(mesh_, zone_);
    std::vector<float> share(edges.ends.size(), 0.0f);
    bool any = false;
    for (size_t e = 0; e < edges.ends.size(); ++e) {
      share[e] = share_of(edges.ends[e][0], edges.ends[e][1]);
      any = any || share[e] > 0.0f;
    }
    if (any) split_edges(mesh_, edges, share);
    return any;
  }

  /// Splits every edge where it crosses a cut parallel to a rim. Returns true if it split an edge.
  bool cut_parallel() {
    return split_at([&](int32_t p, int32_t q) {
      if (lies_across(p, q) || cuts_corner(p, q)) return 0.5f;
      return is_short_on_strip(p, q) ? 0.0f : cut_of(zone_[p], zone_[q]);
    });
  }

  /// True if the edge crosses the middle of a narrow top, from one rim's zone into another's.
  bool lies_across(int32_t p, int32_t q) const {
    const RimZones::Zone& a = zone_[p];
    const RimZones::Zone& b = zone_[q];
    if (a.place.is_far_off || b.place.is_far_off || a.share < 0.0f || b.share < 0.0f) return false;
    if (std::min(a.share, b.share) > kAcross || glm::dot(a.place.out, b.place.out) > 0.5f)
      return false;
    return glm::distance(mesh_.position[p], mesh_.position[q]) > 1.2f * std::max(a.room, b.room);
  }

  /// True if the edge goes across a corner of a top, from one rim to the next: its middle lies
  /// farther into the zones than both ends.
  bool cuts_corner(int32_t p, int32_t q) const {
    const RimZones::Zone& a = zone_[p];
    const RimZones::Zone& b = zone_[q];
    if (a.place.is_far_off || b.place.is_far_off || a.share < 0.0f || b.share < 0.0f) return false;
    if (glm::dot(a.place.out, b.place.out) < kOpposite) return false;
    const glm::vec3 half = 0.5f * (mesh_.position[q] - mesh_.position[p]);
    const float deeper = std::min(-glm::dot(half, a.place.out), glm::dot(half, b.place.out));
    return deeper > kCorner * std::max(a.support, b.support);
  }

  /// True if the edge is short and lies on the strip of a rim.
  bool is_short_on_strip(int32_t p, int32_t q) const {
    return lies_on_strip(p) && lies_on_strip(q) &&
           glm::distance(mesh_.position[p], mesh_.position[q]) < kStripEdge * unit_;
  }
  bool lies_on_strip(int32_t p) const {
    const RimPosition& place = zone_[p].place;
    return !place.is_far_off && std::abs(place.distance) < kOnStrip * place.strip;
  }

  /// The cuts of this coarseness; none if it is too great for any.
  const Cuts* cuts() const {
    const auto found = std::find_if(kCuts.begin(), kCuts.end(), [&](const Cuts& cuts) {
      return unit_ < cuts.coarseness * depth_;
    });
    return found == kCuts.end() ? nullptr : &*found;
  }

  float cut_of(const RimZones::Zone& a, const RimZones::Zone& b) const {
    if (a.place.is_far_off && b.place.is_far_off) return 0.0f;
    constexpr float kBeyond = 1.2f;
    float from = a.share;
    float to = b.share;
    if (a.place.is_far_off) from = b.share < 0.0f ? -kBeyond : kBeyond;
    if (b.place.is_far_off) to = a.share < 0.0f ? -kBeyond : kBeyond;
    if (from == to) return 0.0f;
    float best = 0.0f;
    const auto look_at = [&](float share) {
      const float at = (share - from) / (to - from);
      if (at > kSnap && at < 1.0f - kSnap && std::abs(at - 0.5f) < std::abs(best - 0.5f)) best = at;
    };
    for (const float share : cuts()->shares) {
      if (share != 0.0f) look_at(share);
    }
    return best;
  }

  /// Divides long edges along the rims, within their zones. Returns true if it split an edge.
  bool cut_along() {
    return split_at([&](int32_t p, int32_t q) {
      const RimZones::Zone& a = zone_[p];
      const RimZones::Zone& b = zone_[q];
      if (a.place.is_far_off || b.place.is_far_off) return 0.0f;
      if (std::abs(a.share) > 1.02f || std::abs(b.share) > 1.02f) return 0.0f;
      // Divide only edges on one cut. The edges between the cuts follow from them.
      if (std::abs(a.share - b.share) > kOneCut) return 0.0f;
      const bool on_strip = lies_on_strip(p) || lies_on_strip(q);
      const float row = kOneRow * a.place.strip / static_cast<float>(a.place.strip_faces + 1);
      if (on_strip && std::abs(a.place.distance - b.place.distance) > row) return 0.0f;
      const glm::vec3 axis = glm::cross(a.place.out, a.place.support);
      const float along = std::abs(glm::dot(mesh_.position[q] - mesh_.position[p], axis));
      const float narrow = std::clamp(a.support / rim_zone(depth_), kMinAlong, 1.0f);
      const float inland =
          std::clamp((a.share - kHemEnds) / (kInlandBegins - kHemEnds), 0.0f, 1.0f);
      const float parts =
          std::ceil(along / (glm::mix(kAlongHem, kAlongInland, inland) * unit_ * narrow));
      return parts > 1.0f ? std::floor(0.5f * parts) / parts : 0.0f;
    });
  }

  /// The faces that carry snow in any frame, the fronts at rims, and a few rings around them.
  SurfaceMesh kept() {
    std::vector<uint8_t> keep(mesh_.position.size(), 0);
    for (size_t t = 0; t < mesh_.triangle.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const glm::vec2 between = (mesh_.uv[t][k] + mesh_.uv[t][(k + 1) % 3]) * 0.5f;
        if (height_at(heights_.highest, mesh_.uv[t][k]) > shown_ ||
            height_at(heights_.highest, between) > shown_) {
          for (const int32_t p : mesh_.triangle[t]) keep[p] = 1;
        }
      }
    }
    std::vector<uint8_t> stays(mesh_.triangle.size(), 0);
    const auto spread = [&](int rings) {
      for (int ring = 0; ring < rings; ++ring) {
        for (size_t t = 0; t < stays.size(); ++t) {
          const auto& [a, b, c] = mesh_.triangle[t];
          stays[t] = keep[a] != 0 || keep[b] != 0 || keep[c] != 0 ? 1 : 0;
        }
        for (size_t t = 0; t < stays.size(); ++t) {
          if (stays[t] == 0) continue;
          for (const int32_t p : mesh_.triangle[t]) keep[p] = 1;
        }
      }
    };
    spread(kRings);
    if (!rims_.all().empty()) {
      // Keep the far face below rims that have snow.
      zones_.find(mesh_, zone_);
      const std::vector<RimZones::Zone>& zones = zone_;
      std::vector<CellGrid::Box> snowy;
      for (size_t p = 0; p < zones.size(); ++p) {
        if (keep[p] != 0 && !zones[p].place.is_far_off && zones[p].share >= 0.0f) {
          snowy.push_back({mesh_.position[p], mesh_.position[p]});
        }
      }
      const float near = kKeptFar * depth_;
      const CellGrid grid(snowy, std::max(near, 1e-4f));
      for (size_t p = 0; p < zones.size(); ++p) {
        const RimZones::Zone& zone = zones[p];
        if (zone.place.is_far_off || zone.share >= 0.0f || -zone.place.distance > near) continue;
        bool found = false;
        grid.visit(zone.place.foot - near, zone.place.foot + near, [&](int32_t) { found = true; });
        if (found) keep[p] = 1;
      }
      spread(1);
    }
    return submesh(mesh_, stays);
  }

  const Rims& rims_;
  const RimZones& zones_;
  const SurfaceHeights& heights_;
  float unit_;
  float level_edge_;
  float depth_;
  float least_edge_;
  bool is_coarse_;
  float shown_;
  size_t most_;
  SurfaceMesh mesh_;
  /// Zones of the points so far.
  std::vector<RimZones::Zone> zone_;
  std::vector<float> rim_distance_;
  /// 1 for points at the foot of a step that snow may hide.
  std::vector<uint8_t> at_foot_;
};

/// Numbers of points grow with the inverse of the edge length at hems to this power: rows along
/// rims are denser, and there are more of them.
constexpr double kPower = 1.5;
/// Coarseness of the mesh that tells how many points hems need.
constexpr float kProbe = 4.0f;

float most_level(const SurfaceDensity& density) {
  return std::max(kMaxLevelEdge / (kLevelEdge * density.scale), 1.0f);
}

/// The number of points at hems with the default edge lengths, from that of a coarser mesh.
double hem_points(const SurfaceMesh& receiver, double points, float coarseness) {
  const double own = std::min(static_cast<double>(receiver.position.size()), points);
  return own + (points - own) * std::pow(coarseness, kPower);
}

}  // namespace

RefinedSurface refined_surface(const SurfaceMesh& receiver, const Rims& rims, const RimZones& zones,
                               const SurfaceHeights& heights, const SurfaceDensity& density) {
  const double most = density.most_points;
  Coarseness coarseness{kProbe, most_level(density)};
  const auto mesh_now = [&] {
    return Refiner(rims, zones, heights, density, coarseness, receiver).run();
  };
  const double hems = hem_points(receiver, static_cast<double>(mesh_now().position.size()), kProbe);
  // The finest coarseness of hems that is known not to fit, or not expected to.
  float too_fine = 0.0f;
  coarseness = {};
  if (hems > most) {
    constexpr float kMargin = 1.5f;
    coarseness = {static_cast<float>(std::pow(hems / most, 1.0 / kPower)), most_level(density)};
    too_fine = std::max(coarseness.hems / kMargin, 1.0f);
  }
  // The number of points falls in steps, as rows of cuts are left out: once a mesh fits, the points
  // that it leaves unused are handed out by halving.
  constexpr int kTries = 10, kHalvings = 3;
  constexpr double kUsed = 0.75;
  constexpr double kMinGrowth = 1.15, kMaxGrowth = 2.5;
  RefinedSurface best;
  bool is_found = false;
  int halvings = 0;
  for (int attempt = 1;; ++attempt) {
    SurfaceMesh mesh = mesh_now();
    const auto points = static_cast<double>(mesh.position.size());
    const bool fits = points <= most;
    // The mesh cannot have fewer points than the receiver's own faces.
    const bool is_least = points < 1.05 * static_cast<double>(receiver.position.size());
    if (fits || is_least || (attempt == kTries && !is_found)) {
      best = {std::move(mesh), coarseness.hems};
      is_found = true;
    }
    if (is_found && (attempt >= kTries || halvings == kHalvings || too_fine <= 0.0f ||
                     static_cast<double>(best.mesh.position.size()) > kUsed * most)) {
      return best;
    }
    if (is_found) {
      if (!fits) too_fine = coarseness.hems;
      coarseness.hems = std::sqrt(too_fine * best.coarsened);
      ++halvings;
    } else if (coarseness.level < most_level(density)) {
      const double left = most - hems;
      const double factor = left > 0.0 ? std::sqrt((points - hems) / left) : kMaxGrowth;
      coarseness.level = std::min(
          coarseness.level * static_cast<float>(std::max(factor, kMinGrowth)), most_level(density));
    } else {
      too_fine = coarseness.hems;
      coarseness.hems *= static_cast<float>(
          std::clamp(std::pow(points / most, 1.0 / kPower), kMinGrowth, kMaxGrowth));
    }
  }
}

PointCounts wanted_points(const SurfaceMesh& receiver, const Rims& rims, const RimZones& zones,
                          const SurfaceHeights& heights, float depth) {
  SurfaceDensity density;
  density.depth = depth;
  // A number of points from which on a coarser mesh is as good.
  density.most_points = 50000;
  double area = 0.0;
  for (size_t t = 0; t < receiver.triangle.size(); ++t) {
    area += 0.5 * std::max(static_cast<double>(triangle_cross(receiver, t).z), 0.0);
  }
  // Halved edges are shorter than wanted: two points for each square of that size.
  const auto level_points = [&](const Coarseness& coarseness) {
    const double edge = level_edge(density, coarseness);
    return 2.0 * area / (edge * edge);
  };
  const float most = most_level(density);
  Coarseness coarseness{kProbe, most};
  const auto points = [&] {
    const SurfaceMesh mesh = Refiner(rims, zones, heights, density, coarseness, receiver).run();
    return static_cast<double>(mesh.position.size());
  };
  double coarse = points();
  constexpr float kCoarsest = 16.0f;
  while (coarse > density.most_points && coarseness.hems < kCoarsest) {
    coarseness.hems *= 2.0f;
    coarse = points();
  }
  const double at_hems = std::max(coarse - level_points(coarseness), 0.0);
  const double level = level_points({1.0f, most});
  return {hem_points(receiver, at_hems, coarseness.hems) + level, level_points({}) - level};
}

}  // namespace snowbough::snow
