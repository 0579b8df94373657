#include <array>
#include <bit>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/passes.h"
#include "snow/step/cpu/run_visibility.h"

namespace snowbough::snow {
namespace kernel {
namespace {

#define WITH_SHADING
struct Gain {
#include "shaders/lib/texel_gain.h"
};

using cpu::FragmentRuns;
using cpu::kMaxInRun;
using Run = FragmentRuns::Run;

/// Values of a run's fragments.
using RunFloats = std::array<float, kMaxInRun>;

/// Sides of a texel that face the fall, as bits.
constexpr uint8_t kPositive = 1;
constexpr uint8_t kBack = 2;
constexpr uint8_t kBoth = kPositive | kBack;

/// Gain of a group's texels.
struct GroupGain {
  std::array<uint, kTexelGroup> gain;
  /// Per texel, only set if any faces the fall with its back.
  std::array<uint8_t, kTexelGroup> sides;
  /// Union over all texels.
  uint8_t some = 0;

  bool is_mixed(size_t texel) const { return some == kBoth && sides[texel] == kBoth; }
};

/// Gathers the deposit of a group of texels in a tile.
class GroupGather {
 public:
  GroupGather(const Gain& gain, const FragmentRuns& all, const Tile& tile, int32_t map_offset)
      : gain_(gain), all_(all), tile_(tile), map_offset_(map_offset) {}

  void run(size_t group, size_t texel_count, bool adds_to_gain, uint* gain) {
    const Run* begin = all_.runs.data() + all_.group_begin[group];
    const Run* end = all_.runs.data() + all_.group_begin[group + 1];
    find_sides(begin, end, texel_count);
    for (size_t i = 0; i < texel_count; ++i) {
      sums_.gain[i] = adds_to_gain ? gain[i] & ~(kBackSide | kMixedSides) : 0u;
    }
    for (const Run* run = begin; run < end; ++run) {
      const vec4 surface = texelFetch(gain_.triangle_surface, static_cast<int>(run->triangle));
      if (surface.x > 0.0f && surface.y > 0.0f) gather(*run, run[1].begin - run->begin, surface);
    }
    for (size_t i = 0; i < texel_count; ++i) {
      const bool back = sums_.some >= kBack && (sums_.sides[i] & kBack) != 0;
      gain[i] = sums_.gain[i] | gain_.gain_sides(sums_.is_mixed(i), back);
    }
  }

 private:
  void find_sides(const Run* begin, const Run* end, size_t texel_count) {
    sums_.some = 0;
    for (const Run* run = begin; run < end; ++run) sums_.some |= side_of(run->triangle);
    if (sums_.some < kBack) return;
    std::fill_n(sums_.sides.begin(), texel_count, uint8_t{0});
    for (const Run* run = begin; run < end; ++run) {
      const uint8_t side = side_of(run->triangle);
      for (uint32_t f = run->begin; side != 0 && f < run[1].begin; ++f) {
        sums_.sides[all_.texel[f]] |= side;
      }
    }
  }

  uint8_t side_of(uint32_t triangle) const {
    const vec4 surface = texelFetch(gain_.triangle_surface, static_cast<int>(triangle));
    return !(surface.x > 0.0f) ? 0 : surface.w < 0.0f ? kBack : kPositive;
  }

  void gather(const Run& run, uint32_t count, vec4 surface) {
    if (run.triangle != triangle_) {
      triangle_ = run.triangle;
      own_ = gain_.gain_triangle(static_cast<int>(triangle_),
                                 static_cast<int>(triangle_) + map_offset_);
      find_reach();
    }
    const cpu::RunVisibility visibility = visibility_of_run(run);
    if (visibility == cpu::RunVisibility::kHidden || visibility == cpu::RunVisibility::kElsewhere)
      return;
    find_most(run, count, surface);
    if (visibility == cpu::RunVisibility::kOpen) {
      has_one_cell_ ? add_open(run, count) : add_open_cells(run, count);
    } else if (visibility == cpu::RunVisibility::kMixed && has_one_cell_) {
      add_seen_points(run, count);
    } else {
      add_seen(run, count);
    }
  }

  /// Maximum distance of samples from their fragment's centroid, in weights.
  void find_reach() {
    const vec2 extent_u = gain_.extent_of(own_, own_.along_u);
    const vec2 extent_v = gain_.extent_of(own_, own_.along_v);
    const float longest =
        max(max(abs(extent_u.x), abs(extent_u.y)), max(abs(extent_v.x), abs(extent_v.y)));
    // Slightly less, so that no smaller fragment rounds up to two.
    has_one_cell_ = longest <= 0.999f * Gain::kCellPixels;
    reach_ = has_one_cell_ ? vec2(0.0f) : 0.5f * (abs(own_.along_u) + abs(own_.along_v));
  }

