#include "tree/obj/seams.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "base/group_by_key.h"
#include "base/union_find.h"

namespace snowbough::tree {
namespace {

/// Texture coordinates are compared in steps of this size: formats that flip the V axis round them.
constexpr double kUvStep = 1e-5;

/// A side of a polygon with no other polygon: its corner, the corner after it, and its group.
struct OpenEdge {
  int32_t corner = 0;
  int32_t next = 0;
  int32_t group = 0;
};

/// Sets the edges' groups: numbers that are equal for equal names of object and group.
void set_groups(const ObjScene& scene, std::vector<OpenEdge>& edges) {
  std::map<std::pair<int32_t, int32_t>, int32_t> numbers;
  std::vector<int32_t> of_run;
  std::vector<int32_t> first_corner;
  for (const FaceRun& run : scene.runs) {
    const auto next = static_cast<int32_t>(numbers.size());
    of_run.push_back(numbers.try_emplace({run.object, run.group}, next).first->second);
    first_corner.push_back(scene.face_begin[run.first_face]);
  }
  for (OpenEdge& edge : edges) {
    const auto after = std::upper_bound(first_corner.begin(), first_corner.end(), edge.corner);
    edge.group = of_run[static_cast<size_t>(after - first_corner.begin()) - 1];
  }
}

/// Whether corners of a corner's polygon lie at one place.
bool has_coincident_corners(const ObjScene& scene, int32_t corner) {
  const auto after = std::upper_bound(scene.face_begin.begin(), scene.face_begin.end(), corner);
  for (int32_t a = after[-1]; a < *after; ++a) {
    for (int32_t b = a + 1; b < *after; ++b) {
      if (scene.positions[scene.corner_vertex[a]] == scene.positions[scene.corner_vertex[b]]) {
        return true;
      }
    }
  }
  return false;
}

std::vector<OpenEdge> find_open_edges(const ObjScene& scene) {
  std::vector<int32_t> next(scene.corner_vertex.size());
  std::iota(next.begin(), next.end(), 1);
  for (int32_t f = 0; f < scene.face_count(); ++f) {
    if (scene.face_begin[f] < scene.face_begin[f + 1]) {
      next[scene.face_begin[f + 1] - 1] = scene.face_begin[f];
    }
  }
  const auto ends = [&](int32_t c) {
    return std::minmax(scene.corner_vertex[c], scene.corner_vertex[next[c]]);
  };
  std::vector<int32_t> begin;
  std::vector<int32_t> corners;
  base::group_by_key(
      scene.positions.size(),
      [&](const auto& visit) {
        for (size_t c = 0; c < next.size(); ++c) {
          visit(ends(static_cast<int32_t>(c)).first, static_cast<int32_t>(c));
        }
      },
      begin, corners);
  std::vector<OpenEdge> open;
  std::vector<std::pair<int32_t, int32_t>> around;
  for (size_t v = 0; v < scene.positions.size(); ++v) {
    around.clear();
    for (int32_t i = begin[v]; i < begin[v + 1]; ++i) {
      around.emplace_back(ends(corners[i]).second, corners[i]);
    }
    std::sort(around.begin(), around.end());
    for (size_t i = 0; i < around.size();) {
      size_t j = i + 1;
      while (j < around.size() && around[j].first == around[i].first) ++j;
      if (j == i + 1) open.push_back({around[i].second, next[around[i].second], 0});
      i = j;
    }
  }
  return open;
}

/// Equal for equal positions, also for zeros of either sign.
uint64_t hash_of(const glm::vec3& position) {
  uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    hash = (hash ^ std::bit_cast<uint32_t>(position[axis] + 0.0f)) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 29;
  }
  return hash;
}

/// Drops edges at whose place there is no other: nearly all, those of leaves.
void drop_lone_edges(const ObjScene& scene, std::vector<OpenEdge>& edges) {
  std::vector<std::pair<uint64_t, int32_t>> places;
  places.reserve(edges.size());
  for (size_t e = 0; e < edges.size(); ++e) {
    const auto end = [&](int32_t corner) {
      return hash_of(scene.positions[scene.corner_vertex[corner]]);
    };
    places.emplace_back(end(edges[e].corner) + end(edges[e].next), static_cast<int32_t>(e));
  }
  std::sort(places.begin(), places.end());
  std::vector<char> lone(edges.size(), 0);
  for (size_t i = 0; i < places.size(); ++i) {
    const bool before = i > 0 && places[i - 1].first == places[i].first;
    const bool after = i + 1 < places.size() && places[i + 1].first == places[i].first;
    lone[places[i].second] = before || after ? 0 : 1;
  }
  size_t kept = 0;
  for (size_t e = 0; e < edges.size(); ++e) {
    if (lone[e] == 0) edges[kept++] = edges[e];
  }
  edges.resize(kept);
}

/// Numbers of places, equal for equal keys.
template <typename Key>
std::vector<int32_t> number_places(size_t count, const Key& key) {
  std::vector<int32_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int32_t a, int32_t b) { return key(a) < key(b); });
  std::vector<int32_t> number(count, 0);
  for (size_t i = 1; i < count; ++i) {
    number[order[i]] = number[order[i - 1]] + (key(order[i - 1]) < key(order[i]) ? 1 : 0);
  }
  return number;
}

