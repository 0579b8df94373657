#include "tree/detail/unrolled_limbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>

#include "base/parallel_for.h"

namespace snowbough::tree {
namespace {

/// A step is no longer than this share of the faces beside the rim; at most so many steps are made.
constexpr double kStep = 0.7;
constexpr int kMostSteps = 30;
/// What moves with a rim: within so many times the way of its farthest point, and so many radii
/// of the hole beyond it.
constexpr double kReachOfWay = 2.5;
constexpr double kReach = 2.0;
/// Sweeps of the relaxation in the first step and in each of those after it, and its factor.
constexpr int kFirstSweeps = 25;
constexpr int kSweeps = 8;
constexpr double kOverRelaxation = 1.5;
/// Afterwards vertices up to so many edges from a rim go between their neighbours, in so many
/// sweeps at first and after each step; those further away than the rim's own edges are long, or so
/// many radii of the hole, pull as if they were nearer.
constexpr int kSpreadDepth = 3;
constexpr int kSpreads = 12;
constexpr int kStepSpreads = 4;
constexpr double kSpread = 0.5;
/// A face keeps at least this share of its area.
constexpr double kLeastArea = 0.04;
/// Steps that a rim's vertex may be ahead of the next.
constexpr int kMostAhead = 1;
/// How often the corners of faces that turn over are put between their neighbours before the rims
/// around them are held back, and how often that within a step before they stay themselves.
constexpr int kEvenings = 10;
constexpr double kEvening = 0.6;
constexpr int kMostHolds = 4;
/// Chains that a thread takes at a time.
constexpr size_t kBlock = 4;

/// The vertices that share an edge of the unrolled faces with every vertex.
struct Graph {
  std::vector<int32_t> begin, all;
  /// The faces around it, in the same ranges.
  std::vector<int32_t> face;

