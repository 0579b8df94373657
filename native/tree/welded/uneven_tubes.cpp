#include "tree/welded/uneven_tubes.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "tree/rings/local_mesh.h"
#include "tree/skeleton/centreline.h"
#include "tree/welded/ends.h"
#include "tree/welded/welded.h"

namespace snowbough::tree {
namespace {

constexpr size_t kSmallestLoop = 3;
/// Maximum corners of the open end if the other one is closed: a larger one is a leaf's outline.
constexpr size_t kLargestLoop = 16;
/// Open ends whose radii differ by less than this fraction look alike.
constexpr float kSameThickness = 0.02f;
/// Minimum length of a tube, in largest radii.
constexpr float kShortest = 3.0f;

/// Whether the surface is a sphere with these holes: no handles, no edge with three faces.
bool is_sphere_with_holes(const LocalMesh& mesh, std::vector<std::pair<int32_t, int32_t>> edges,
                          const Layers& holes) {
  size_t single = 0;
  for (size_t i = 0; i < edges.size();) {
    size_t j = i + 1;
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if (j - i > 2) return false;
    single += j - i == 1 ? 1 : 0;
    i = j;
  }
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  const auto euler = static_cast<ptrdiff_t>(mesh.positions.size()) -
                     static_cast<ptrdiff_t>(edges.size()) + mesh.face_count();
  size_t around = 0;
  for (const std::vector<int32_t>& hole : holes) around += hole.size();
  return euler == 2 - static_cast<ptrdiff_t>(holes.size()) && single == around;
}

/// The vertices of a layer in cyclic order, if they form one closed ring.
std::vector<int32_t> closed_ring(const std::vector<int32_t>& layer,
                                 const std::vector<std::vector<int32_t>>& beside) {
  std::vector<int32_t> ring{layer.front()};
  int32_t before = -1;
  while (ring.size() <= layer.size()) {
    const std::vector<int32_t>& both = beside[ring.back()];
    if (both.size() != 2) return {};
    const int32_t next = both[0] == before ? both[1] : both[0];
    before = ring.back();
    if (next == ring.front()) break;
    ring.push_back(next);
  }
  if (ring.size() != layer.size()) return {};
  return ring;
}

/// A limb through the layers; no value if one of them, except the last, is not a closed ring.
std::optional<Limb> limb_through(const LocalMesh& mesh,
                                 const std::vector<std::pair<int32_t, int32_t>>& edges,
                                 const Layers& layers) {
  std::vector<int32_t> layer_of(mesh.positions.size(), -1);
  for (size_t i = 0; i < layers.size(); ++i) {
    for (const int32_t v : layers[i]) layer_of[v] = static_cast<int32_t>(i);
  }
  std::vector<std::vector<int32_t>> beside(mesh.positions.size());
  for (size_t i = 0; i < edges.size(); ++i) {
    if (i > 0 && edges[i] == edges[i - 1]) continue;
    const auto [a, b] = edges[i];
    if (layer_of[a] != layer_of[b]) continue;
    beside[a].push_back(b);
    beside[b].push_back(a);
  }
  Limb limb;
  for (size_t i = 0; i < layers.size(); ++i) {
    std::vector<int32_t> ring = closed_ring(layers[i], beside);
    if (ring.size() < kSmallestLoop) {
      if (i + 1 < layers.size()) return std::nullopt;
      ring = layers[i];
    }
    std::vector<glm::vec3> corners;
    for (const int32_t v : ring) corners.push_back(mesh.positions[v]);
    append_ring(corners, limb);
  }
  return limb;
}

bool is_long(const Limb& limb) {
  return limb.points.size() >= 2 &&
         polyline_length(limb.points) >=
             kShortest * *std::max_element(limb.radii.begin(), limb.radii.end());
}

}  // namespace

std::optional<Limb> trace_uneven_tube(const ObjScene& scene, std::span<const int32_t> faces,
                                      std::span<const int32_t> vertices) {
  const LocalMesh mesh = extract_component(scene, faces, vertices);
  const Topology topology = build_topology(mesh);
  const size_t open_ends = topology.boundary_loops.size();
  if (open_ends < 1 || open_ends > 2) return std::nullopt;
  const std::vector<int32_t> loop = widest_loop(mesh, topology);
  const std::vector<std::pair<int32_t, int32_t>> edges = polygon_edges(mesh);
  if (loop.size() < kSmallestLoop || (open_ends == 1 && loop.size() > kLargestLoop) ||
      2 * loop.size() >= mesh.positions.size() ||
      !is_sphere_with_holes(mesh, edges, topology.boundary_loops)) {
    return std::nullopt;
  }
  std::optional<Limb> limb = limb_through(mesh, edges, walk_layers(mesh, topology, loop));
  if (!limb) {
    std::optional<WeldedTree> welded = trace_welded_from(mesh, loop);
    if (welded && welded->limbs.size() == 1) limb = std::move(welded->limbs.front());
  }
  if (!limb || !is_long(*limb)) return std::nullopt;
  limb->reversible =
      open_ends == 2 && limb->radii.back() >= (1.0f - kSameThickness) * limb->radii.front();
  return limb;
}

}  // namespace snowbough::tree
