#include "snow/surface/rim_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "base/parallel_for.h"
#include "base/union_find.h"
#include "snow/surface/beyond.h"
#include "snow/surface/flip_edges.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

/// Upward component of normals: least value of a supporting face, greatest value of a far face, and
/// least value of the face that follows a far face over a strip.
constexpr float kCarries = 0.3f;
constexpr float kGoesDown = 0.35f;
constexpr float kTurnsUnder = -0.15f;
/// Least difference of the upward components of the supporting and the far face.
constexpr float kTurnsDown = 0.45f;
/// Cosine of the least angle between the faces at a rim: 50 degrees, or 75 if they are smooth
/// shaded.
constexpr float kSharp = 0.643f;
constexpr float kSharpSmooth = 0.259f;
/// Least sine of the turn at the upper edge of a strip, and at edges within it.
constexpr float kBegins = 0.05f;
constexpr float kTurns = 0.02f;
/// Faces of a strip may turn back up by this much: those of uneven stones are not quite flat.
constexpr float kUneven = 0.25f;
/// Cosine of the greatest angle between triangles that count as one face.
constexpr float kOneFace = 0.9998f;
/// The supporting face of a strip must be flat over this many widths of the strip, up to this
/// slope.
constexpr float kFlatWidths = 1.1f;
constexpr float kFlatSlope = 0.15f;
/// Least length of adjacent rims, in widths of their strips, and as a fraction of the greatest
/// width of a strip. A top with shorter rims is too small for a front.
constexpr float kMinWidths = 2.5f;
constexpr float kMinOfStrip = 0.75f;
/// The same for open edges that are shaded smooth.
constexpr float kMinEdges = 24.0f;
/// Distance off a rim at which it may lie within another piece, in greatest widths of a strip.
constexpr float kOnRim = 0.05f;
/// Metres within which the other side of a body is looked for.
constexpr double kOtherSide = 1e3;
/// Cosine of the least angle at which the surface behind a rim turns down from the supporting face.
constexpr float kSameSide = 0.5f;
/// Greatest number of triangles across a strip.
constexpr int kMaxSteps = 64;
/// Position on an edge at which a strip is measured. The middle would hit the vertices of regular
/// meshes.
constexpr float kMeasured = 0.47f;

/// Length of the surface below the middle of the rim, in metres, measured in steps.
float far_extent(const Rim& rim, const base::TriangleTree& tree, float most) {
  if (rim.down == glm::vec3(0.0f)) return most;
  constexpr int kSteps = 6;
  const glm::vec3 begin = (rim.from + rim.to) * 0.5f + rim.down * rim.strip_down;
  for (int k = 1; k <= kSteps; ++k) {
    const float along = most * static_cast<float>(k) / kSteps;
    const double off = 0.04 * most + 0.15 * along;
    if (tree.nearest(0, begin + rim.down * along).squared_distance > off * off) {
      return std::max(most * static_cast<float>(k - 1) / kSteps, 0.05f * most) + rim.strip_down;
    }
  }
  return most + rim.strip_down;
}

class RimFinder {
 public:
  RimFinder(const SurfaceMesh& mesh, const base::TriangleTree& tree,
            const std::vector<int32_t>& shading, const RimReach& reach)
      : mesh_(mesh),
        tree_(tree),
        shading_(shading),
        reach_(reach),
        edges_(surface_edges(mesh.triangle)),
        faces_(edge_corners(edges_)),
        normals_(triangle_normals(mesh)) {}

  /// A rim, or none with support (0, 0, 0), and the faces of its strip.
  struct Found {
    Rim rim{};
    int32_t support = -1;
    std::vector<int32_t> strip;
    /// True for an open edge that is shaded smooth.
    bool is_smooth = false;
  };

  size_t edge_count() const { return edges_.ends.size(); }

  Found find(size_t edge) const {
    const EdgeCorners& faces = faces_[edge];
    Found found;
    if (faces.count == 1) {
      open_edge(edge, faces.corner[0].triangle, found);
    } else if (faces.count == 2) {
      int32_t carrier = faces.corner[0].triangle;
      int32_t far = faces.corner[1].triangle;
      if (normals_[far].z > normals_[carrier].z) std::swap(carrier, far);
      turn(edge, carrier, far, found);
    }
    return found;
  }

 private:
  /// A position on the way over the mesh within a plane: the face ahead, and where the way enters
  /// it.
  struct Step {
    int32_t face = -1;
    int32_t edge = -1;
    glm::vec3 at{0.0f};
  };

