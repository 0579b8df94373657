#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "tree/rims/membrane.h"

namespace snowbough::tree {

/// A vertex of a rim, or one that moves with it.
struct MembraneNode {
  int32_t vertex = -1;
  /// Its own or nearest rim: an index into those of the patch.
  int32_t junction = -1;
  bool rim = false;
  /// Fixed in this step.
  bool stopped = false;
  /// Edges from the rim.
  int depth = 0;
  /// Displacement of a rim's vertex in a step; the current one; and the one after relaxing, with
  /// which the next step begins.
  glm::dvec2 step{0.0}, velocity{0.0}, relaxed{0.0};
  /// Number of steps that a rim's vertex has made, and the nodes before and after it on the rim.
  int gone = 0;
  int32_t before = -1, after = -1;
  /// Number of the patch's last visit.
  int mark = 0;
};

/// Some rims on one chain, the vertices within their range, and the next displacement of each
/// vertex.
class MembranePatch {
 public:
  /// Takes indices in `locals` for its vertices and faces, and releases them in the destructor.
  MembranePatch(const Neighbours& neighbours, const std::vector<Rim>& rims,
                std::span<const RimReach> reaches, UnrolledLimbs& unrolled, Locals& locals);
  ~MembranePatch();
  MembranePatch(const MembranePatch&) = delete;
  MembranePatch& operator=(const MembranePatch&) = delete;

  /// A node's index, or -1.
  int32_t local(int32_t vertex) const { return local_of_[vertex]; }
  const RimReach& reach(const MembraneNode& node) const { return reaches_[node.junction]; }
  const TubePlace& place(int32_t vertex) const { return unrolled_.places[vertex]; }

  /// Widens narrow faces around a rim for the fillet.
  void spread(int sweeps);

  /// Finds the faces that the step would turn over.
  void find_turned();
  const std::vector<int32_t>& turned() const { return turned_; }

  /// Moves the free corners of turned faces to the middle of their neighbours.
  void relax_turned();

  /// Stops the rims' vertices at turned faces.
  void stop_rims();

  /// Stops all corners of faces that still turn over in this step, and of faces that would turn
  /// over because of that.
  void stop_turned();

  /// Moves every vertex by its displacement.
  void finish_step();

  /// The vertices of rims come first.
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

  const Neighbours& neighbours_;
  std::span<const RimReach> reaches_;
  UnrolledLimbs& unrolled_;
  /// References into Locals.
  std::vector<int32_t>& local_of_;
  std::vector<int32_t>& face_of_;
  std::vector<int32_t> faces_;
  std::vector<double> first_areas_;
  /// Number of the last visit, of nodes and faces.
  int mark_ = 0;
  std::vector<int> face_marks_;
  std::vector<int32_t> turned_;
};

}  // namespace snowbough::tree
