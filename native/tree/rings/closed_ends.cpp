#include "tree/rings/closed_ends.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <span>

namespace snowbough::tree {
namespace {

/// Cosine between the normals of coplanar faces.
constexpr float kFlatPatch = 0.99f;
/// A vertex with more faces than this is the centre of a fan.
constexpr int32_t kFanFaces = 6;

glm::vec3 face_normal(const LocalMesh& mesh, int32_t f) {
  const std::span<const int32_t> face = mesh.face(f);
  glm::vec3 normal(0.0f);
  for (size_t c = 1; c + 1 < face.size(); ++c) {
    normal += glm::cross(mesh.positions[face[c]] - mesh.positions[face[0]],
                         mesh.positions[face[c + 1]] - mesh.positions[face[0]]);
  }
  const float length = glm::length(normal);
  return length > 0.0f ? normal / length : normal;
}

/// Finds flat patches around faces.
class FlatPatches {
 public:
  FlatPatches(const LocalMesh& mesh, const Topology& topology)
      : mesh_(mesh),
        topology_(topology),
        seen_vertex_(mesh.positions.size(), -1),
        seen_face_(static_cast<size_t>(mesh.face_count()), -1) {
    for (int32_t f = 0; f < mesh.face_count(); ++f) normals_.push_back(face_normal(mesh, f));
  }

  /// The vertices of a face and of the coplanar faces around it, ascending.
  std::vector<int32_t> around(int32_t seed) {
    ++search_;
    std::vector<int32_t> patch;
    take(seed, patch);
    for (size_t i = 0; i < patch.size(); ++i) {
      const int32_t v = patch[i];
      for (int32_t j = topology_.vertex_face_begin[v]; j < topology_.vertex_face_begin[v + 1];
           ++j) {
        const int32_t other = topology_.vertex_faces[j];
        if (seen_face_[other] == search_) continue;
        seen_face_[other] = search_;
        if (glm::dot(normals_[other], normals_[seed]) >= kFlatPatch) take(other, patch);
      }
    }
    std::sort(patch.begin(), patch.end());
    return patch;
  }

 private:
  void take(int32_t face, std::vector<int32_t>& patch) {
    for (const int32_t v : mesh_.face(face)) {
      if (seen_vertex_[v] == search_) continue;
      seen_vertex_[v] = search_;
      patch.push_back(v);
    }
  }

  const LocalMesh& mesh_;
  const Topology& topology_;
  std::vector<glm::vec3> normals_;
  /// Number of the last search that visited the vertex or the face.
  std::vector<int32_t> seen_vertex_, seen_face_;
  int32_t search_ = 0;
};

}  // namespace

Layers closed_ends(const LocalMesh& mesh, const Topology& topology, size_t most) {
  std::vector<int32_t> ends;
  int32_t along = 0;
  int32_t across = 0;
  for (int sweep = 0; sweep < 2; ++sweep) {
    along = walk_layers(mesh, topology, {along}).back().front();
    const glm::vec3 from = mesh.positions[across];
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      if (glm::distance(mesh.positions[v], from) > glm::distance(mesh.positions[across], from)) {
        across = static_cast<int32_t>(v);
      }
    }
    ends.push_back(along);
    ends.push_back(across);
  }
  Layers starts;
  const auto enough = [&] { return starts.size() >= most; };
  for (size_t v = 0; v < mesh.positions.size() && !enough(); ++v) {
    if (topology.vertex_face_begin[v + 1] - topology.vertex_face_begin[v] > kFanFaces) {
      starts.push_back({static_cast<int32_t>(v)});
    }
  }
  for (int32_t f = 0; f < mesh.face_count() && !enough(); ++f) {
    if (mesh.face(f).size() <= 4) continue;
    starts.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
    std::sort(starts.back().begin(), starts.back().end());
  }
  FlatPatches patches(mesh, topology);
  for (const int32_t end : ends) {
    if (!enough()) starts.push_back({end});
    for (int32_t i = topology.vertex_face_begin[end];
         i < topology.vertex_face_begin[end + 1] && !enough(); ++i) {
      const std::span<const int32_t> face = mesh.face(topology.vertex_faces[i]);
      starts.emplace_back(face.begin(), face.end());
      std::sort(starts.back().begin(), starts.back().end());
      if (!enough()) starts.push_back(patches.around(topology.vertex_faces[i]));
    }
  }
  return starts;
}

}  // namespace snowbough::tree