  void open_edge(size_t edge, int32_t face, Found& found) const {
    if (normals_[face].z < kCarries) return;
    ends(edge, found.rim);
    // The open edge of a smooth shell within a body, such as an eye in its socket, is not a rim.
    found.is_smooth = shading_number(face, edges_.ends[edge][0]) >= 0;
    if (found.is_smooth && is_inside(0.5f * (found.rim.from + found.rim.to))) {
      found = {};
      return;
    }
    found.rim.support = normals_[face];
    found.rim.far_normal = found.rim.down = glm::vec3(0.0f);
    found.rim.out = away(edge, face);
    found.rim.extent = extent_behind(edge, face, found.rim.out);
    found.support = face;
  }

  bool is_inside(const glm::vec3& place) const {
    const auto normal_up = [&](double z) {
      const auto hit = tree_.first_along(0, glm::dvec3(place), {0.0, 0.0, z}, 1e-4, kOtherSide);
      return hit.triangle < 0 ? 0.0f : normals_[static_cast<size_t>(hit.triangle)].z;
    };
    return normal_up(1.0) > 0.0f && normal_up(-1.0) < 0.0f;
  }

  /// The rim at an edge over which the surface turns down, at once or over a strip.
  void turn(size_t edge, int32_t carrier, int32_t first, Found& found) const {
    const glm::vec3& a = normals_[carrier];
    if (a.z < kCarries) return;
    const glm::vec3 out = away(edge, carrier);
    if (glm::dot(out, normals_[first]) < kBegins) return;
    const glm::vec3 along =
        unit(mesh_.position[edges_.ends[edge][1]] - mesh_.position[edges_.ends[edge][0]]);
    const float side = glm::dot(glm::cross(along, a), out) > 0.0f ? 1.0f : -1.0f;
    const glm::vec3 start = glm::mix(mesh_.position[edges_.ends[edge][0]],
                                     mesh_.position[edges_.ends[edge][1]], kMeasured);
    Step step{first, static_cast<int32_t>(edge), start};
    bool smooth = is_smooth(step.edge, carrier, first);
    float width = 0.0f;
    int32_t edges_across = 0;
    std::vector<int32_t> strip;
    for (int k = 0; k < kMaxSteps; ++k) {
      const glm::vec3& b = normals_[step.face];
      const Step next = crossed(step, along, start);
      const float across = glm::distance(next.at, step.at);
      const bool is_far = b.z <= kGoesDown && b.z <= a.z - kTurnsDown &&
                          glm::dot(a, b) <= (smooth ? kSharpSmooth : kSharp);
      const bool goes_on = next.face >= 0 && width + across <= reach_.strip &&
                           normals_[next.face].z >= (is_far ? kTurnsUnder : -1.0f) &&
                           normals_[next.face].z <= b.z + kUneven &&
                           (!is_far || normals_[next.face].z < b.z - kTurns);
      if (!goes_on) {
        if (!is_far) return;
        break;
      }
      width += across;
      strip.push_back(step.face);
      // The diagonals of flat faces do not count.
      if (glm::dot(b, normals_[next.face]) < kOneFace) ++edges_across;
      smooth = smooth && is_smooth(next.edge, step.face, next.face);
      step = next;
    }
    const glm::vec3& b = normals_[step.face];
    const glm::vec3 down = unit(side * glm::cross(along, b));
    if (!(glm::dot(out, b) > 0.0f)) return;
    if (!strip.empty() && !is_flat({carrier, static_cast<int32_t>(edge), start}, along, out, width))
      return;
    Rim& rim = found.rim;
    ends(edge, rim);
    rim.support = a;
    rim.far_normal = b;
    rim.out = out;
    rim.down = down;
    rim.extent = extent_behind(edge, carrier, out);
    if (!strip.empty()) meet(rim, step.at - start, width);
    rim.strip_faces = edges_across;
    found.support = carrier;
    found.strip = std::move(strip);
  }

  /// Moves a rim from the upper edge of a strip to the line at which both planes meet. `over`: from
  /// the upper to the lower edge.
  static void meet(Rim& rim, const glm::vec3& over, float width) {
    const float c = glm::dot(rim.out, rim.down);
    const float square = std::max(1.0f - c * c, 0.05f);
    const float x = glm::dot(over, rim.out), y = glm::dot(over, rim.down);
    rim.strip_out = std::clamp((x - c * y) / square, 0.0f, width);
    rim.strip_down = std::clamp((y - c * x) / square, 0.0f, width);
  }

