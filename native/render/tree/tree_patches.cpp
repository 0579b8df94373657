#include "render/tree/tree_patches.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "render/tree/patch_bounds.h"
#include "render/tree/patch_order.h"
#include "shaders/lib/limb_section.h"

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

/// Greatest difference of equal bark coordinates, in turns around the limb.
constexpr float kSameUv = 1e-4f;
/// Greatest increase of the bark's amplitude per metre of distance from places without bark, and
/// the greatest number of rounds in which this limit spreads from vertex to vertex.
constexpr float kBarkSlope = 0.25f;
constexpr int kBarkRounds = 64;

void require_tree(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument("add_tree: " + what);
}

void check(const TreeSource& source) {
  const size_t quads = source.quads.size();
  require_tree(quads > 0, "the tree has no quads");
  require_tree(source.bark_uv.size() == quads && source.branch_level.size() == quads &&
                   source.branch.size() == quads && source.section.size() == quads &&
                   source.kind.size() == quads,
               "bark_uv, branch_level, branch, section and kind must have one entry per quad");
  require_tree(source.snow_uv.empty() || source.snow_uv.size() == quads,
               "snow_uv must have one entry per quad, or be empty");
  require_tree(source.bone_indices.size() == source.vertices.size() &&
                   source.bone_weights.size() == source.vertices.size(),
               "bone_indices and bone_weights must have one entry per vertex");
  for (size_t f = 0; f < quads; ++f) {
    for (const int32_t v : source.quads[f]) {
      require_tree(v >= 0 && v < static_cast<int32_t>(source.vertices.size()),
                   "vertex index " + std::to_string(v) + " of quad " + std::to_string(f) +
                       " must be at least 0 and below " + std::to_string(source.vertices.size()));
    }
    require_tree(source.kind[f] == QuadKind::kCap ||
                     (source.section[f] >= 0 &&
                      source.section[f] < static_cast<int32_t>(source.sections.size())),
                 "section " + std::to_string(source.section[f]) + " of quad " + std::to_string(f) +
                     " must be at least 0 and below " + std::to_string(source.sections.size()));
    require_tree(source.branch_level[f] >= 0, "branch levels must not be negative");
  }
  for (const auto& bones : source.bone_indices) {
    for (const int32_t bone : bones) {
      require_tree(bone >= 0 && bone < source.bone_count,
                   "bone index " + std::to_string(bone) +
                       " of a vertex must be at least 0 and below " +
                       std::to_string(source.bone_count));
    }
  }
}

shared::TreeSection to_shared(const LimbSection& section) {
  const float round_from = std::min(2.0f * section.begin_radius, section.length);
  return {vec4(section.begin, section.length), vec4(section.axis, section.from_hole ? 1.0f : 0.0f),
          vec4(section.begin_radius, section.end_radius, std::max(round_from, 1e-30f), 0.0f)};
}

int32_t kind_of(QuadKind kind) {
  if (kind == QuadKind::kCap) return shared::kCapPatch;
  return kind == QuadKind::kWall ? shared::kWallPatch : shared::kFlatInset;
}

/// True if two bark coordinates are equal up to whole turns.
bool same_bark(const vec2& a, const vec2& b) {
  const float turns = a.x - b.x;
  return std::abs(turns - std::round(turns)) < kSameUv && std::abs(a.y - b.y) < kSameUv;
}

class PatchBuilder {
 public:
  PatchBuilder(const TreeSource& source, float bark_depth)
      : source_(source), bark_depth_(bark_depth) {
    for (const LimbSection& section : source.sections) {
      made_.sections.push_back(to_shared(section));
    }
  }

  TreePatches build() {
    round_vertices();
    add_patches();
    add_normals();
    add_edges();
    limit_bark();
    list_snow();
    bound_patches(made_);
    order_patches(made_);
    made_.has_snow_uvs = !source_.snow_uv.empty();
    made_.bone_count = source_.bone_count;
    made_.branch_levels =
        1 + *std::max_element(source_.branch_level.begin(), source_.branch_level.end());
    return std::move(made_);
  }

 private:
  int32_t section_of(size_t quad) const {
    return source_.kind[quad] == QuadKind::kCap ? -1 : source_.section[quad];
  }

  vec3 position(int32_t vertex) const { return vec3(made_.vertices[vertex].position); }

