#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "render/sources.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {

/// What of a tree is uploaded once, see shaders/lib/tree_shared.h.
struct TreePatches {
  std::vector<shared::TreeVertex> vertices;
  std::vector<shared::TreeSection> sections;
  std::vector<shared::TreeEdge> edges;
  std::vector<shared::TreePatch> patches;
  /// Places on the snow map that meet at the vertices, see TreeVertex.
  std::vector<glm::vec2> vertex_snow;
  /// Whether the source says them; else they are all the same one.
  bool has_snow_places = false;
  int32_t bone_count = 0;
  /// Number of branch levels.
  int32_t levels = 1;
  /// Area of the largest patch in m2.
  float largest_area = 0.0f;
  /// Box around the vertices.
  glm::vec3 lowest{0.0f};
  glm::vec3 highest{0.0f};
};

/// Puts the base's vertices on the limbs' radius and finds for each edge and patch what its points
/// are computed from. Each edge has one record, which says all of its points: its vertices, the
/// sections of both faces (a child's rim takes the parent's inset's alone), and what is missing at
/// its ends, which fades out towards its middle. The points are those of the subdivided meshes
/// (native/tree/mesh/lod.h) at the middles of edges and faces, but for the rims of children's
/// holes, which those smooth with each subdivision.
///
/// @param bark_depth how far bark rises and falls, as a share of the limb's radius. It is 0 where
///   the bark's coordinates do not go on: on rims and tips.
/// @throws std::invalid_argument naming what is wrong: arrays of different length, indices out of
///   range, an edge of more than two quads.
///
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 3.4, eq. 3.4.2.
TreePatches make_tree_patches(const TreeSource& source, float bark_depth);

}  // namespace snowbough::render
