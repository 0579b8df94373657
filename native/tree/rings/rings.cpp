#include "tree/rings/rings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/union_find.h"
#include "tree/rings/closed_ends.h"
#include "tree/rings/local_mesh.h"
#include "tree/skeleton/centreline.h"

namespace snowbough::tree {
namespace {

/// Ends whose radii differ by less than this fraction count as equally thick.
constexpr float kSameThickness = 0.02f;
/// Maximum distance of a cap's centre from its ring's plane, relative to the ring's radius.
constexpr float kFlatCap = 0.02f;
/// Bounds of a tube's ring sizes relative to their common number of vertices: two rings differ at
/// most by the ratio of both.
constexpr double kSmallestRing = 0.5;
constexpr double kLargestRing = 2.0;
constexpr size_t kMaxUneven = 4;
/// A limb shorter than this fraction of its radius is a disc, not a tube.
constexpr float kShortestLimb = 0.25f;

/// Whether two vertices of one row of `k` are neighbours in its cyclic order.
bool are_neighbours(int32_t a, int32_t b, int32_t k) {
  const int32_t apart = std::abs(a - b);
  return apart == 1 || apart == k - 1;
}

/// Whether rows of `k` consecutive vertices, with or without a single tip vertex, are this tube's
/// rings: each two rows are joined by a full belt of faces (2k triangles' worth; k at the tip)
/// along edges between neighbours, and an end is open or closed by k - 2 triangles' worth.
bool rows_are_rings(const LocalMesh& mesh, int32_t k) {
  const auto count = static_cast<int32_t>(mesh.positions.size());
  if (count % k > 1 || count < k + 1) return false;
  const int32_t rows = count / k;
  std::vector<int32_t> belt(static_cast<size_t>(rows) + 1, 0);
  std::vector<int32_t> cap(static_cast<size_t>(rows) + 1, 0);
  for (int32_t f = 0; f < mesh.face_count(); ++f) {
    const std::span<const int32_t> face = mesh.face(f);
    const auto [low, high] = std::minmax_element(face.begin(), face.end());
    const int32_t row = *low / k;
    const int32_t step = *high / k - row;
    if (step > 1) return false;
    (step == 0 ? cap : belt)[row] += static_cast<int32_t>(face.size()) - 2;
    for (size_t c = 0; step == 1 && c < face.size(); ++c) {
      const int32_t next = face[(c + 1) % face.size()];
      if (face[c] / k == next / k && !are_neighbours(face[c], next, k)) return false;
    }
  }
  for (int32_t row = 0; row < rows; ++row) {
    const bool end = row == 0 || (row + 1) * k == count;
    if (cap[row] != 0 && (!end || cap[row] != k - 2)) return false;
    if (row + 1 < rows && belt[row] != 2 * k) return false;
  }
  return count % k == 0 || belt[rows - 1] == k;
}

std::optional<Limb> trace_rows(const LocalMesh& mesh) {
  // Some face joins vertex i of a row to vertex i of the next, and no face spans 2k vertices.
  int32_t span = 0;
  for (int32_t f = 0; f < mesh.face_count(); ++f) {
    const auto [low, high] = std::minmax_element(mesh.face(f).begin(), mesh.face(f).end());
    span = std::max(span, *high - *low);
  }
  for (int32_t k = std::max(3, (span + 2) / 2); k <= span; ++k) {
    if (!rows_are_rings(mesh, k)) continue;
    Limb limb;
    const auto count = static_cast<int32_t>(mesh.positions.size());
    for (int32_t row = 0; row * k < count; ++row) {
      const int32_t size = std::min(k, count - row * k);
      append_ring(
          {mesh.positions.data() + static_cast<ptrdiff_t>(row) * k, static_cast<size_t>(size)},
          limb);
    }
    limb.reversible = count % k == 0;
    return limb;
  }
  return std::nullopt;
}

/// An open end is one ring, even if the rows before it are uneven: the other boundary loop becomes
/// the last layer.
void gather_far_end(const Topology& topology, Layers& layers) {
  if (topology.boundary_loops.size() != 2 || layers.size() < 2) return;
  const std::vector<int32_t>& near = layers.front();
  const bool first_is_near = near.front() == topology.boundary_loops[0].front();
  const std::vector<int32_t>& end = topology.boundary_loops[first_is_near ? 1 : 0];
  for (std::vector<int32_t>& layer : layers) {
    std::erase_if(layer, [&](int32_t v) { return std::binary_search(end.begin(), end.end(), v); });
  }
  std::erase_if(layers, [](const auto& layer) { return layer.empty(); });
  layers.push_back(end);
}

/// Joins adjacent vertices of a face on the same layer: a ring then forms one set, a forking
/// surface's layer several.
base::UnionFind join_along_layers(const LocalMesh& mesh, const std::vector<int32_t>& layer_of) {
  base::UnionFind sets(mesh.positions.size());
  for (int32_t f = 0; f < mesh.face_count(); ++f) {
    const std::span<const int32_t> face = mesh.face(f);
    for (size_t c = 0; c < face.size(); ++c) {
      const int32_t v = face[c];
      const int32_t w = face[(c + 1) % face.size()];
      if (layer_of[v] == layer_of[w]) sets.join(v, w);
    }
  }
  return sets;
}

bool is_one_ring(const std::vector<int32_t>& layer, base::UnionFind& sets) {
  const int32_t first = sets.find(layer.front());
  return std::all_of(layer.begin(), layer.end(), [&](int32_t v) { return sets.find(v) == first; });
}

/// Deviation of the layers from many even rings: smaller is better; negative = not a tube.
double irregularity(const LocalMesh& mesh, const Layers& layers, NotATube& why) {
  if (layers.size() < 2) {
    why = NotATube::kFlat;
    return -1.0;
  }
  std::vector<int32_t> layer_of(mesh.positions.size(), -1);
  size_t met = 0;
  for (size_t i = 0; i < layers.size(); ++i) {
    for (const int32_t v : layers[i]) layer_of[v] = static_cast<int32_t>(i);
    met += layers[i].size();
  }
  if (met != mesh.positions.size()) {
    why = NotATube::kLoose;
    return -1.0;
  }
  // The most frequent size of the layers between the ends.
  std::vector<size_t> sizes;
  for (const auto& layer : layers) {
    if (layer.size() > 1) sizes.push_back(layer.size());
  }
  if (sizes.empty()) {
    why = NotATube::kLoose;
    return -1.0;
  }
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
  const auto common = static_cast<double>(sizes[sizes.size() / 2]);
  double sum = 0.0;
  std::optional<base::UnionFind> sets;
  for (size_t i = 0; i < layers.size(); ++i) {
    const bool end = i == 0 || i + 1 == layers.size();
    const auto size = static_cast<double>(layers[i].size());
    if (end && layers[i].size() == 1) continue;
    // The last layer of an uneven tube may be a partial ring.
    if (size > kLargestRing * common || (size < kSmallestRing * common && i + 1 != layers.size())) {
      why = NotATube::kUneven;
      return -1.0;
    }
    if (size >= 3 && !sets) sets.emplace(join_along_layers(mesh, layer_of));
    if (size >= 3 && !is_one_ring(layers[i], *sets)) {
      why = NotATube::kForks;
      return -1.0;
    }
    sum += std::abs(size - common) / common;
  }
  // Of equally even walks the one along the tube has the most rings.
  return (sum + 1.0) / static_cast<double>(sizes.size());
}

glm::vec3 centre_of(const LocalMesh& mesh, const std::vector<int32_t>& layer) {
  glm::vec3 sum(0.0f);
  for (const int32_t v : layer) sum += mesh.positions[v];
  return sum / static_cast<float>(layer.size());
}

/// Cyclic order by angle about the axis, sufficient for the convex rings of limbs.
std::vector<glm::vec3> ordered_ring(const LocalMesh& mesh, const std::vector<int32_t>& layer,
                                    const glm::vec3& axis) {
  std::vector<glm::vec3> ring;
  ring.reserve(layer.size());
  for (const int32_t v : layer) ring.push_back(mesh.positions[v]);
  const float length = glm::length(axis);
  if (ring.size() <= 3 || length == 0.0f) return ring;
  const glm::vec3 normal = axis / length;
  const glm::vec3 across =
      std::abs(normal.x) < 0.7f ? glm::vec3(1.0f, 0.0f, 0.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
  const glm::vec3 u = glm::normalize(glm::cross(normal, across));
  const glm::vec3 w = glm::cross(normal, u);
  const glm::vec3 centre = centre_of(mesh, layer);
  std::vector<std::pair<float, size_t>> angles;
  for (size_t i = 0; i < ring.size(); ++i) {
    const glm::vec3 d = ring[i] - centre;
    angles.emplace_back(std::atan2(glm::dot(d, w), glm::dot(d, u)), i);
  }
  std::sort(angles.begin(), angles.end());
  std::vector<glm::vec3> ordered;
  ordered.reserve(ring.size());
  for (const auto& [angle, i] : angles) ordered.push_back(ring[i]);
  return ordered;
}

std::optional<Limb> trace_layers(const LocalMesh& mesh, NotATube& why) {
  const Topology topology = build_topology(mesh);
  const bool closed = topology.boundary_loops.empty();
  constexpr size_t kMaxStarts = 64;
  Layers starts = closed ? closed_ends(mesh, topology, kMaxStarts) : topology.boundary_loops;
  if (starts.size() > kMaxStarts) starts.resize(kMaxStarts);

  Layers best;
  double best_irregularity = -1.0;
  for (const std::vector<int32_t>& start : starts) {
    // Only the first failing start finds the reason, which takes the whole walk.
    const bool has_reason = why != NotATube::kNone && topology.boundary_loops.size() != 2;
    Layers layers = walk_layers(mesh, topology, start, has_reason ? kMaxUneven : 0);
    if (layers.empty()) continue;
    gather_far_end(topology, layers);
    NotATube reason = NotATube::kNone;
    const double value = irregularity(mesh, layers, reason);
    if (value < 0.0) {
      if (why == NotATube::kNone) why = reason;
      continue;
    }
    if (best_irregularity < 0.0 || value < best_irregularity) {
      best_irregularity = value;
      best = std::move(layers);
    }
  }
  if (best.empty()) return std::nullopt;

  Limb limb;
  for (size_t i = 0; i < best.size(); ++i) {
    const glm::vec3 axis = centre_of(mesh, best[std::min(i + 1, best.size() - 1)]) -
                           centre_of(mesh, best[i > 0 ? i - 1 : 0]);
    append_ring(ordered_ring(mesh, best[i], axis), limb);
  }
  limb.reversible = closed || topology.boundary_loops.size() > 1;
  return limb;
}

/// The centre vertex of a flat cap is not a point of the centreline.
void drop_cap_centre(Limb& limb, bool at_root) {
  const size_t count = limb.points.size();
  if (count < 3) return;
  const size_t end = at_root ? 0 : count - 1;
  const size_t ring = at_root ? 1 : count - 2;
  if (limb.radii[end] == 0.0f && limb.radii[ring] > 0.0f &&
      glm::distance(limb.points[end], limb.points[ring]) < kFlatCap * limb.radii[ring]) {
    limb.points.erase(limb.points.begin() + static_cast<ptrdiff_t>(end));
    limb.radii.erase(limb.radii.begin() + static_cast<ptrdiff_t>(end));
    limb.areas.erase(limb.areas.begin() + static_cast<ptrdiff_t>(end));
    limb.reversible = true;
  }
}

std::optional<Limb> finish_limb(std::optional<Limb> limb, NotATube& why) {
  if (!limb) return limb;
  drop_cap_centre(*limb, true);
  drop_cap_centre(*limb, false);
  const float thickest = *std::max_element(limb->radii.begin(), limb->radii.end());
  if (polyline_length(limb->points) < kShortestLimb * thickest) {
    why = NotATube::kDisc;
    return std::nullopt;
  }
  const float root = limb->radii.front();
  const float tip = limb->radii.back();
  if (limb->reversible && root < (1.0f - kSameThickness) * tip) {
    reverse_limb(*limb);
    limb->reversible = false;
  } else if (tip < (1.0f - kSameThickness) * root) {
    limb->reversible = false;
  }
  return limb;
}

std::optional<Limb> trace_local(const LocalMesh& mesh, NotATube& why) {
  std::optional<Limb> limb = finish_limb(trace_layers(mesh, why), why);
  if (limb) return limb;
  const LocalMesh welded = weld_equal_positions(mesh);
  if (welded.positions.size() == mesh.positions.size() || welded.face_count() < 3) {
    return std::nullopt;
  }
  NotATube welded_why = NotATube::kNone;
  limb = trace_rows(welded);
  if (!limb) limb = trace_layers(welded, welded_why);
  limb = finish_limb(std::move(limb), welded_why);
  // If faces do not share vertices, only the welded surface shows that it forks.
  if (!limb && welded_why == NotATube::kForks) why = welded_why;
  return limb;
}

}  // namespace

std::string reason_text(NotATube reason) {
  switch (reason) {
    case NotATube::kNone:
      return "";
    case NotATube::kFlat:
      return "flat: no ring inside its outline";
    case NotATube::kDisc:
      return "a disc: shorter than a quarter of its radius";
    case NotATube::kLoose:
      return "connected only at single points";
    case NotATube::kUneven:
      return "not a tube: its cross-sections are uneven";
    case NotATube::kForks:
      return "not a single tube: its surface forks";
  }
  return "";
}

void append_ring(std::span<const glm::vec3> ring, Limb& limb) {
  // Summed in double: the centre must not depend on the ring's position in the world.
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  for (const glm::vec3& p : ring) {
    x += p.x;
    y += p.y;
    z += p.z;
  }
  const auto count = static_cast<double>(ring.size());
  const glm::vec3 centre(static_cast<float>(x / count), static_cast<float>(y / count),
                         static_cast<float>(z / count));
  double radius = 0.0;
  glm::vec3 area(0.0f);
  for (size_t i = 0; i < ring.size(); ++i) {
    const glm::vec3 d = ring[i] - centre;
    radius += glm::length(d);
    area += glm::cross(d, ring[(i + 1) % ring.size()] - centre);
  }
  // A ring in a single point has no thickness, even if rounding moves its mean.
  const bool point =
      std::all_of(ring.begin(), ring.end(), [&](const glm::vec3& p) { return p == ring.front(); });
  limb.points.push_back(point ? ring.front() : centre);
  limb.radii.push_back(point ? 0.0f : static_cast<float>(radius / count));
  limb.areas.push_back(point ? 0.0f : 0.5f * glm::length(area));
}

void reverse_limb(Limb& limb) {
  std::reverse(limb.points.begin(), limb.points.end());
  std::reverse(limb.radii.begin(), limb.radii.end());
  std::reverse(limb.areas.begin(), limb.areas.end());
}

std::optional<Limb> trace_tube(const ObjScene& scene, std::span<const int32_t> faces,
                               std::span<const int32_t> vertices, NotATube& why) {
  why = NotATube::kNone;
  const LocalMesh mesh = extract_component(scene, faces, vertices);
  NotATube ignored = NotATube::kNone;
  if (std::optional<Limb> limb = finish_limb(trace_rows(mesh), ignored)) return limb;
  return trace_local(mesh, why);
}

}  // namespace snowbough::tree