/// Joins the ends of edges that lie alone with an opposite one, and leaves the others in `open`.
/// @param place  of each edge's begin and end: 2 * edge, 2 * edge + 1.
void join_pairs(const ObjScene& scene, const std::vector<int32_t>& place,
                std::vector<int32_t>& edges, const std::vector<OpenEdge>& open,
                base::UnionFind& sets) {
  const auto ends = [&](int32_t e) { return std::minmax(place[2 * e], place[2 * e + 1]); };
  std::sort(edges.begin(), edges.end(),
            [&](int32_t a, int32_t b) { return std::tuple(ends(a), a) < std::tuple(ends(b), b); });
  std::vector<int32_t> left;
  for (size_t i = 0; i < edges.size();) {
    size_t j = i + 1;
    while (j < edges.size() && ends(edges[j]) == ends(edges[i])) ++j;
    const int32_t a = edges[i];
    const int32_t b = edges[j - 1];
    if (j == i + 2 && place[2 * a] == place[2 * b + 1]) {
      const auto vertex = [&](int32_t corner) { return scene.corner_vertex[corner]; };
      sets.join(vertex(open[a].corner), vertex(open[b].next));
      sets.join(vertex(open[a].next), vertex(open[b].corner));
    } else {
      left.insert(left.end(), edges.begin() + static_cast<ptrdiff_t>(i),
                  edges.begin() + static_cast<ptrdiff_t>(j));
    }
    i = j;
  }
  edges = std::move(left);
}

}  // namespace

void close_seams(ObjScene& scene) {
  std::vector<OpenEdge> open = find_open_edges(scene);
  drop_lone_edges(scene, open);
  if (open.size() < 2) return;
  set_groups(scene, open);
  const auto corner_of = [&](int32_t end) {
    return end % 2 == 0 ? open[end / 2].corner : open[end / 2].next;
  };
  const auto position = [&](int32_t end) {
    const glm::vec3& p = scene.positions[scene.corner_vertex[corner_of(end)]];
    return std::tuple(open[end / 2].group, p.x, p.y, p.z);
  };
  const std::vector<int32_t> place = number_places(2 * open.size(), position);
  base::UnionFind sets(scene.positions.size());
  std::vector<int32_t> edges(open.size());
  std::iota(edges.begin(), edges.end(), 0);
  if (!scene.corner_uv.empty()) {
    const auto textured = [&](int32_t end) {
      const int32_t uv = scene.corner_uv[corner_of(end)];
      const glm::dvec2 at = uv >= 0 ? glm::dvec2(scene.uvs[uv]) : glm::dvec2(0.0);
      return std::tuple(place[end], std::round(at.x / kUvStep), std::round(at.y / kUvStep));
    };
    join_pairs(scene, number_places(place.size(), textured), edges, open, sets);
  }
  join_pairs(scene, place, edges, open, sets);
  // Polygons without area, such as those of a tip that is a ring, have several edges at one place.
  std::erase_if(edges, [&](int32_t e) { return has_coincident_corners(scene, open[e].corner); });
  join_pairs(scene, place, edges, open, sets);
  // Corners of one polygon are no two sides of a seam: the polygon has shrunk, as at the base of a
  // twig that is a cone of no width.
  std::vector<char> is_seam(scene.positions.size(), 1);
  for (int32_t f = 0; f < scene.face_count(); ++f) {
    for (int32_t a = scene.face_begin[f]; a < scene.face_begin[f + 1]; ++a) {
      for (int32_t b = a + 1; b < scene.face_begin[f + 1]; ++b) {
        const int32_t one = scene.corner_vertex[a], other = scene.corner_vertex[b];
        if (one != other && sets.find(one) == sets.find(other)) is_seam[sets.find(one)] = 0;
      }
    }
  }
  for (int32_t& v : scene.corner_vertex) {
    if (is_seam[sets.find(v)] != 0) v = sets.find(v);
  }
}

void weld_positions(ObjScene& scene) {
  const auto position = [&](int32_t v) {
    const glm::vec3& p = scene.positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  const std::vector<int32_t> place = number_places(scene.positions.size(), position);
  std::vector<int32_t> first(place.size(), -1);
  for (size_t v = 0; v < place.size(); ++v) {
    if (first[place[v]] < 0) first[place[v]] = static_cast<int32_t>(v);
  }
  for (int32_t& v : scene.corner_vertex) v = first[place[v]];
}

}  // namespace snowbough::tree
