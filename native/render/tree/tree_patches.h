#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "render/data/sources.h"
#include "render/tree/drop_order.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {

/// The arrays of a tree that are uploaded once, see shaders/lib/tree_shared.h, in the order of
/// order_patches.
struct TreePatches {
  std::vector<shared::TreeVertex> vertices;
  std::vector<shared::TreeSection> sections;
  std::vector<shared::TreeEdge> edges;
  std::vector<shared::TreePatch> patches;
  /// Index of each patch's quad in the source.
  std::vector<int32_t> quads;
  DropOrder order;
  /// Number of vertices and of edges that the patches up to each patch use.
  std::vector<int32_t> used_vertices;
  std::vector<int32_t> used_edges;
  /// Coordinates on the snow map that meet at the vertices, see TreeVertex.
  std::vector<glm::vec2> vertex_snow;
  /// True if the source has snow map coordinates; otherwise all coordinates are equal.
  bool has_snow_uvs = false;
  int32_t bone_count = 0;
  /// Number of branch levels.
  int32_t branch_levels = 1;
  /// Area of the largest patch in m2.
  float largest_area = 0.0f;
  /// Bounding box of the vertices.
  glm::vec3 lowest{0.0f};
  glm::vec3 highest{0.0f};
};

/// Moves the base's vertices to the limbs' radius, and computes for each edge and patch the
/// constants of its points. Each edge has one record, which determines all of its points: its
/// vertices, the sections of both faces (a child's collar uses only the section of the parent's
/// inset), and a correction at each end that fades out towards the middle.
///
/// @param bark_depth amplitude of the bark as a fraction of the limb's radius. The bark has height
/// 0 where its coordinates are discontinuous: on collars and tips.
/// @throws std::invalid_argument with the reason: arrays of different lengths, indices out of
/// range, or an edge with more than two quads.
///
/// Source: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, section 3.4, eq. 3.4.2.
TreePatches make_tree_patches(const TreeSource& source, float bark_depth);

}  // namespace snowbough::render
