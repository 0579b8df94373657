#include "snow/surface/snow_surface.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/parallel_for.h"
#include "snow/surface/map_sampler.h"
#include "snow/surface/vertex_turns.h"

// Evaluates a frame. snow_surface_plan.cpp computes the constants that it reads.

namespace snowbough::snow {
namespace {

using namespace shared;  // NOLINT(google-build-using-namespace): the shared rule's names

/// Points per block. One thread processes a block, and sums over blocks are added in order, so that
/// results do not depend on the number of threads.
constexpr size_t kBlock = 2048;
/// Rounds of smoothing of the heights, before and after thin snow is removed.
constexpr int kRoundsBefore = 5;
constexpr int kRoundsAfter = 2;
/// Bounds of the factor that makes the volume of the shown snow equal to that of the map.
constexpr float kLeastFactor = 0.85f;
constexpr float kMostFactor = 1.25f;
/// Volume of a front, as a fraction of the height behind it times the width of its zone.
constexpr float kUpright = 0.95f;
/// Greatest offset due to a curved receiver, as a fraction of the height.
constexpr float kMostCurvature = 0.5f;

template <typename Work>
void for_blocks(size_t count, const Work& work) {
  base::for_each_item((count + kBlock - 1) / kBlock, 1, [&](size_t block) {
    work(block, block * kBlock, std::min(count, (block + 1) * kBlock));
  });
}

}  // namespace

void SnowSurface::smooth(std::vector<float>& values, int rounds) const {
  std::vector<float> before(values.size());
  for (int round = 0; round < rounds; ++round) {
    before.swap(values);
    for_blocks(values.size(), [&](size_t, size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        float sum = before[p];
        float weights = 1.0f;
        for (int32_t i = neighbour_begin_[p]; i < neighbour_begin_[p + 1]; ++i) {
          sum += neighbour_weight_[i] * before[neighbour_[i]];
          weights += neighbour_weight_[i];
        }
        values[p] = sum / weights;
      }
    });
  }
}

SnowSurface::Heights SnowSurface::heights(const SurfaceFrame& frame,
                                          const std::vector<glm::vec3>& normals) const {
  const size_t count = lying_points();
  const glm::vec3 up = frame.up;
  Heights heights;
  heights.thickness.resize(count);
  for_blocks(count, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      float sum = 0.0f;
      for (int32_t i = sample_begin_[p]; i < sample_begin_[p + 1]; ++i) {
        sum += sample_weight_[i] *
               map_value(frame.height, resolution_, {sample_texel_[i], sample_share_[i]});
      }
      heights.thickness[p] = std::max(sum * side_[p], 0.0f);
    }
  });
  smooth(heights.thickness, kRoundsBefore);
  heights.shown.resize(count);
  for_blocks(count, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const float thickness = heights.thickness[p];
      const SnowEdge edge =
          snow_edge(point_[p], thickness, frame.open_depth, glm::dot(normals[p], up));
      heights.shown[p] = thin_snow(edge, thickness);
    }
  });
  smooth(heights.shown, kRoundsAfter);
  const size_t blocks = (count + kBlock - 1) / kBlock;
  std::vector<glm::dvec2> volumes(blocks, glm::dvec2(0.0));
  for_blocks(count, [&](size_t block, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      if (heights.shown[p] > 0.0f) {
        heights.shown[p] += surface_relief(point_[p], style_, heights.shown[p], frame.open_depth);
      }
      volumes[block] += glm::dvec2(heights.thickness[p], std::max(heights.shown[p], 0.0f)) *
                        static_cast<double>(area_[p]);
    }
  });
  glm::dvec2 volume(0.0);
  for (const glm::dvec2& one : volumes) volume += one;
  // Fronts add volume at the points near rims, because they are upright.
  for (size_t f = 0; f < front_.size(); ++f) {
    if (front_[f].distance < 0.0f) continue;
    const auto p = static_cast<size_t>(front_point_[f]);
    const float inland = inland_height(f, heights.shown);
    const float more = kUpright * inland - std::max(heights.shown[p], 0.0f);
    volume.y += static_cast<double>(area_[p] * presence(f, inland) * more);
  }
  const float factor = volume.y > 0.0 ? std::clamp(static_cast<float>(volume.x / volume.y),
                                                   kLeastFactor, kMostFactor)
                                      : 1.0f;
  for_blocks(count, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      float& shown = heights.shown[p];
      if (shown > 0.0f) shown = swept_height(point_[p], shown * factor);
    }
  });
  return heights;
}