  cpu::RunVisibility visibility_of_run(const Run& run) const {
    if (noise_density(gain_.projection) < 1.0f) return cpu::RunVisibility::kUnknown;
    cpu::RunPlane plane{
        own_.corner,   own_.edge_b,     own_.edge_c,
        own_.gradient, own_.depth_bias, own_.depth_bias + Gain::kBend * own_.pixel_depth,
        run.least_b,   run.most_b,      run.least_c,
        run.most_c,    run.least_sum,   run.most_sum};
    if (!has_one_cell_) {
      // Points outside the triangle are clamped to its rim: see point_on.
      const float sum = reach_.x + reach_.y;
      const float least = 1.0f / max(run.most_sum + sum, 1.0f);
      plane.least_b = max(run.least_b - reach_.x, 0.0f) * least;
      plane.least_c = max(run.least_c - reach_.y, 0.0f) * least;
      plane.least_sum = min(run.least_sum - sum, 1.0f);
      plane.most_b = run.most_b + reach_.x;
      plane.most_c = run.most_c + reach_.y;
      plane.most_sum = min(run.most_sum + sum, 1.0f);
    }
    return cpu::visibility_of(plane, tile_, seen());
  }

  const SeenPixel* seen() const { return reinterpret_cast<const SeenPixel*>(gain_.occlusion); }

  /// Computes the fragments' gains under open sky.
  void find_most(const Run& run, uint32_t count, vec4 surface) {
    const float* __restrict part = all_.part.data() + run.begin;
    float* __restrict most = most_.data();
    const uint32_t end = cpu::whole_lanes(count);
    if (gain_.is_smooth(run.triangle)) {
      const Gain::SmoothTriangle points = gain_.smooth_triangle(run.triangle);
      const float* __restrict weight_b = all_.weight_b.data() + run.begin;
      const float* __restrict weight_c = all_.weight_c.data() + run.begin;
      Gain gain = gain_;
      for (uint32_t k = 0; k < end; ++k) {
        const float b = weight_b[k];
        const float c = weight_c[k];
        const float positive =
            gain.between(points.corner.x, points.edge_b.x, points.edge_c.x, b, c);
        const float back = gain.between(points.corner.y, points.edge_b.y, points.edge_c.y, b, c);
        most[k] = gain.smooth_facing(positive, back, surface) * part[k];
      }
    } else {
      for (uint32_t k = 0; k < end; ++k) most[k] = surface.x * part[k];
    }
    if (sums_.some != kBoth) {
      for (uint32_t k = 0; k < end; ++k) most[k] *= gain_.gain_units(false);
      return;
    }
    const uint16_t* texel = all_.texel.data() + run.begin;
    for (uint32_t k = 0; k < count; ++k) most[k] *= gain_.gain_units(sums_.is_mixed(texel[k]));
  }

  void add(size_t texel, uint gained) {
    sums_.gain[texel] += gained << gain_.gain_shift(sums_.is_mixed(texel), own_.side != 0);
  }

  /// Adds the gains of the run's fragments.
  void add_gained(const Run& run, uint32_t count) {
    const uint16_t* const texel = all_.texel.data() + run.begin;
    if (sums_.some == kBoth) {
      for (uint32_t k = 0; k < count; ++k) add(texel[k], gained_[k]);
      return;
    }
    for (uint32_t k = 0; k < count; ++k) sums_.gain[texel[k]] += gained_[k];
  }

  void add_open(const Run& run, uint32_t count) {
    const uint32_t end = cpu::whole_lanes(count);
    for (uint32_t k = 0; k < end; ++k) {
      gained_[k] = static_cast<uint>(static_cast<int>(most_[k] + 0.5f));
    }
    add_gained(run, count);
  }

  void add_open_cells(const Run& run, uint32_t count) {
    for (uint32_t k = 0; k < count; ++k) {
      const Gain::FragmentCells cells = gain_.fragment_cells(own_, all_.share[run.begin + k]);
      const auto in_cell = static_cast<uint>(most_[k] * cells.part + 0.5f);
      add(all_.texel[run.begin + k], in_cell * static_cast<uint>(cells.along_u * cells.along_v));
    }
  }

  void add_seen(const Run& run, uint32_t count) {
    for (uint32_t k = 0; k < count; ++k) {
      const uint32_t f = run.begin + k;
      if (most_[k] > 0.0f) {
        add(all_.texel[f],
            gain_.fragment_gain(run.triangle, all_.share[f],
                                vec2(all_.weight_b[f], all_.weight_c[f]), own_, most_[k]));
      }
    }
  }

