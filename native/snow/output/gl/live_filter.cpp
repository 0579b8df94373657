#include "snow/output/gl/live_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace snowbough::snow {
namespace {

/// Variance of one round in texels^2: twice the weighted squares of the taps in smooth_lines.comp.
constexpr double kRoundVariance =
    2.0 * (0.1945945946 * 1.0 + 0.1216216216 * 4.0 + 0.0540540541 * 9.0 + 0.0162162162 * 16.0);
constexpr int32_t kMaxRounds = 64;
constexpr int32_t kTextureGroup = 16;

/// Mean edge of a texel on the surface, metres.
double texel_edge(const SeamTable& seams) {
  double sum = 0.0;
  for (const float area : seams.texel_area) sum += area;
  return std::sqrt(sum / std::max<double>(static_cast<double>(seams.texel_area.size()), 1.0));
}

int32_t rounds_for(double blur_radius, const SeamTable& seams) {
  const double edge = texel_edge(seams);
  if (!(blur_radius > 0.0) || !(edge > 0.0)) return 0;
  const double texels = blur_radius / edge;
  const double rounds = std::round(texels * texels / kRoundVariance);
  return static_cast<int32_t>(std::clamp(rounds, 1.0, static_cast<double>(kMaxRounds)));
}

}  // namespace

LiveFilter::LiveFilter(std::shared_ptr<gpu::GpuThread> thread, const TexelTable& table,
                       const SeamTable& seams, double blur_radius)
    : buffers_(make_output_buffers(table, seams)),
      rounds_(rounds_for(blur_radius, seams)),
      output_(gpu::share_texture(std::move(thread), gpu::Texture(GL_R32F, table.resolution,
                                                                 table.resolution, 0, GL_LINEAR))) {
}

void LiveFilter::smooth(OutputBuffers::Lines& lines) {
  gather_.use();
  gather_.bind("Texels", buffers_.texel);
  bind_lines(gather_, buffers_);
  gather_.bind("Map", buffers_.map);
  gather_.set("count", buffers_.texel_count);
  gather_.dispatch_items(buffers_.texel_count, kOutputGroup);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  rows_.fill_ghosts(lines);
  smooth_.use();
  smooth_.bind("Texels", buffers_.texel);
  smooth_.bind("Place", lines.place);
  smooth_.bind("Line", lines.line[lines.current]);
  smooth_.bind("Map", buffers_.map);
  smooth_.set("count", buffers_.texel_count);
  smooth_.dispatch_items(buffers_.texel_count, kOutputGroup);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

const gpu::ThreadTexture& LiveFilter::run() {
  for (int32_t round = 0; round < rounds_; ++round) {
    smooth(buffers_.u);
    smooth(buffers_.v);
  }
  rows_.run(buffers_.dilation, buffers_.map, buffers_.map, false);
  const int32_t groups = gpu::group_count(buffers_.resolution, kTextureGroup);
  texture_.use();
  texture_.bind("Map", buffers_.map);
  texture_.bind_image("height_map", *output_.texture, GL_WRITE_ONLY);
  texture_.dispatch(groups, groups);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return output_;
}

}  // namespace snowbough::snow