  void round_vertices() {
    const size_t count = source_.vertices.size();
    std::vector<std::vector<int32_t>> around(count);
    std::vector<int32_t> inset(count, -1);
    std::vector<vec2> uv(count);
    std::vector<uint8_t> seen(count, 0), one_bark(count, 1);
    for (size_t f = 0; f < source_.quads.size(); ++f) {
      for (int k = 0; k < 4; ++k) {
        const int32_t v = source_.quads[f][k];
        const int32_t section = section_of(f);
        auto& of_vertex = around[v];
        if (section >= 0 &&
            std::find(of_vertex.begin(), of_vertex.end(), section) == of_vertex.end()) {
          of_vertex.push_back(section);
        }
        if (source_.kind[f] == QuadKind::kInset && k >= 2) inset[v] = section;
        if (seen[v] == 0) uv[v] = source_.bark_uv[f][k];
        if (!same_bark(uv[v], source_.bark_uv[f][k])) one_bark[v] = 0;
        seen[v] = 1;
      }
    }
    made_.lowest = made_.highest = source_.vertices[0];
    for (size_t v = 0; v < count; ++v) {
      const vec3 p = source_.vertices[v];
      if (inset[v] >= 0) around[v] = {inset[v]};
      vec3 sum(0.0f);
      float radius = 0.0f;
      for (const int32_t section : around[v]) {
        sum += shared::on_limb(made_.sections[section], p);
        radius += shared::limb_radius(made_.sections[section], p);
      }
      const auto sections = static_cast<float>(std::max<size_t>(around[v].size(), 1));
      radius /= sections;
      shared::TreeVertex vertex{};
      vertex.position = vec4(around[v].empty() ? p : sum / sections,
                             one_bark[v] != 0 ? bark_depth_ * radius : 0.0f);
      vertex.normal = vec4(0.0f, 0.0f, 0.0f, 2.0f * static_cast<float>(M_PI) * radius);
      vertex.bark_uv = vec4(uv[v], 0.0f, 0.0f);
      for (int k = 0; k < 4; ++k) {
        vertex.bones[k] = source_.bone_indices[v][k];
        vertex.weights[k] = source_.bone_weights[v][k];
      }
      made_.vertices.push_back(vertex);
      made_.lowest = glm::min(made_.lowest, vec3(vertex.position));
      made_.highest = glm::max(made_.highest, vec3(vertex.position));
    }
  }

  void add_patches() {
    for (size_t f = 0; f < source_.quads.size(); ++f) {
      const auto& quad = source_.quads[f];
      const auto& uv = source_.bark_uv[f];
      shared::TreePatch patch{};
      const vec3 across =
          glm::cross(position(quad[2]) - position(quad[0]), position(quad[3]) - position(quad[1]));
      const int32_t section = section_of(f);
      patch.vertices = {quad[0], quad[1], quad[2], quad[3]};
      patch.limb = {section, source_.branch_level[f], source_.branch[f], kind_of(source_.kind[f])};
      patch.bark_uv_01 = vec4(uv[0], uv[1]);
      patch.bark_uv_23 = vec4(uv[2], uv[3]);
      const std::array<vec2, 4> snow = snow_uv(f);
      patch.snow_uv_01 = vec4(snow[0], snow[1]);
      patch.snow_uv_23 = vec4(snow[2], snow[3]);
      for (int k = 0; k < 4; ++k) {
        const vec3 p = position(quad[k]);
        const vec3 round = section >= 0 ? shared::on_limb(made_.sections[section], p) : p;
        patch.rest[k] = vec4(p - round, 0.0f);
      }
      patch.rest[0].w = 0.5f * glm::length(across);
      made_.largest_area = std::max(made_.largest_area, patch.rest[0].w);
      if (section < 0) {
        patch.normal = vec4(across / std::max(glm::length(across), 1e-30f), 0.0f);
      }
      made_.patches.push_back(patch);
    }
  }

