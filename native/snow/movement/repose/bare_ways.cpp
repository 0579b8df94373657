// The bare surface of a receiver's texels, and the ways down it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/ground.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kNoWay = std::numeric_limits<int32_t>::min();

/// 1 for a texel that faces up, -1 for one whose snow lies on its back.
float side_of(const BareTexels& bare, int32_t texel) {
  return bare.up[static_cast<size_t>(texel)] < 0.0f ? -1.0f : 1.0f;
}

/// Whether a texel is too steep for snow of a side, or faces the other way.
bool is_wall(const BareTexels& bare, int32_t texel, float side) {
  return shared::is_wall(side * bare.up[static_cast<size_t>(texel)]);
}

}  // namespace

const BareTexels& bare_texels(ReposeGround& ground) {
  if (ground.has_bare) return ground.bare;
  ground.has_bare = true;
  const std::vector<int32_t>& places = ground.table().texel;
  const size_t count = places.size();
  if (ground.bare.texel_of.empty()) {
    const auto side = static_cast<size_t>(ground.links->resolution);
    ground.bare.texel_of.assign(side * side, -1);
    for (size_t i = 0; i < count; ++i) {
      ground.bare.texel_of[static_cast<size_t>(places[i])] = static_cast<int32_t>(i);
    }
  }
  for (auto* plane :
       {&ground.bare.x, &ground.bare.y, &ground.bare.z, &ground.bare.up, &ground.bare.area})
    plane->resize(count);
  std::vector<float> rest(2 * count);
  std::vector<uint8_t> two_sided(count);
  const ReposeSurface::Row all{ground.bare.x.data(), ground.bare.y.data(),  ground.bare.z.data(),
                               rest.data(),          ground.bare.up.data(), ground.bare.area.data(),
                               rest.data() + count,  two_sided.data()};
  constexpr size_t kRun = 4096;
  base::for_each_item((count + kRun - 1) / kRun, 1, [&](size_t run) {
    const size_t begin = run * kRun;
    ground.surface.texels(static_cast<int32_t>(begin),
                          static_cast<int32_t>(std::min(kRun, count - begin)), all.at(begin));
  });
  ground.bare.whole_area = std::accumulate(ground.bare.area.begin(), ground.bare.area.end(), 0.0);
  ground.way_end.assign(count, kNoWay);
  ground.way_last.assign(count, 0);
  return ground.bare;
}

int32_t next_down(const ReposeGround& ground, int32_t texel, bool over_walls) {
  const BareTexels& bare = ground.bare;
  const auto own = static_cast<size_t>(texel);
  const float side = side_of(bare, texel);
  if (!over_walls && is_wall(bare, texel, side)) return texel;
  float steepest = 0.0f;
  int32_t next = texel;
  const auto consider = [&](float x, float y, float z, int32_t to) {
    const float way = std::max(std::hypot(x - bare.x[own], y - bare.y[own]), 1e-6f);
    const float slope = (bare.z[own] - z) / way;
    if (!(slope > steepest)) return;
    steepest = slope;
    next = to;
  };
  const auto consider_texel = [&](int32_t to) {
    const auto i = static_cast<size_t>(to);
    consider(bare.x[i], bare.y[i], bare.z[i], to);
  };
  const int32_t place = ground.table().texel[own];
  const int32_t column = place % ground.links->resolution;
  const int32_t row = place / ground.links->resolution;
  for (int32_t k = 0; k < kForwardLinks; ++k) {
    for (const int32_t sign : {1, -1}) {
      const int32_t x = column + sign * kForwardColumn[k];
      const int32_t y = row + sign * kForwardRow[k];
      if (x < 0 || y < 0 || x >= ground.links->resolution || y >= ground.links->resolution)
        continue;
      const int32_t giver =
          sign > 0 ? ground.links->cell_at(column, row) : ground.links->cell_at(x, y);
      if (((ground.links->forward[static_cast<size_t>(giver)] >> k) & 1) == 0) continue;
      const int32_t to = bare.texel_of[static_cast<size_t>(y * ground.links->resolution + x)];
      if (to >= 0) consider_texel(to);
    }
  }
  const int32_t* const ends =
      &ground.links->end_begin[static_cast<size_t>(ground.links->block_of(place))];
  const auto first = ground.links->ends.begin() + ends[0];
  const auto last = ground.links->ends.begin() + ends[1];
  const auto is_before = [](const ReposeLinks::End& end, int32_t t) { return end.texel < t; };
  for (auto end = std::lower_bound(first, last, texel, is_before);
       end != last && end->texel == texel; ++end) {
    const auto link = static_cast<size_t>(end->link);
    if (link >= ground.links->across.size()) {
      const glm::vec3 edge =
          ground.surface.point(ground.links->open_edges[link - ground.links->across.size()].point);
      consider(edge.x, edge.y, edge.z, -1 - end->link);
      continue;
    }
    const ReposeLinks::Across& across = ground.links->across[link];
    const int32_t to = end->sign < 0 ? across.b : across.a;
    if (!over_walls && is_wall(bare, to, side)) {
      const glm::vec3 seam = ground.surface.point(across.seam);
      consider(seam.x, seam.y, seam.z, -1 - end->link);
    } else {
      consider_texel(to);
    }
  }
  return next;
}

Release way_down(ReposeGround& ground, int32_t texel) {
  const BareTexels& bare = bare_texels(ground);
  const float side = side_of(bare, texel);
  std::vector<int32_t> passed;
  int32_t at = texel;
  int32_t end = kNoWay;
  // Each step leads further down, so that the way ends.
  while (end == kNoWay && ground.way_end[static_cast<size_t>(at)] == kNoWay) {
    passed.push_back(at);
    const int32_t next = next_down(ground, at);
    if (next < 0 || next == at) {
      end = next;
    } else {
      at = next;
      if (side_of(bare, at) != side) end = at;
    }
  }
  const bool is_known = end == kNoWay;
  const int32_t found = is_known ? ground.way_end[static_cast<size_t>(at)] : end;
  const int32_t last = is_known ? ground.way_last[static_cast<size_t>(at)] : at;
  for (const int32_t own : passed) {
    ground.way_end[static_cast<size_t>(own)] = found;
    ground.way_last[static_cast<size_t>(own)] = last;
  }
  const auto in_hollow = is_wall(bare, last, side) ? Release::kOffWall : Release::kInHollow;
  return {found < 0 ? -1 - found : in_hollow, last, 0.0};
}

}  // namespace snowbough::snow
