#include "tree/rims/membrane.h"

#include <algorithm>
#include <glm/common.hpp>
#include <iterator>

namespace snowbough::tree {
namespace {

/// A step is no longer than this share of the faces beside the rim; at most so many steps are made.
constexpr double kStep = 0.7;
constexpr int kMostSteps = 30;
/// Sweeps of the relaxation in the first step and in each of those after it, and its factor.
constexpr int kFirstSweeps = 25;
constexpr int kSweeps = 8;
constexpr double kOverRelaxation = 1.5;
/// What moves with a rim is held back by its place, with the square of the distance as a share of
/// the rim's reach: hardly beside the rim, where it has to make way, and at the reach as if it hung
/// on a neighbour this share of it away. Without, the whole limb would turn with the rim, as far as
/// the reach goes, and back in the one row after that.
constexpr double kFade = 0.25;
/// At first vertices near a rim go between their neighbours, in so many sweeps.
constexpr int kSpreads = 12;
/// A face keeps at least this share of its area.
constexpr double kLeastArea = 0.04;
/// Steps that a rim's vertex may be ahead of the next.
constexpr int kMostAhead = 1;
/// How often the corners of faces that turn over are put between their neighbours before the rims
/// around them are held back, and how often that within a step before they stay themselves.
constexpr int kEvenings = 10;
constexpr double kEvening = 0.6;
constexpr int kMostHolds = 4;

/// Of a difference of quarters, the short way round.
double short_way(double quarters) {
  return std::abs(quarters) <= 2.0 ? quarters : quarters - 4.0 * std::round(quarters / 4.0);
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The smaller of the two triangles' areas that a face is cut into, doubled.
double least_area(const std::array<TubePlace, 4>& corners) {
  const glm::dvec2 a = difference(corners[0], corners[1]);
  const glm::dvec2 b = difference(corners[0], corners[2]);
  const glm::dvec2 c = difference(corners[0], corners[3]);
  return std::min(cross(a, b), cross(b, c));
}

/// Some rims on one chain, and what moves with them.
class Membrane {
 public:
  Membrane(const Graph& graph, const std::vector<Rim>& rims, UnrolledLimbs& unrolled,
           Locals& locals)
      : graph_(graph),
        rims_(rims),
        unrolled_(unrolled),
        local_of_(locals.nodes),
        face_of_(locals.faces) {}

  /// Moves the rims of some junctions on a chain as far as they go.
  void move(std::span<const RimReach> rims) {
    find_rims(rims);
    for (size_t j = 0; j < junctions_.size(); ++j) {
      find_free(j);
    }
    find_faces();
    spread(kSpreads);
    for (int step = 0; step < steps_; ++step) {
      weigh();
      take_step(step == 0 ? kFirstSweeps : kSweeps);
    }
    for (size_t i = 0; i < rim_count_; ++i) {
      const Node& node = nodes_[i];
      unrolled_.shares[node.vertex] = steps_ > 0 ? static_cast<double>(node.gone) / steps_ : 1.0;
    }
    for (const Node& node : nodes_) local_of_[node.vertex] = -1;
    for (const int32_t face : faces_) face_of_[face] = -1;
  }

 private:
  struct Node {
    int32_t vertex = -1;
    /// Of the rim it belongs to or the nearest one, among junctions_.
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
    /// even_out's.
    int mark = 0;
  };

  int32_t add_node(int32_t vertex, int32_t junction) {
    local_of_[vertex] = static_cast<int32_t>(nodes_.size());
    Node& node = nodes_.emplace_back();
    node.vertex = vertex;
    node.junction = junction;
    return local_of_[vertex];
  }

  void find_rims(std::span<const RimReach> rims) {
    double steps = 0.0;
    for (const RimReach& reach : rims) {
      const int32_t j = reach.junction;
      const auto number = static_cast<int32_t>(junctions_.size());
      junctions_.push_back(j);
      reaches_.push_back(reach);
      for (const RimPoint& point : rims_[j]) {
        const glm::dvec2 move = difference(point.base, point.target);
        if (local_of_[point.vertex] >= 0) {
          // Between two holes without anything of the parent's between them: halfway.
          Node& node = nodes_[local_of_[point.vertex]];
          node.step = 0.5 * (node.step + move);
        } else {
          Node& node = nodes_[add_node(point.vertex, number)];
          node.rim = true;
          node.step = move;
        }
      }
      for (size_t i = 0; i < rims_[j].size(); ++i) {
        const int32_t here = local_of_[rims_[j][i].vertex];
        const int32_t next = local_of_[rims_[j][(i + 1) % rims_[j].size()].vertex];
        nodes_[here].after = next;
        nodes_[next].before = here;
      }
      steps = std::max(steps, reach.way / std::max(kStep * reach.spread, 1e-30));
    }
    steps_ = std::clamp(static_cast<int>(std::ceil(steps)), 0, kMostSteps);
    rim_count_ = nodes_.size();
    for (Node& node : nodes_) node.step /= std::max(steps_, 1);
  }

  /// What lies around a rim within its reach.
  void find_free(size_t junction) {
    const RimReach& reach = reaches_[junction];
    std::vector<int32_t> queue;
    for (const RimPoint& point : rims_[junctions_[junction]]) queue.push_back(point.vertex);
    for (size_t i = 0; i < queue.size(); ++i) {
      for (int32_t at = graph_.begin[queue[i]]; at < graph_.begin[queue[i] + 1]; ++at) {
        const int32_t v = graph_.all[at];
        if (local_of_[v] >= 0 || unrolled_.fixed[v] != 0 ||
            reach.from_centre(unrolled_.places[v]) > reach.radius) {
          continue;
        }
        const int depth = nodes_[local_of_[queue[i]]].depth + 1;
        nodes_[add_node(v, static_cast<int32_t>(junction))].depth = depth;
        queue.push_back(v);
      }
    }
  }

  void find_faces() {
    for (const Node& node : nodes_) {
      for (int32_t at = graph_.begin[node.vertex]; at < graph_.begin[node.vertex + 1]; ++at) {
        faces_.push_back(graph_.face[at]);
      }
    }
    keep_once(faces_);
    for (const int32_t f : faces_) {
      face_of_[f] = static_cast<int32_t>(first_areas_.size());
      std::array<TubePlace, 4> corners;
      for (int k = 0; k < 4; ++k) corners[k] = unrolled_.places[unrolled_.quads[f][k]];
      first_areas_.push_back(least_area(corners));
    }
    face_marks_.assign(faces_.size(), 0);
  }

  /// Neighbours pull the more the nearer they are: small faces are the stiffest, what moves is
  /// taken up by large ones.
  void weigh() {
    weights_.clear();
    held_.clear();
    for (const Node& node : nodes_) {
      if (node.rim) continue;
      const RimReach& reach = reaches_[node.junction];
      const double away = std::min(reach.from_centre(unrolled_.places[node.vertex]), reach.radius);
      const double hold = away / std::max(kFade * reach.radius * reach.radius, 1e-30);
      held_.push_back(hold * hold);
      const double quarter = reach.quarter_length;
      for (int32_t at = graph_.begin[node.vertex]; at < graph_.begin[node.vertex + 1]; ++at) {
        const glm::dvec2 way =
            difference(unrolled_.places[node.vertex], unrolled_.places[graph_.all[at]]);
        const double x = way.x * quarter;
        weights_.push_back(1.0 / std::max(x * x + way.y * way.y, 1e-30));
      }
    }
  }

  void relax(int sweeps) {
    for (size_t i = 0; i < rim_count_; ++i) {
      nodes_[i].velocity = nodes_[i].stopped ? glm::dvec2(0.0) : nodes_[i].step;
    }
    glm::dvec2 farthest(0.0);
    for (size_t i = 0; i < rim_count_; ++i) farthest = glm::max(farthest, glm::abs(nodes_[i].step));
    for (size_t i = rim_count_; i < nodes_.size(); ++i) nodes_[i].velocity = nodes_[i].relaxed;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      size_t weight = 0;
      for (size_t i = rim_count_; i < nodes_.size(); ++i) {
        Node& node = nodes_[i];
        glm::dvec2 sum(0.0);
        double weights = held_[i - rim_count_];
        for (int32_t at = graph_.begin[node.vertex]; at < graph_.begin[node.vertex + 1]; ++at) {
          const int32_t other = local_of_[graph_.all[at]];
          const double w = weights_[weight++];
          weights += w;
          if (other >= 0) sum += nodes_[other].velocity * w;
        }
        if (weights > 0.0 && !node.stopped) {
          node.velocity += (sum / weights - node.velocity) * kOverRelaxation;
          // Nothing goes further than what pushes it, however much relaxing overshoots.
          node.velocity = glm::clamp(node.velocity, -farthest, farthest);
        }
      }
    }
    for (Node& node : nodes_) node.relaxed = node.velocity;
  }

  TubePlace moved(int32_t vertex) const {
    TubePlace place = unrolled_.places[vertex];
    if (local_of_[vertex] >= 0) {
      const glm::dvec2& velocity = nodes_[local_of_[vertex]].velocity;
      place.quarter += velocity.x;
      place.length += velocity.y;
    }
    return place;
  }

  std::array<TubePlace, 4> moved_corners(const Quad& quad) const {
    return {moved(quad[0]), moved(quad[1]), moved(quad[2]), moved(quad[3])};
  }

  bool turns(int32_t face) const {
    const double first = first_areas_[face_of_[face]];
    return least_area(moved_corners(unrolled_.quads[face])) < std::min(first, kLeastArea * first);
  }

  /// Faces that the step would turn over.
  void find_turned() {
    turned_.clear();
    for (size_t i = 0; i < faces_.size(); ++i) {
      const Quad& quad = unrolled_.quads[faces_[i]];
      const double first = first_areas_[i];
      if (least_area(moved_corners(quad)) < std::min(first, kLeastArea * first)) {
        turned_.push_back(faces_[i]);
      }
    }
  }

  /// Puts the corners of turned faces that are free in the middle of their neighbours.
  void even_out() {
    std::vector<int32_t> vertices, faces;
    for (int pass = 0; pass < kEvenings && !turned_.empty(); ++pass) {
      vertices.clear();
      ++mark_;
      const auto take = [&](int32_t v) {
        if (local_of_[v] < 0 || nodes_[local_of_[v]].mark == mark_) return;
        nodes_[local_of_[v]].mark = mark_;
        vertices.push_back(v);
      };
      for (const int32_t f : turned_) {
        for (const int32_t corner : unrolled_.quads[f]) {
          take(corner);
          for (int32_t at = graph_.begin[corner]; at < graph_.begin[corner + 1]; ++at) {
            take(graph_.all[at]);
          }
        }
      }
      faces.clear();
      const auto look_at = [&](int32_t f) {
        if (face_marks_[face_of_[f]] == mark_) return;
        face_marks_[face_of_[f]] = mark_;
        faces.push_back(f);
      };
      for (const int32_t f : turned_) look_at(f);
      for (const int32_t v : vertices) {
        if (!to_middle(v)) continue;
        for (int32_t at = graph_.begin[v]; at < graph_.begin[v + 1]; ++at) look_at(graph_.face[at]);
      }
      turned_.clear();
      std::copy_if(faces.begin(), faces.end(), std::back_inserter(turned_),
                   [&](int32_t face) { return turns(face); });
    }
  }

  static void keep_once(std::vector<int32_t>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  }

  /// Moves a vertex between its neighbours; those further away than faces beside the rim are long
  /// pull as if they were nearer. False: it has to stay.
  bool to_middle(int32_t vertex) {
    if (local_of_[vertex] < 0) return false;
    Node& node = nodes_[local_of_[vertex]];
    if (node.rim || node.stopped) return false;
    const RimReach& reach = reaches_[node.junction];
    const TubePlace now = moved(vertex);
    glm::dvec2 sum(0.0);
    double count = 0.0;
    for (int32_t at = graph_.begin[vertex]; at < graph_.begin[vertex + 1]; ++at) {
      const glm::dvec2 way = difference(now, moved(graph_.all[at]));
      sum += way * std::min(1.0, reach.spread / std::max(reach.metres(way), 1e-30));
      count += 1.0;
    }
    if (count > 0.0) node.velocity += sum * (kEvening / count);
    return true;
  }

  /// Stops the rims' vertices at turned faces.
  void hold_rims() {
    for (const int32_t f : turned_) {
      for (const int32_t v : unrolled_.quads[f]) {
        if (local_of_[v] >= 0 && nodes_[local_of_[v]].rim) nodes_[local_of_[v]].stopped = true;
      }
    }
  }

  /// A rim's vertices wait for those beside them and for its slowest, or where some are held back
  /// others would run over them.
  void wait() {
    std::vector<int> slowest(junctions_.size(), steps_);
    for (size_t i = 0; i < rim_count_; ++i) {
      int& least = slowest[nodes_[i].junction];
      least = std::min(least, nodes_[i].gone);
    }
    for (size_t i = 0; i < rim_count_; ++i) {
      Node& node = nodes_[i];
      const RimReach& reach = reaches_[node.junction];
      const int behind = std::min(nodes_[node.before].gone, nodes_[node.after].gone);
      const double ahead = (node.gone - slowest[node.junction]) * reach.way / steps_;
      node.stopped = node.gone > behind + kMostAhead || ahead > reach.most_ahead;
    }
  }

  void take_step(int sweeps) {
    wait();
    for (int hold = 0;; ++hold) {
      relax(sweeps);
      find_turned();
      even_out();
      if (turned_.empty() || hold == kMostHolds) break;
      hold_rims();
    }
    stop_turned();
    for (size_t i = 0; i < rim_count_; ++i) nodes_[i].gone += nodes_[i].stopped ? 0 : 1;
    finish_step();
  }

  /// Gives the first faces around a rim room for the fillet, where they are narrow.
  void spread(int sweeps) {
    for (Node& node : nodes_) node.velocity = glm::dvec2(0.0);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      for (size_t i = rim_count_; i < nodes_.size(); ++i) {
        if (nodes_[i].depth <= reaches_[nodes_[i].junction].spread_depth)
          to_middle(nodes_[i].vertex);
      }
    }
    find_turned();
    even_out();
    stop_turned();
    finish_step();
  }