  /// Sets the vertex normals: means over the round surfaces of the sections that meet there. Means
  /// over the faces would tilt them towards the larger ones, which shows beside holes. Caps have no
  /// section; their other vertices have area-weighted means.
  void add_normals() {
    std::vector<vec3> sums(made_.vertices.size(), vec3(0.0f)), caps = sums;
    std::vector<std::vector<int32_t>> counted(made_.vertices.size());
    for (const shared::TreePatch& patch : made_.patches) {
      const glm::ivec4& v = patch.vertices;
      const vec3 across = glm::cross(position(v.z) - position(v.x), position(v.w) - position(v.y));
      for (int k = 0; k < 4; ++k) {
        caps[v[k]] += across;
        const int32_t section = patch.limb.x;
        std::vector<int32_t>& known = counted[v[k]];
        if (section < 0 || std::find(known.begin(), known.end(), section) != known.end()) continue;
        known.push_back(section);
        const shared::TreeSection& of = made_.sections[section];
        const float away = glm::length(glm::cross(position(v[k]) - vec3(of.begin), vec3(of.axis)));
        if (away > 0.0f) sums[v[k]] += shared::limb_normal(of, position(v[k]));
      }
    }
    for (size_t v = 0; v < sums.size(); ++v) {
      vec3 normal = glm::length(sums[v]) > 1e-3f ? sums[v] : caps[v];
      normal = glm::length(normal) > 0.0f ? glm::normalize(normal) : vec3(0.0f, 0.0f, 1.0f);
      made_.vertices[v].normal = vec4(normal, made_.vertices[v].normal.w);
    }
  }

  /// A side of a quad, from its lower to its higher vertex index.
  struct Side {
    int32_t a, b, quad, corner;
    bool operator<(const Side& other) const {
      return std::tie(a, b, quad, corner) < std::tie(other.a, other.b, other.quad, other.corner);
    }
  };

  void add_edges() {
    std::vector<Side> sides;
    for (size_t f = 0; f < source_.quads.size(); ++f) {
      for (int k = 0; k < 4; ++k) {
        const int32_t from = source_.quads[f][k], to = source_.quads[f][(k + 1) % 4];
        sides.push_back({std::min(from, to), std::max(from, to), static_cast<int32_t>(f), k});
      }
    }
    std::sort(sides.begin(), sides.end());
    for (size_t i = 0; i < sides.size();) {
      size_t end = i + 1;
      while (end < sides.size() && sides[end].a == sides[i].a && sides[end].b == sides[i].b) ++end;
      require_tree(end - i <= 2, "the edge between vertices " + std::to_string(sides[i].a) +
                                     " and " + std::to_string(sides[i].b) +
                                     " has more than two quads");
      add_edge(sides[i], end - i == 2 ? sides[i + 1] : sides[i]);
      i = end;
    }
    for (size_t f = 0; f < made_.patches.size(); ++f) {
      shared::TreePatch& patch = made_.patches[f];
      const bool round_side = made_.edges[patch.edges[0] >> 1].first_rest.w > 0.5f;
      if (source_.kind[f] == QuadKind::kInset && round_side) patch.limb.w = shared::kRoundInset;
    }
  }

  std::array<vec2, 4> snow_uv(size_t quad) const {
    return source_.snow_uv.empty() ? std::array<vec2, 4>{} : source_.snow_uv[quad];
  }

  /// Coordinates at the ends of a side, lower vertex index first, from those at the quad's corners.
  std::array<vec2, 2> along(const Side& side, const std::array<vec2, 4>& uv) const {
    const bool reversed = source_.quads[side.quad][side.corner] != side.a;
    const vec2 from = uv[side.corner], to = uv[(side.corner + 1) % 4];
    return reversed ? std::array<vec2, 2>{to, from} : std::array<vec2, 2>{from, to};
  }