std::vector<glm::vec3> SnowSurface::offsets(const SurfaceFrame& frame,
                                            const std::vector<glm::vec3>& normals,
                                            const Heights& heights) const {
  std::vector<glm::vec3> offsets(lying_points());
  for_blocks(offsets.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const glm::vec3& normal = normal_[p];
      const float up = glm::dot(normals[p], frame.up);
      const float shown = heights.shown[p];
      const SnowEdge edge = snow_edge(point_[p], heights.thickness[p], frame.open_depth, up);
      glm::vec3 offset = normal * shown;
      if (shown > 0.0f) {
        const glm::vec3 down = normal * normal.z - glm::vec3(0.0f, 0.0f, 1.0f);
        const float slope = glm::length(down);
        if (slope > 1e-3f) {
          const float sag = sagging(point_[p], style_, edge, heights.thickness[p], shown, up);
          offset += down * (sag / slope);
        }
        const float bent = glm::length(curvature_[p]);
        if (bent > 0.0f) {
          offset += curvature_[p] * std::min(1.0f, kMostCurvature * shown / bent);
        }
      }
      offsets[p] = offset;
    }
  });
  for_blocks(front_.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const auto p = static_cast<size_t>(front_point_[f]);
      const SnowFront& front = front_[f];
      const float inland = inland_height(f, heights.shown);
      const glm::vec3 drawn =
          front_offset(front, style_, inland * 0.94f, normal_[p], heights.shown[p], point_[p].bumps,
                       std::min(kSink, point_[p].deepest));
      offsets[p] = glm::mix(offsets[p], drawn, presence(f, inland));
    }
  });
  return offsets;
}

std::vector<glm::vec3> SnowSurface::points(const SurfaceFrame& frame) const {
  const size_t lying = lying_points();
  std::vector<glm::vec3> carrier = mesh_.position;
  std::vector<glm::vec3> normals = normal_;
  std::vector<glm::quat> turn;
  if (frame.positions != nullptr) {
    const std::vector<glm::quat> turns =
        vertex_turns(triangles_, planned_positions_, frame.positions);
    turn.resize(lying);
    for_blocks(lying, [&](size_t, size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        const int32_t* corner = &triangles_[static_cast<size_t>(carrier_triangle_[p]) * 3];
        const glm::vec2 weight = carrier_weight_[p];
        const glm::vec3 weights(1.0f - weight.x - weight.y, weight.x, weight.y);
        glm::quat sum(0.0f, 0.0f, 0.0f, 0.0f);
        carrier[p] = glm::vec3(0.0f);
        for (int k = 0; k < 3; ++k) {
          carrier[p] += weights[k] * frame.positions[corner[k]];
          const glm::quat& one = turns[corner[k]];
          sum = sum + one * (glm::dot(one, turns[corner[0]]) < 0.0f ? -weights[k] : weights[k]);
        }
        turn[p] = glm::normalize(sum);
        normals[p] = turn[p] * normal_[p];
      }
    });
  }
  const Heights heights = this->heights(frame, normals);
  const std::vector<glm::vec3> offset = offsets(frame, normals, heights);
  const auto turned = [&](size_t p, const glm::vec3& vector) {
    return turn.empty() ? vector : turn[p] * vector;
  };
  std::vector<glm::vec3> points(point_count());
  for_blocks(lying, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) points[p] = carrier[p] + turned(p, offset[p]);
  });
  // Cushions grow in proportion to the snow at their anchors.
  const float bridging = std::clamp(style_.bridging, 0.0f, 1.0f);
  for_blocks(cushions_.anchor.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      const auto p = static_cast<size_t>(cushions_.anchor[c]);
      const float part = std::clamp(heights.thickness[p] / cushion_height_[c], 0.0f, 1.0f);
      points[lying + c] = points[p] + turned(p, cushions_.offset[c] * (bridging * part));
    }
  });
  for_blocks(points.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      points[p] = glm::vec3(frame.to_result * glm::vec4(points[p], 1.0f));
    }
  });
  return points;
}

std::vector<float> SnowSurface::shown_heights(const SurfaceFrame& frame) const {
  std::vector<float> shown = heights(frame, normal_).shown;
  for (float& height : shown) height = std::max(height, 0.0f);
  return shown;
}

std::vector<glm::vec3> point_normals(const std::vector<glm::vec3>& points,
                                     const std::vector<glm::ivec3>& triangles) {
  const auto count = static_cast<int32_t>(points.size());
  std::vector<glm::vec3> normals(points.size(), glm::vec3(0.0f));
  for (const glm::ivec3& t : triangles) {
    if (std::min({t.x, t.y, t.z}) < 0 || std::max({t.x, t.y, t.z}) >= count) {
      throw std::invalid_argument("each index in triangles must be a row of points");
    }
    const glm::vec3 cross = glm::cross(points[t.y] - points[t.x], points[t.z] - points[t.x]);
    for (int k = 0; k < 3; ++k) normals[t[k]] += cross;
  }
  for (glm::vec3& normal : normals) {
    const float length = glm::length(normal);
    normal = length > 0.0f ? normal / length : glm::vec3(0.0f, 0.0f, 1.0f);
  }
  return normals;
}

}  // namespace snowbough::snow
