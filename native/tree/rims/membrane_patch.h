#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "tree/rims/membrane.h"

namespace snowbough::tree {

/// A vertex that moves with a rim, or is part of one.
struct MembraneNode {
  int32_t vertex = -1;
  /// The rim it belongs to or the nearest one: its number among those of the patch.
  int32_t junction = -1;
  bool rim = false;
  /// Does not move in this step.
  bool stopped = false;
  /// Edges from the rim.
  int depth = 0;
  /// Way of a rim's vertex in a step, that of this step, and what relaxing left of it: where the
  /// next step begins.
  glm::dvec2 step{0.0}, velocity{0.0}, relaxed{0.0};
  /// Steps that a rim's vertex has made, and the nodes before and after it on the rim.
  int gone = 0;
  int32_t before = -1, after = -1;
  /// When the patch last looked at it.
  int mark = 0;
};

/// Some rims on one chain, what lies around them within their reach, and the way that each vertex
/// is about to take.
class MembranePatch {
 public:
  /// Takes numbers in `locals` for its vertices and faces, and gives them back in the end.
  MembranePatch(const Graph& graph, const std::vector<Rim>& rims, std::span<const RimReach> reaches,
                UnrolledLimbs& unrolled, Locals& locals);
  ~MembranePatch();
  MembranePatch(const MembranePatch&) = delete;
  MembranePatch& operator=(const MembranePatch&) = delete;

  /// A node's number, or -1.
  int32_t local(int32_t vertex) const { return local_of_[vertex]; }
  const RimReach& reach(const MembraneNode& node) const { return reaches_[node.junction]; }
  const TubePlace& place(int32_t vertex) const { return unrolled_.places[vertex]; }

  /// Gives the first faces around a rim room for the fillet, where they are narrow.
  void spread(int sweeps);

  /// Faces that the step would turn over.
  void find_turned();
  const std::vector<int32_t>& turned() const { return turned_; }

  /// Puts the corners of turned faces that are free in the middle of their neighbours.
  void even_out();

  /// Stops the rims' vertices at turned faces.
  void hold_rims();

  /// What still turns over stays where it is in this step, and so does whatever would turn because
  /// of that.
  void stop_turned();

  /// Moves every vertex its way.
  void finish_step();

  /// Those of rims first.
  std::vector<MembraneNode> nodes;
  size_t rim_count = 0;

 private:
  int32_t add_node(int32_t vertex, int32_t junction);
  void find_rims(const std::vector<Rim>& rims);
  void find_free(const Rim& rim, int32_t number);
  void find_faces();
  TubePlace moved(int32_t vertex) const;
  std::array<TubePlace, 4> moved_corners(const Quad& quad) const;
  bool turns(int32_t face) const;
  bool to_middle(int32_t vertex);

  const Graph& graph_;
  std::span<const RimReach> reaches_;
  UnrolledLimbs& unrolled_;
  /// Locals.
  std::vector<int32_t>& local_of_;
  std::vector<int32_t>& face_of_;
  std::vector<int32_t> faces_;
  std::vector<double> first_areas_;
  /// What was last looked at, of nodes and faces.
  int mark_ = 0;
  std::vector<int> face_marks_;
  std::vector<int32_t> turned_;
};

}  // namespace snowbough::tree