  void add_edge(const Side& left, const Side& right) {
    shared::TreeEdge edge{};
    int32_t first = section_of(left.quad), second = section_of(right.quad);
    const bool left_inset = source_.kind[left.quad] == QuadKind::kInset;
    const bool right_inset = source_.kind[right.quad] == QuadKind::kInset;
    if ((left_inset || right_inset) && source_.branch[left.quad] != source_.branch[right.quad]) {
      (left_inset ? second : first) = -1;
    }
    if (first < 0) std::swap(first, second);
    if (second == first) second = -1;
    edge.ends = {left.a, left.b, first, second};
    const auto missing = [&](int32_t vertex) {
      const vec3 p = position(vertex);
      vec3 round = first >= 0 ? shared::on_limb(made_.sections[first], p) : p;
      if (second >= 0) round = 0.5f * (round + shared::on_limb(made_.sections[second], p));
      return p - round;
    };
    const auto runs_round = [&](const Side& side) {
      return source_.kind[side.quad] == QuadKind::kWall && side.corner % 2 == 0;
    };
    edge.first_rest = vec4(missing(left.a), runs_round(left) || runs_round(right) ? 1.0f : 0.0f);
    edge.last_rest = vec4(missing(left.b), 0.0f);
    const auto uv = along(left, source_.bark_uv[left.quad]);
    const auto other = along(right, source_.bark_uv[right.quad]);
    const auto snow = along(left, snow_uv(left.quad)), beside = along(right, snow_uv(right.quad));
    edge.snow_uv = vec4(snow[0], snow[1]);
    edge.other_snow_uv = vec4(beside[0], beside[1]);
    edge.bark_uv = vec4(uv[0], uv[1]);
    const bool is_continued = same_bark(uv[0], other[0]) && same_bark(uv[1], other[1]);
    edge.metric =
        vec4(0.5f * (made_.patches[left.quad].rest[0].w + made_.patches[right.quad].rest[0].w),
             std::min(source_.branch_level[left.quad], source_.branch_level[right.quad]),
             is_continued ? 1.0f : 0.0f, 0.0f);
    const auto index = static_cast<int32_t>(made_.edges.size());
    for (const Side* side : {&left, &right}) {
      const bool reversed = source_.quads[side->quad][side->corner] != side->a;
      made_.patches[side->quad].edges[side->corner] = 2 * index + (reversed ? 1 : 0);
    }
    made_.edges.push_back(edge);
  }

  void list_snow() {
    std::vector<std::vector<vec2>> uvs(made_.vertices.size());
    for (size_t f = 0; f < source_.quads.size(); ++f) {
      for (int k = 0; k < 4; ++k) {
        auto& known = uvs[source_.quads[f][k]];
        const vec2 uv = snow_uv(f)[k];
        if (std::find(known.begin(), known.end(), uv) == known.end()) known.push_back(uv);
      }
    }
    for (size_t v = 0; v < uvs.size(); ++v) {
      vec4& packed = made_.vertices[v].bark_uv;
      packed.z = std::bit_cast<float>(static_cast<int32_t>(made_.vertex_snow.size()));
      made_.vertex_snow.insert(made_.vertex_snow.end(), uvs[v].begin(), uvs[v].end());
      packed.w = std::bit_cast<float>(static_cast<int32_t>(made_.vertex_snow.size()));
    }
  }

  /// Limits the bark near the collars of children's holes, where it would otherwise end in a step.
  /// The outer side of an inset can be much nearer to the collar than its corners are to each
  /// other.
  void limit_bark() {
    for (size_t f = 0; f < made_.patches.size(); ++f) {
      if (source_.kind[f] != QuadKind::kInset) continue;
      const glm::ivec4& v = made_.patches[f].vertices;
      const vec3 begin = position(v.x);
      const vec3 along = position(v.y) - begin;
      const vec3 unit = along / std::max(glm::length(along), 1e-30f);
      float gap = std::numeric_limits<float>::max();
      for (const int32_t collar : {v.z, v.w}) {
        gap = std::min(gap, glm::length(glm::cross(position(collar) - begin, unit)));
      }
      for (const int32_t outer : {v.x, v.y}) {
        float& bark = made_.vertices[outer].position.w;
        bark = std::min(bark, kBarkSlope * gap);
      }
    }
    bool changed = true;
    for (int round = 0; changed && round < kBarkRounds; ++round) {
      changed = false;
      for (const shared::TreeEdge& edge : made_.edges) {
        vec4& a = made_.vertices[edge.ends.x].position;
        vec4& b = made_.vertices[edge.ends.y].position;
        const float gain = kBarkSlope * glm::distance(vec3(a), vec3(b));
        changed = changed || a.w > b.w + gain || b.w > a.w + gain;
        a.w = std::min(a.w, b.w + gain);
        b.w = std::min(b.w, a.w + gain);
      }
    }
  }

  const TreeSource& source_;
  float bark_depth_;
  TreePatches made_;
};

}  // namespace

TreePatches make_tree_patches(const TreeSource& source, float bark_depth) {
  check(source);
  require_tree(bark_depth >= 0.0f && bark_depth <= 1.0f, "bark_depth must be from 0 to 1");
  return PatchBuilder(source, bark_depth).build();
}

}  // namespace snowbough::render