  /// The same for fragments with one sample each, vectorised.
  void add_seen_points(const Run& run, uint32_t count) {
    const uint32_t end = cpu::whole_lanes(count);
    find_windows(run, end);
    // Lanes behind the run's end belong to other triangles, maybe in other tiles.
    std::fill(pixel_.begin() + count, pixel_.begin() + end, pixel_[0]);
    find_clearance(end);
    const float depth_bias = own_.depth_bias;
    for (uint32_t k = 0; k < end; ++k) {
      const auto all = static_cast<uint>(static_cast<int>(most_[k] + 0.5f));
      gained_[k] = clearance_[k] >= -depth_bias ? all : 0u;
    }
    uint32_t others = 0;
    for (uint32_t k = 0; k < count; ++k) {
      others_[others] = k;
      others += int{!(clearance_[k] >= -depth_bias)} & int{most_[k] > 0.0f};
    }
    if (others > 0) find_partly_seen(run, others);
    add_gained(run, count);
  }

  /// Finds the pixels around the fragments' centroids; all of them are in the tile.
  void find_windows(const Run& run, uint32_t end) {
    const Gain::GainTriangle own = own_;
    const float* __restrict weight_b = all_.weight_b.data() + run.begin;
    const float* __restrict weight_c = all_.weight_c.data() + run.begin;
    float* __restrict plane_depth = plane_depth_.data();
    int* __restrict pixel = pixel_.data();
    Gain gain = gain_;
    for (uint32_t k = 0; k < end; ++k) {
      const vec3 at = gain.point_on(own, vec2(weight_b[k], weight_c[k]));
      const Gain::PixelWindow window = gain.window_of(at, own.gradient);
      plane_depth[k] = window.plane_depth;
      pixel[k] = gain.pixel_index(window.pixel);
    }
  }

  void find_clearance(uint32_t end) {
    const int* __restrict pixel = pixel_.data();
    const float* __restrict plane_depth = plane_depth_.data();
    float* __restrict clearance = clearance_.data();
    const vec2 gradient = own_.gradient;
    Gain gain = gain_;
    for (uint32_t k = 0; k < end; ++k) {
      clearance[k] = gain.clearance(pixel[k], plane_depth[k], gradient);
    }
  }

  /// Computes the gains of the fragments in `others_`, which do not see all of the sky.
  void find_partly_seen(const Run& run, uint32_t count) {
    const uint32_t end = cpu::whole_lanes(count);
    std::fill(others_.begin() + count, others_.begin() + end, others_[0]);
    for (uint32_t k = 0; k < end; ++k) {
      const uint32_t f = run.begin + others_[k];
      other_b_[k] = all_.weight_b[f];
      other_c_[k] = all_.weight_c[f];
      other_share_[k] = all_.share[f];
      seen_[k] = 0.0f;
    }
    find_points(end);
    for (int i = 0; i < 4; ++i) look_at_pixel(run.triangle, i & 1, i >> 1, end);
    for (uint32_t k = 0; k < count; ++k) {
      gained_[others_[k]] =
          static_cast<uint>(static_cast<int>(most_[others_[k]] * seen_[k] + 0.5f));
    }
  }

  /// Finds the pixels and windows of those fragments.
  void find_points(uint32_t end) {
    const Gain::GainTriangle own = own_;
    const float* __restrict weight_b = other_b_.data();
    const float* __restrict weight_c = other_c_.data();
    const float* __restrict share = other_share_.data();
    Points& points = points_;
    Gain gain = gain_;
    for (uint32_t k = 0; k < end; ++k) {
      const vec3 at = gain.point_on(own, vec2(weight_b[k], weight_c[k]));
      const Gain::PixelWindow window = gain.window_of(at, own.gradient);
      const float side = gain.fragment_side(own, share[k]);
      const vec2 windows = gain.windows_of(gain.extent_of(own, own.along_u * side),
                                           gain.extent_of(own, own.along_v * side));
      const vec2 reach = gain.reach_of(window.offset, windows);
      points.x[k] = at.x;
      points.y[k] = at.y;
      points.depth[k] = at.z;
      points.pixel_x[k] = window.pixel.x;
      points.pixel_y[k] = window.pixel.y;
      points.plane_depth[k] = window.plane_depth;
      points.reach_x[k] = reach.x;
      points.reach_y[k] = reach.y;
    }
  }

