#include "snow/output/gl/smoothing_pass.h"

namespace snowbough::snow {
namespace {

/// What smoothing.comp.glsl filters along.
constexpr int32_t kAlongU = 1;
constexpr int32_t kAlongV = 2;

}  // namespace

void SmoothingPass::filter(OutputBuffers& buffers, int32_t axes, bool last) {
  OutputBuffers::Lines& u = buffers.u;
  OutputBuffers::Lines& v = buffers.v;
  if ((axes & kAlongU) != 0) rows_.fill_ghosts(u);
  if ((axes & kAlongV) != 0) rows_.fill_ghosts(v);
  smoothing_.use();
  smoothing_.bind("LevelWeights", buffers.filter_levels);
  smoothing_.bind("Levels", buffers.level);
  smoothing_.bind("Texels", buffers.texel);
  bind_lines(smoothing_, buffers);
  smoothing_.bind("NextU", u.line[1 - u.current]);
  smoothing_.bind("NextV", v.line[1 - v.current]);
  smoothing_.bind("Map", buffers.map);
  smoothing_.set("count", buffers.texel_count);
  smoothing_.set("axes", axes);
  smoothing_.set("last", last ? 1 : 0);
  smoothing_.dispatch_items(buffers.texel_count, kOutputGroup);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  u.current = 1 - u.current;
  v.current = 1 - v.current;
}

void SmoothingPass::run(const gpu::Texture& height_maps, int32_t layer, OutputBuffers& buffers) {
  gather_.use();
  gather_.bind_texture("height_maps", height_maps);
  gather_.bind("Texels", buffers.texel);
  bind_lines(gather_, buffers);
  gather_.bind("Map", buffers.map);
  gather_.set("layer", layer);
  gather_.set("count", buffers.texel_count);
  gather_.dispatch_items(buffers.texel_count, kOutputGroup);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);

  for (int32_t pass = 0; pass < buffers.passes; ++pass) {
    filter(buffers, kAlongU, false);
    filter(buffers, kAlongV, false);
  }
  for (int32_t pass = 0; pass < buffers.closing_passes; ++pass) {
    filter(buffers, kAlongU | kAlongV, pass + 1 == buffers.closing_passes);
  }
  rows_.run(buffers.dilation, buffers.map, buffers.map, false);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace snowbough::snow
