#include "tree/kept/kept_uvs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "tree/kept/charts.h"
#include "tree/leaves/leaf_uvs.h"
#include "tree/skeleton/centreline.h"
#include "tree/surface/frames.h"

namespace snowbough::tree {
namespace {

/// Thinnest limb, relative to the tree's height, that a turn of the bark is computed for.
constexpr double kThinnest = 1e-4;

/// A branch's centreline with a frame for each segment, and the turns of the bark up to each point.
class BarkAxis {
 public:
  BarkAxis(const Branch& branch, double thinnest) : branch_(branch) {
    turns_.push_back(0.0);
    for (size_t i = 0; i + 1 < branch.points.size(); ++i) {
      const glm::dvec3 along = glm::dvec3(branch.points[i + 1]) - glm::dvec3(branch.points[i]);
      const double length = glm::length(along);
      const glm::dvec3 way = length > 0.0
                                 ? along / length
                                 : (frames_.empty() ? glm::dvec3(0, 0, 1) : frames_.back().normal);
      frames_.push_back(frames_.empty() ? first_frame(way) : transport(frames_.back(), way));
      const double radius =
          std::max(thinnest, 0.5 * static_cast<double>(branch.radii[i] + branch.radii[i + 1]));
      turns_.push_back(turns_.back() + length / (2.0 * M_PI * radius));
    }
    if (frames_.empty()) frames_.push_back(first_frame({0, 0, 1}));
  }

  glm::dvec2 uv(const glm::vec3& point) const {
    const CentrelinePlace place = nearest_place(branch_, point);
    const size_t i = std::min(place.segment, frames_.size() - 1);
    const glm::dvec3 away = glm::dvec3(point) - glm::dvec3(place.point);
    const double angle = std::atan2(glm::dot(away, frames_[i].v), glm::dot(away, frames_[i].u));
    const size_t next = std::min(i + 1, turns_.size() - 1);
    return {angle / (2.0 * M_PI), turns_[i] + place.t * (turns_[next] - turns_[i])};
  }

 private:
  const Branch& branch_;
  std::vector<Frame> frames_;
  std::vector<double> turns_;
};

std::vector<glm::vec2> layout_bark(const Skeleton& skeleton) {
  const KeptSurface& kept = skeleton.kept;
  std::vector<BarkAxis> axes;
  axes.reserve(skeleton.branches.size());
  for (const Branch& branch : skeleton.branches) {
    axes.emplace_back(branch, kThinnest * std::max(static_cast<double>(skeleton.height), 1e-9));
  }
  std::vector<glm::vec2> uvs(kept.corner_vertex.size());
  for (size_t f = 0; f + 1 < kept.face_begin.size(); ++f) {
    const int32_t begin = kept.face_begin[f];
    const BarkAxis& axis = axes[kept.vertex_branch[kept.corner_vertex[begin]]];
    double first = 0.0;
    for (int32_t c = begin; c < kept.face_begin[f + 1]; ++c) {
      glm::dvec2 uv = axis.uv(kept.vertices[kept.corner_vertex[c]]);
      if (c == begin) first = uv.x;
      // A polygon across the seam continues beyond it.
      uv.x -= std::round(uv.x - first);
      uvs[c] = glm::vec2(uv);
    }
  }
  return uvs;
}

}  // namespace

KeptUvs layout_kept_uvs(const Skeleton& skeleton, int resolution,
                        const base::Execution& execution) {
  const KeptSurface& kept = skeleton.kept;
  Foliage charts;
  charts.vertices = kept.vertices;
  charts.face_begin = kept.face_begin;
  charts.corner_vertex = kept.corner_vertex;
  charts.corner_uv = kept.corner_uv;
  charts.face_material = kept.face_material;
  charts.face_leaf = grow_charts(kept);
  LeafUvs layout = layout_leaf_uvs(charts, resolution, execution);
  KeptUvs uvs;
  uvs.snow = std::move(layout.corner_uv);
  uvs.resolution = layout.resolution;
  uvs.chart_count = layout.chart_count;
  uvs.bark = layout_bark(skeleton);
  return uvs;
}

}  // namespace snowbough::tree
