#pragma once

#include <algorithm>
#include <stdexcept>

#include "render/sources.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::python {

/// A tree's four-sided base as the renderer takes it.
/// @throws std::invalid_argument for a mesh that is already subdivided.
inline render::TreeSource tree_source(const tree::TreeMesh& mesh) {
  if (mesh.sections.empty()) {
    throw std::invalid_argument(
        "the renderer subdivides the tree itself: build the mesh with lod=0 and without detail");
  }
  render::TreeSource source;
  source.vertices = mesh.vertices;
  source.bone_indices = mesh.bone_indices;
  source.bone_weights = mesh.bone_weights;
  source.bone_count = static_cast<int32_t>(mesh.bones.heads.size());
  source.quads = mesh.quads;
  source.bark_uv = mesh.uv_bark;
  source.snow_uv = mesh.uv_snow;
  source.branch_level = mesh.branch_level;
  std::vector<int32_t> first_section;
  int32_t next = 0;
  for (const int32_t rows : mesh.branch_rows) {
    first_section.push_back(next);
    next += rows;
  }
  for (const tree::FaceOrigin& origin : mesh.origins) {
    const bool wall = origin.part == tree::FacePart::kWall;
    const bool inset = origin.part == tree::FacePart::kInset;
    source.branch.push_back(origin.branch);
    source.section.push_back(wall || inset ? first_section[origin.branch] + origin.row : -1);
    source.kind.push_back(wall    ? render::QuadKind::kWall
                          : inset ? render::QuadKind::kInset
                                  : render::QuadKind::kCap);
  }
  for (const tree::LimbSection& section : mesh.sections) {
    source.sections.push_back({section.begin, section.axis, static_cast<float>(section.length),
                               static_cast<float>(section.begin_radius),
                               static_cast<float>(section.end_radius), section.from_hole});
  }
  return source;
}

}  // namespace snowbough::python