  /// Length of the supporting face behind an edge: to where the surface ends or turns down. A face
  /// that ends at a wall counts twice: the snow is as thick there as in front of it.
  float extent_behind(size_t edge, int32_t carrier, const glm::vec3& out) const {
    const glm::vec3& from = mesh_.position[edges_.ends[edge][0]];
    const glm::vec3& to = mesh_.position[edges_.ends[edge][1]];
    const glm::vec3 start = glm::mix(from, to, kMeasured);
    const glm::vec3 along = unit(to - from);
    Step step{carrier, static_cast<int32_t>(edge), start};
    for (int k = 0; k < kMaxSteps; ++k) {
      step = crossed(step, along, start);
      const float back = glm::dot(start - step.at, out);
      if (back >= reach_.support) break;
      if (step.face < 0) return back;
      const glm::vec3& next = normals_[step.face];
      if (glm::dot(next, normals_[carrier]) < kSameSide) {
        return glm::dot(next, out) < 0.0f ? back : std::min(2.0f * back, reach_.support);
      }
    }
    return reach_.support;
  }

  /// True if the surface behind an edge is flat over some widths.
  bool is_flat(Step step, const glm::vec3& along, const glm::vec3& out, float width) const {
    const glm::vec3 start = step.at;
    const glm::vec3& normal = normals_[step.face];
    for (int k = 0; k < kMaxSteps; ++k) {
      step = crossed(step, along, start);
      const float back = -glm::dot(step.at - start, out);
      const bool level = std::abs(glm::dot(step.at - start, normal)) <= kFlatSlope * back + 1e-6f;
      if (back >= kFlatWidths * width) return level || k == 0;
      if (!level || step.face < 0) return false;
    }
    return false;
  }

  /// Crosses the face ahead within the plane through `start` that is perpendicular to `along`.
  Step crossed(const Step& step, const glm::vec3& along, const glm::vec3& start) const {
    const auto& corner = mesh_.triangle[step.face];
    const auto& sides = edges_.of_triangle[step.face];
    std::array<float, 3> off{};
    int own = 0;
    for (int k = 0; k < 3; ++k) {
      off[k] = glm::dot(mesh_.position[corner[k]] - start, along);
      if (sides[k] == step.edge) own = k;
    }
    // Leave through the side whose other end lies across the plane from the corner opposite.
    const int opposite = (own + 2) % 3;
    const bool to_first = (off[opposite] > 0.0f) != (off[own] > 0.0f);
    const int k = to_first ? opposite : (own + 1) % 3;
    const int end = (k + 1) % 3;
    const float between = off[k] - off[end];
    const float share = between != 0.0f ? std::clamp(off[k] / between, 0.0f, 1.0f) : 0.5f;
    Step next;
    next.at = glm::mix(mesh_.position[corner[k]], mesh_.position[corner[end]], share);
    next.edge = sides[k];
    const EdgeCorners& faces = faces_[next.edge];
    if (faces.count == 2) {
      next.face = faces.corner[faces.corner[0].triangle == step.face ? 1 : 0].triangle;
    }
    return next;
  }

  void ends(size_t edge, Rim& rim) const {
    rim.from = mesh_.position[edges_.ends[edge][0]];
    rim.to = mesh_.position[edges_.ends[edge][1]];
    rim.corner = edges_.ends[edge];
  }
  int32_t shading_number(int32_t face, int32_t point) const {
    if (shading_.empty()) return -1;
    for (int32_t k = 0; k < 3; ++k) {
      if (mesh_.triangle[face][k] == point) return shading_[mesh_.base[face] * 3 + k];
    }
    return -1;
  }
  /// True if both faces share their normals along the edge.
  bool is_smooth(int32_t edge, int32_t face, int32_t other) const {
    for (const int32_t point : edges_.ends[edge]) {
      const int32_t number = shading_number(face, point);
      if (number < 0 || number != shading_number(other, point)) return false;
    }
    return true;
  }
  /// Unit vector in the plane of the face, across the edge and away from the face.
  glm::vec3 away(size_t edge, int32_t face) const {
    const auto& [a, b, c] = mesh_.triangle[face];
    const glm::vec3 middle = (mesh_.position[a] + mesh_.position[b] + mesh_.position[c]) / 3.0f;
    const glm::vec3& from = mesh_.position[edges_.ends[edge][0]];
    const glm::vec3& to = mesh_.position[edges_.ends[edge][1]];
    const glm::vec3 across = glm::cross(unit(to - from), normals_[face]);
    return glm::dot(across, (from + to) * 0.5f - middle) > 0.0f ? across : -across;
  }

  const SurfaceMesh& mesh_;
  const base::TriangleTree& tree_;
  const std::vector<int32_t>& shading_;
  RimReach reach_;
  SurfaceEdges edges_;
  std::vector<EdgeCorners> faces_;
  std::vector<glm::vec3> normals_;
};