  Graph(const std::vector<Quad>& quads, size_t count) : begin(count + 1, 0) {
    for (const Quad& quad : quads) {
      for (const int32_t v : quad) ++begin[v + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    all.resize(begin.back());
    face.resize(begin.back());
    std::vector<int32_t> next(begin.begin(), begin.end() - 1);
    for (size_t f = 0; f < quads.size(); ++f) {
      for (int k = 0; k < 4; ++k) {
        const int32_t at = next[quads[f][k]]++;
        all[at] = quads[f][(k + 1) % 4];
        face[at] = static_cast<int32_t>(f);
      }
    }
  }
};

/// Of a difference of quarters, the short way round.
double short_way(double quarters) {
  return quarters - 4.0 * std::round(quarters / 4.0);
}

glm::dvec2 difference(const TubePlace& from, const TubePlace& to) {
  return {short_way(to.quarter - from.quarter), to.length - from.length};
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

/// All rims on one chain, and what moves with them.
class Membrane {
 public:
  Membrane(const Graph& graph, const std::vector<Rim>& rims, const std::vector<Fork>& forks,
           const LimbTubes& tubes, UnrolledLimbs& unrolled, std::vector<int32_t>& local_of)
      : graph_(graph),
        rims_(rims),
        forks_(forks),
        tubes_(tubes),
        unrolled_(unrolled),
        local_of_(local_of) {}

  /// Moves the rims of some junctions on a chain as far as they go.
  void move(int32_t chain, std::span<const int32_t> junctions) {
    find_rims(chain, junctions);
    for (size_t j = 0; j < junctions_.size(); ++j) {
      find_free(j);
    }
    find_faces();
    spread(kSpreads);
    for (int step = 0; step < steps_; ++step) {
      weigh();
      take_step(step == 0 ? kFirstSweeps : kSweeps);
      spread(kStepSpreads);
    }
    for (size_t i = 0; i < rim_count_; ++i) {
      const Node& node = nodes_[i];
      unrolled_.shares[node.vertex] = steps_ > 0 ? static_cast<double>(node.gone) / steps_ : 1.0;
    }
    for (const Node& node : nodes_) local_of_[node.vertex] = -1;
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
    /// Way of a rim's vertex in a step, and that of this step.
    glm::dvec2 step{0.0}, velocity{0.0};
    /// Steps that a rim's vertex has made, and the nodes before and after it on the rim.
    int gone = 0;
    int32_t before = -1, after = -1;
    TubePlace first;
  };

  int32_t add_node(int32_t vertex, int32_t junction) {
    local_of_[vertex] = static_cast<int32_t>(nodes_.size());
    Node& node = nodes_.emplace_back();
    node.vertex = vertex;
    node.junction = junction;
    node.first = unrolled_.places[vertex];
    return local_of_[vertex];
  }

  void find_rims(int32_t chain, std::span<const int32_t> junctions) {
    double steps = 0.0;
    for (const int32_t j : junctions) {
      const auto number = static_cast<int32_t>(junctions_.size());
      junctions_.push_back(j);
      glm::dvec2 middle(0.0);
      for (const RimPoint& point : rims_[j]) middle += difference(rims_[j][0].base, point.base);
      middle /= static_cast<double>(rims_[j].size());
      Reach& reach = reaches_.emplace_back();
      reach.centre = {rims_[j][0].base.length + middle.y, rims_[j][0].base.quarter + middle.x};
      reach.quarter_length = 0.5 * M_PI * tubes_.radius(chain, reach.centre.length);
      double way = 0.0, extent = 0.0;
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
        way = std::max(way, reach.metres(move));
        extent = std::max({extent, reach.from_centre(point.base), reach.from_centre(point.target)});
      }
      for (size_t i = 0; i < rims_[j].size(); ++i) {
        const int32_t here = local_of_[rims_[j][i].vertex];
        const int32_t next = local_of_[rims_[j][(i + 1) % rims_[j].size()].vertex];
        nodes_[here].after = next;
        nodes_[next].before = here;
      }
      reach.spread =
          std::min(kSpread, 2.0 * M_PI / static_cast<double>(rims_[j].size())) * forks_[j].radius;
      reach.spread_depth = std::max(kSpreadDepth, static_cast<int>(rims_[j].size()) / 6);
      reach.radius = extent + kReachOfWay * way + kReach * forks_[j].radius;
      steps = std::max(steps, way / std::max(kStep * reach.spread, 1e-30));
    }
    steps_ = std::clamp(static_cast<int>(std::ceil(steps)), 0, kMostSteps);
    rim_count_ = nodes_.size();
    for (Node& node : nodes_) node.step /= std::max(steps_, 1);
  }

  /// What lies around a rim within its reach.
  void find_free(size_t junction) {
    const Reach& reach = reaches_[junction];
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
      std::array<TubePlace, 4> corners;
      for (int k = 0; k < 4; ++k) corners[k] = unrolled_.places[unrolled_.quads[f][k]];
      first_areas_.push_back(least_area(corners));
    }
  }

  /// Neighbours pull the more the nearer they are: small faces are the stiffest, what moves is
  /// taken up by large ones.
  void weigh() {
    weights_.clear();
    for (const Node& node : nodes_) {
      if (node.rim) continue;
      const double quarter = reaches_[node.junction].quarter_length;
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
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      size_t weight = 0;
      for (size_t i = rim_count_; i < nodes_.size(); ++i) {
        Node& node = nodes_[i];
        glm::dvec2 sum(0.0);
        double weights = 0.0;
        for (int32_t at = graph_.begin[node.vertex]; at < graph_.begin[node.vertex + 1]; ++at) {
          const int32_t other = local_of_[graph_.all[at]];
          const double w = weights_[weight++];
          weights += w;
          if (other >= 0) sum += nodes_[other].velocity * w;
        }
        if (weights > 0.0 && !node.stopped) {
          node.velocity += (sum / weights - node.velocity) * kOverRelaxation;
        }
      }
    }
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
    const double first = first_areas_[face_index(face)];
    return least_area(moved_corners(unrolled_.quads[face])) < std::min(first, kLeastArea * first);
  }

  size_t face_index(int32_t face) const {
    return std::lower_bound(faces_.begin(), faces_.end(), face) - faces_.begin();
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
      for (const int32_t f : turned_) {
        for (const int32_t corner : unrolled_.quads[f]) {
          vertices.push_back(corner);
          for (int32_t at = graph_.begin[corner]; at < graph_.begin[corner + 1]; ++at) {
            vertices.push_back(graph_.all[at]);
          }
        }
      }
      keep_once(vertices);
      faces = turned_;
      for (const int32_t v : vertices) {
        if (!to_middle(v)) continue;
        faces.insert(faces.end(), graph_.face.begin() + graph_.begin[v],
                     graph_.face.begin() + graph_.begin[v + 1]);
      }
      keep_once(faces);
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
    const Reach& reach = reaches_[node.junction];
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

  /// A rim's vertices wait for those beside them, or where some are held back others would run over
  /// them.
  void wait() {
    for (size_t i = 0; i < rim_count_; ++i) {
      Node& node = nodes_[i];
      const int behind = std::min(nodes_[node.before].gone, nodes_[node.after].gone);
      node.stopped = node.gone > behind + kMostAhead;
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

  /// How far around a hole vertices move, in metres on the unrolled parent.
  struct Reach {
    TubePlace centre;
    double radius = 0.0;
    double quarter_length = 1.0;
    /// Length of the faces beside the rim that the fillet asks for.
    double spread = 0.0;
    int spread_depth = kSpreadDepth;

    double metres(const glm::dvec2& way) const { return std::hypot(way.x * quarter_length, way.y); }
    double from_centre(const TubePlace& place) const { return metres(difference(centre, place)); }
  };

  const Graph& graph_;
  const std::vector<Rim>& rims_;
  const std::vector<Fork>& forks_;
  const LimbTubes& tubes_;
  UnrolledLimbs& unrolled_;
  /// Per vertex: its node, or -1; shared by all chains, which have no vertex in common.
  std::vector<int32_t>& local_of_;
  std::vector<int32_t> junctions_;
  std::vector<Reach> reaches_;
  /// Those of rims first.
  std::vector<Node> nodes_;
  size_t rim_count_ = 0;
  int steps_ = 0;
  std::vector<int32_t> faces_;
  std::vector<double> first_areas_;
  std::vector<double> weights_;
  std::vector<int32_t> turned_;
};

}  // namespace

void move_rims(const std::vector<Rim>& rims, const std::vector<Fork>& forks, const LimbTubes& tubes,
               double least_radius, int threads, UnrolledLimbs& unrolled) {
  const Graph graph(unrolled.quads, unrolled.places.size());
  std::vector<std::pair<int32_t, int32_t>> by_chain;
  for (size_t j = 0; j < forks.size(); ++j) {
    if (forks[j].radius >= least_radius && rims[j].size() > 4) {
      by_chain.emplace_back(forks[j].parent_chain, static_cast<int32_t>(j));
    }
  }
  std::sort(by_chain.begin(), by_chain.end());
  std::vector<int32_t> junctions;
  std::vector<size_t> first;
  for (size_t i = 0; i < by_chain.size(); ++i) {
    if (i == 0 || by_chain[i].first != by_chain[i - 1].first) first.push_back(i);
    junctions.push_back(by_chain[i].second);
  }
  first.push_back(by_chain.size());
  unrolled.shares.assign(unrolled.places.size(), 0.0);
  std::vector<int32_t> local_of(unrolled.places.size(), -1);
  base::parallel_for(first.size() - 1, kBlock, {threads, {}}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Membrane(graph, rims, forks, tubes, unrolled, local_of)
          .move(by_chain[first[i]].first,
                {junctions.data() + first[i], junctions.data() + first[i + 1]});
    }
  });
}

}  // namespace snowbough::tree