  /// What still turns over stays where it is in this step, and so does whatever would turn because
  /// of that.
  void stop_turned() {
    bool more = !turned_.empty();
    while (more) {
      more = false;
      for (const int32_t f : turned_) {
        for (const int32_t v : unrolled_.quads[f]) {
          if (local_of_[v] < 0) continue;
          Node& node = nodes_[local_of_[v]];
          more |= !node.stopped || node.velocity != glm::dvec2(0.0);
          node.stopped = true;
          node.velocity = glm::dvec2(0.0);
        }
      }
      find_turned();
    }
  }

  void finish_step() {
    for (Node& node : nodes_) {
      unrolled_.places[node.vertex] = moved(node.vertex);
      node.stopped = false;
    }
  }

  const Graph& graph_;
  const std::vector<Rim>& rims_;
  UnrolledLimbs& unrolled_;
  /// Locals.
  std::vector<int32_t>& local_of_;
  std::vector<int32_t>& face_of_;
  std::vector<int32_t> junctions_;
  std::vector<RimReach> reaches_;
  /// Those of rims first.
  std::vector<Node> nodes_;
  size_t rim_count_ = 0;
  int steps_ = 0;
  std::vector<int32_t> faces_;
  std::vector<double> first_areas_;
  /// What was last looked at, of nodes and faces.
  int mark_ = 0;
  std::vector<int> face_marks_;
  /// Of neighbours, and of the places that hold what is free back.
  std::vector<double> weights_, held_;
  std::vector<int32_t> turned_;
};

}  // namespace

glm::dvec2 difference(const TubePlace& from, const TubePlace& to) {
  return {short_way(to.quarter - from.quarter), to.length - from.length};
}

void move_membrane(const Graph& graph, const std::vector<Rim>& rims,
                   std::span<const RimReach> reaches, UnrolledLimbs& unrolled, Locals& locals) {
  Membrane(graph, rims, unrolled, locals).move(reaches);
}

}  // namespace snowbough::tree