/// Removes adjacent rims that are hardly longer than their strips are wide, or shorter than
/// `least`: on curved and scanned bodies a few edges look like rims by chance.
void drop_short_rims(std::vector<Rim>& rims, size_t points, float least) {
  base::UnionFind joined(points);
  for (const Rim& rim : rims) joined.join(rim.corner[0], rim.corner[1]);
  const std::vector<int32_t> chain = std::move(joined).all();
  std::vector<float> length(points, 0.0f);
  for (const Rim& rim : rims) length[chain[rim.corner[0]]] += glm::distance(rim.from, rim.to);
  std::erase_if(rims, [&](const Rim& rim) {
    return length[chain[rim.corner[0]]] <
           std::max(kMinWidths * (rim.strip_out + rim.strip_down), least);
  });
}

/// Removes rims within other pieces, such as the back edge of a stair's tread: `off`: metres off a
/// rim, inwards and upwards, at which it is looked at.
void drop_hidden_rims(std::vector<Rim>& rims, const SurfaceMesh& mesh,
                      const base::TriangleTree& tree, float off) {
  std::vector<uint8_t> hidden(rims.size());
  base::for_each_item(rims.size(), 64, [&](size_t r) {
    const Rim& rim = rims[r];
    hidden[r] = 1;
    for (const float share : {0.02f, 0.5f, 0.98f}) {
      const glm::vec3 place = glm::mix(rim.from, rim.to, share) - rim.out * off;
      if (!is_within(tree, mesh.position, mesh.triangle, place + glm::vec3(0.0f, 0.0f, off)))
        hidden[r] = 0;
    }
  });
  size_t next = 0;
  std::erase_if(rims, [&](const Rim&) { return hidden[next++] != 0; });
}

/// Moves rims from the upper edges of their strips to the lines at which the planes of both faces
/// meet. Rims with a common end still meet.
void move_out(std::vector<Rim>& rims, size_t points) {
  struct Corner {
    glm::mat3 square{0.0f};
    glm::vec3 sum{0.0f};
    float most = 0.0f;
  };
  std::vector<Corner> corners(points);
  for (const Rim& rim : rims) {
    for (const int32_t end : rim.corner) {
      corners[end].square += glm::outerProduct(rim.out, rim.out);
      corners[end].sum += rim.strip_out * rim.out;
      corners[end].most = std::max(corners[end].most, rim.strip_out);
    }
  }
  // Least squares: each end moves by strip_out along the direction of each of its rims.
  constexpr float kSmall = 0.01f;
  constexpr float kFarthest = 2.0f;
  for (Rim& rim : rims) {
    for (const size_t k : {0, 1}) {
      const Corner& corner = corners[rim.corner[k]];
      if (corner.most <= 0.0f) continue;
      const glm::vec3 shift =
          glm::inverse(corner.square + glm::mat3(kSmall)) * corner.sum * (1.0f + 0.5f * kSmall);
      const float length = glm::length(shift);
      (k == 0 ? rim.from : rim.to) += shift * std::min(1.0f, kFarthest * corner.most / length);
    }
  }
}

}  // namespace

std::vector<Rim> find_rims(const SurfaceMesh& mesh, const base::TriangleTree& tree,
                           const std::vector<int32_t>& shading, const std::vector<int32_t>& parts,
                           const RimReach& reach) {
  const RimFinder finder(mesh, tree, shading, reach);
  std::vector<RimFinder::Found> found(finder.edge_count());
  base::for_each_item(found.size(), 256, [&](size_t e) { found[e] = finder.find(e); });
  // Of rims along one strip, only the uppermost counts.
  std::vector<uint8_t> in_strip(mesh.triangle.size(), 0);
  for (const auto& one : found) {
    for (const int32_t face : one.strip) in_strip[face] = 1;
  }
  std::vector<Rim> rims, edges;
  for (const auto& one : found) {
    if (one.support < 0 || in_strip[one.support] != 0) continue;
    std::vector<Rim>& list = one.is_smooth ? edges : rims;
    list.push_back(one.rim);
    list.back().part = parts[one.support];
  }
  drop_short_rims(rims, mesh.position.size(), kMinOfStrip * reach.strip);
  // Leaves end as the map says.
  drop_short_rims(edges, mesh.position.size(), kMinEdges * reach.strip);
  rims.insert(rims.end(), edges.begin(), edges.end());
  drop_hidden_rims(rims, mesh, tree, kOnRim * reach.strip);
  move_out(rims, mesh.position.size());
  base::for_each_item(rims.size(), 64,
                      [&](size_t r) { rims[r].far_extent = far_extent(rims[r], tree, reach.far); });
  return rims;
}

}  // namespace snowbough::snow
