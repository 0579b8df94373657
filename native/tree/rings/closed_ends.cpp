#include "tree/rings/closed_ends.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <span>

namespace snowbough::tree {
namespace {

/// Cosine between the normals of faces that lie in one plane.
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

/// The vertices of a face and of the faces around it that lie in its plane.
std::vector<int32_t> flat_patch(const LocalMesh& mesh, const Topology& topology, int32_t seed) {
  const glm::vec3 normal = face_normal(mesh, seed);
  std::vector<int32_t> patch(mesh.face(seed).begin(), mesh.face(seed).end());
  for (size_t i = 0; i < patch.size(); ++i) {
    const int32_t v = patch[i];
    for (int32_t j = topology.vertex_face_begin[v]; j < topology.vertex_face_begin[v + 1]; ++j) {
      const int32_t other = topology.vertex_faces[j];
      if (glm::dot(face_normal(mesh, other), normal) < kFlatPatch) continue;
      for (const int32_t w : mesh.face(other)) {
        if (std::find(patch.begin(), patch.end(), w) == patch.end()) patch.push_back(w);
      }
    }
  }
  std::sort(patch.begin(), patch.end());
  return patch;
}

}  // namespace

Layers closed_ends(const LocalMesh& mesh, const Topology& topology) {
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
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    if (topology.vertex_face_begin[v + 1] - topology.vertex_face_begin[v] > kFanFaces) {
      starts.push_back({static_cast<int32_t>(v)});
    }
  }
  for (int32_t f = 0; f < mesh.face_count(); ++f) {
    if (mesh.face(f).size() <= 4) continue;
    starts.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
    std::sort(starts.back().begin(), starts.back().end());
  }
  for (const int32_t end : ends) {
    starts.push_back({end});
    for (int32_t i = topology.vertex_face_begin[end]; i < topology.vertex_face_begin[end + 1];
         ++i) {
      const std::span<const int32_t> face = mesh.face(topology.vertex_faces[i]);
      starts.emplace_back(face.begin(), face.end());
      std::sort(starts.back().begin(), starts.back().end());
      starts.push_back(flat_patch(mesh, topology, topology.vertex_faces[i]));
    }
  }
  return starts;
}

}  // namespace snowbough::tree