  /// Adds one pixel of their windows to their visibility.
  void look_at_pixel(uint32_t triangle, int x, int y, uint32_t end) {
    const Gain::GainTriangle own = own_;
    float* __restrict seen = seen_.data();
    const Points& points = points_;
    Gain gain = gain_;
    for (uint32_t k = 0; k < end; ++k) {
      const vec3 at(points.x[k], points.y[k], points.depth[k]);
      Gain::PixelWindow window;
      window.pixel = ivec2(points.pixel_x[k], points.pixel_y[k]);
      window.plane_depth = points.plane_depth[k];
      const float part = gain.window_part(vec2(points.reach_x[k], points.reach_y[k]), x, y);
      const bool is_open = gain.is_open_in(window, x, y, gain.plane_point(triangle, own, at));
      seen[k] += part > 0.0f && is_open ? part : 0.0f;
    }
  }

  Gain gain_;
  const FragmentRuns& all_;
  const Tile& tile_;
  int32_t map_offset_;
  GroupGain sums_;
  /// The current triangle, and whether all of its fragments have one sample.
  uint triangle_ = kNowhere;
  Gain::GainTriangle own_{};
  bool has_one_cell_ = true;
  vec2 reach_{0.0f};
  RunFloats most_;
  RunFloats plane_depth_;
  std::array<int, kMaxInRun> pixel_;
  RunFloats clearance_;
  std::array<uint, kMaxInRun> gained_;
  RunFloats seen_;
  /// Fragments of the run that may see only a part of the sky.
  std::array<uint32_t, kMaxInRun + 1> others_;
  RunFloats other_b_;
  RunFloats other_c_;
  RunFloats other_share_;
  struct Points {
    RunFloats x, y, depth, plane_depth, reach_x, reach_y;
    std::array<int, kMaxInRun> pixel_x, pixel_y;
  } points_;
};

SNOWBOUGH_KERNEL void gather(const Gain& gain, const FragmentRuns& all, const Tile& tile,
                             int32_t map_offset, size_t group, size_t texel_count,
                             bool adds_to_gain, uint* gained) {
  GroupGather(gain, all, tile, map_offset).run(group, texel_count, adds_to_gain, gained);
}

}  // namespace
}  // namespace kernel

namespace cpu {
namespace {

/// By slot: whether a receiver may have samples in a tile.
std::vector<uint8_t> shown_in(const Scene& scene, const Tile& tile) {
  std::vector<uint8_t> shown;
  for (const Receiver& receiver : scene.receivers) {
    const PixelRect own = pixels_of(receiver.bounds, scene.frame);
    const PixelRect& all = tile.pixels;
    const bool meets = own.low.x < all.high.x && all.low.x < own.high.x && own.low.y < all.high.y &&
                       all.low.y < own.high.y;
    shown.push_back(meets || receiver.bounds.empty() ? 1 : 0);
  }
  return shown;
}

}  // namespace
}  // namespace cpu

cpu::GroupWork cpu::deposit_work(Scene& scene, const Tile& tile, bool is_first) {
  for (Receiver& receiver : scene.receivers) {
    receiver.has_gain = receiver.has_gain && !is_first;
  }
  kernel::Gain gain{};
  gain.projection = scene.frame;
  gain.triangle_corners = scene.corners.data();
  gain.triangle_surface = scene.surface.data();
  if (scene.layout.smooth_points.count() > 0) {
    gain.triangle_points = scene.layout.smooth_points.of_triangle.data();
    gain.smooth_points = scene.smooth_points.data();
  }
  gain.triangle_sheets = kernel::words(scene.layout.triangle_sheets);
  gain.map_triangles = kernel::rows<glm::vec4>(scene.layout.map_triangles);
  gain.occlusion = kernel::rows<glm::uvec2>(scene.seen);
  gain.tile_origin = tile.with_margin().low;
  gain.tile_size = tile.with_margin().size();
  return [&scene, tile, gain, shown = shown_in(scene, tile)](Receiver& receiver, size_t group) {
    if (receiver.has_gain && shown[receiver.slot] == 0) return;
    const size_t first = receiver.first_texel(group);
    evaluate_group(scene, receiver, group);
    kernel::Gain own = gain;
    own.resolution = static_cast<float>(receiver.resolution);
    kernel::gather(own, receiver.fragments, tile, receiver.map_offset, group,
                   receiver.first_texel(group + 1) - first, receiver.has_gain,
                   receiver.steps.gain.data() + first);
  };
}

void cpu::gather_deposit(Scene& scene, const Tile& tile, bool is_first) {
  const GroupWork work = deposit_work(scene, tile, is_first);
  const std::vector<uint8_t> shown = shown_in(scene, tile);
  for_active_groups(scene, [&](Receiver& receiver, size_t number) {
    if (shown[receiver.slot] != 0) work(receiver, receiver.active[number]);
  });
  for (Receiver& receiver : scene.receivers) {
    receiver.has_gain = receiver.has_gain || shown[receiver.slot] != 0;
  }
}

}  // namespace snowbough::snow
