#include "tree/obj/parts.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <utility>

#include "base/group_by_key.h"
#include "base/union_find.h"

namespace snowbough::tree {
namespace {

/// Faces or vertices between two progress reports.
constexpr int32_t kProgressStep = 1 << 20;

void report_step(const base::Progress& progress, int32_t i, int32_t count, float from, float to) {
  if (i % kProgressStep == 0) {
    base::report_progress(progress,
                          from + (to - from) * static_cast<float>(i) / static_cast<float>(count));
  }
}

}  // namespace

Parts split_parts(const ObjScene& scene, const base::Progress& progress) {
  const int32_t face_count = scene.face_count();
  const auto vertex_count = static_cast<int32_t>(scene.positions.size());
  base::UnionFind sets(scene.positions.size());
  for (int32_t f = 0; f < face_count; ++f) {
    report_step(progress, f, face_count, 0.0f, 0.4f);
    int32_t first = scene.corner_vertex[scene.face_begin[f]];
    for (int32_t c = scene.face_begin[f] + 1; c < scene.face_begin[f + 1]; ++c) {
      first = sets.join(first, scene.corner_vertex[c]);
    }
  }
  const std::vector<int32_t> representative = std::move(sets).all();

  Parts parts;
  // Numbers the parts by their first face; the representative stores the number.
  std::vector<int32_t> part_of(scene.positions.size(), -1);
  int32_t run = 0;
  for (int32_t f = 0; f < face_count; ++f) {
    report_step(progress, f, face_count, 0.4f, 0.6f);
    while (run + 1 < static_cast<int32_t>(scene.runs.size()) &&
           scene.runs[run + 1].first_face <= f) {
      ++run;
    }
    int32_t& part = part_of[representative[scene.corner_vertex[scene.face_begin[f]]]];
    if (part < 0) {
      part = parts.count();
      parts.run.push_back(run);
    }
  }
  // Copies the number to every vertex of a used set: representatives are the smallest, hence come
  // first.
  for (int32_t v = 0; v < vertex_count; ++v) part_of[v] = part_of[representative[v]];
  base::report_progress(progress, 0.7f);

  const auto for_faces = [&](const auto& visit) {
    for (int32_t f = 0; f < face_count; ++f) {
      visit(part_of[scene.corner_vertex[scene.face_begin[f]]], f);
    }
  };
  base::group_by_key(static_cast<size_t>(parts.count()), for_faces, parts.face_begin, parts.faces);
  base::report_progress(progress, 0.9f);
  const auto for_vertices = [&](const auto& visit) {
    for (int32_t v = 0; v < vertex_count; ++v) {
      if (part_of[v] >= 0) visit(part_of[v], v);
    }
  };
  base::group_by_key(static_cast<size_t>(parts.count()), for_vertices, parts.vertex_begin,
                     parts.vertices);
  base::report_progress(progress, 1.0f);
  return parts;
}

double part_area(const ObjScene& scene, const Parts& parts, int32_t part) {
  double area = 0.0;
  for (const int32_t f : parts.part_faces(part)) {
    const glm::dvec3 first(scene.positions[scene.corner_vertex[scene.face_begin[f]]]);
    glm::dvec3 twice(0.0);
    for (int32_t c = scene.face_begin[f] + 1; c + 1 < scene.face_begin[f + 1]; ++c) {
      twice += glm::cross(glm::dvec3(scene.positions[scene.corner_vertex[c]]) - first,
                          glm::dvec3(scene.positions[scene.corner_vertex[c + 1]]) - first);
    }
    area += 0.5 * glm::length(twice);
  }
  return area;
}

}  // namespace snowbough::tree
