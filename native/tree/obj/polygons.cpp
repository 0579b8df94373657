#include "tree/obj/polygons.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::tree {
namespace {

/// Cosine of the angle up to which a corner's normal is that of its flat polygon: exporters round.
constexpr double kFlatCosine = 0.9998;

/// The corner's unit normal; zero if it has none.
glm::vec3 normal_of(const ObjScene& scene, int32_t corner) {
  const int32_t index = scene.corner_normal.empty() ? -1 : scene.corner_normal[corner];
  if (index < 0) return glm::vec3(0.0f);
  const glm::dvec3 normal(scene.normals[index]);
  const double length = glm::length(normal);
  return length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0f);
}

/// Whether every corner has no normal or that of its flat polygon.
bool are_flat(const PolygonMesh& mesh) {
  for (size_t f = 0; f + 1 < mesh.face_begin.size(); ++f) {
    const auto place = [&](int32_t corner) {
      return glm::dvec3(mesh.vertices[mesh.corner_vertex[corner]]);
    };
    const int32_t begin = mesh.face_begin[f], end = mesh.face_begin[f + 1];
    glm::dvec3 flat(0.0);
    for (int32_t c = begin + 1; c + 1 < end; ++c) {
      flat += glm::cross(place(c) - place(begin), place(c + 1) - place(begin));
    }
    const double length = glm::length(flat);
    for (int32_t c = begin; c < end && length > 0.0; ++c) {
      const glm::dvec3 normal(mesh.corner_normal[c]);
      if (normal != glm::dvec3(0.0) && glm::dot(normal, flat) < kFlatCosine * length) return false;
    }
  }
  return true;
}

bool has_repeated_vertex(const ObjScene& scene, int32_t f) {
  std::vector<int32_t> corners(scene.corner_vertex.begin() + scene.face_begin[f],
                               scene.corner_vertex.begin() + scene.face_begin[f + 1]);
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

}  // namespace

PolygonGatherer::PolygonGatherer(const ObjScene& scene, const Parts& parts, PolygonMesh& mesh)
    : scene_(scene),
      parts_(parts),
      mesh_(mesh),
      material_number_(scene.materials.size(), -1),
      vertex_number_(scene.positions.size(), -1) {
  mesh_.face_begin.assign(1, 0);
}

int32_t PolygonGatherer::material_of(int32_t material) {
  if (material < 0) return -1;
  if (material_number_[material] < 0) {
    material_number_[material] = static_cast<int32_t>(mesh_.materials.size());
    ObjMaterial named;
    named.name = scene_.materials[material];
    mesh_.materials.push_back(std::move(named));
  }
  return material_number_[material];
}

void PolygonGatherer::add(int32_t part, bool repeated) {
  for (const int32_t v : parts_.part_vertices(part)) {
    vertex_number_[v] = static_cast<int32_t>(mesh_.vertices.size());
    mesh_.vertices.push_back(scene_.positions[v]);
  }
  auto run = static_cast<size_t>(parts_.run[part]);
  for (const int32_t f : parts_.part_faces(part)) {
    while (run + 1 < scene_.runs.size() && scene_.runs[run + 1].first_face <= f) ++run;
    if (!repeated && has_repeated_vertex(scene_, f)) continue;
    for (int32_t c = scene_.face_begin[f]; c < scene_.face_begin[f + 1]; ++c) {
      mesh_.corner_vertex.push_back(vertex_number_[scene_.corner_vertex[c]]);
      const int32_t uv = scene_.corner_uv.empty() ? -1 : scene_.corner_uv[c];
      mesh_.corner_uv.push_back(uv >= 0 ? scene_.uvs[uv] : glm::vec2(0.0f));
      mesh_.corner_normal.push_back(normal_of(scene_, c));
    }
    mesh_.face_begin.push_back(static_cast<int32_t>(mesh_.corner_vertex.size()));
    mesh_.face_material.push_back(material_of(scene_.runs[run].material));
  }
}

bool PolygonGatherer::finish() {
  if (!are_flat(mesh_)) return false;
  const bool given = std::any_of(mesh_.corner_normal.begin(), mesh_.corner_normal.end(),
                                 [](const glm::vec3& n) { return n != glm::vec3(0.0f); });
  mesh_.corner_normal = {};
  return given;
}

}  // namespace snowbough::tree
