#pragma once

#include <cstdint>
#include <glm/vec4.hpp>
#include <set>

#include "gpu/program.h"
#include "gpu/resources.h"
#include "render/draw/arena.h"
#include "render/draw/cached_buffer.h"

namespace snowbough::render {

/// The snow maps of all trees: pages of kSnowPage x kSnowPage texels in one array texture (R32F,
/// metres), and the deepest snow of each page's tiles. So trees with maps of any size are drawn
/// together. GPU thread.
class SnowPages {
 public:
  /// Pages for a map, as shaders/lib/map_tiles.h counts them. @throws std::runtime_error if the
  /// driver's array textures have too few layers.
  glm::ivec4 add(int32_t width, int32_t height);
  void remove(const glm::ivec4& map);
  /// Sets a map's heights: width x height, row 0 at v = 0.
  void write(const glm::ivec4& map, const float* heights);
  void copy(const glm::ivec4& map, const gpu::Texture& heights);
  /// Computes the tiles of the pages that have changed since the last call.
  void find_depths();

  const gpu::Texture& texture() const { return texture_; }
  /// One float per tile.
  const gpu::Buffer& tile_depths() const { return tile_depths_; }

 private:
  /// Calls work(first texel, size, layer) for each page of a map, and clears incomplete pages.
  template <typename Work>
  void each_page(const glm::ivec4& map, const Work& work);
  void make_layers(int32_t count);

  Ranges pages_;
  gpu::Texture texture_;
  gpu::Buffer tile_depths_{0};
  std::set<int32_t> new_pages_;
  CachedBuffer<int32_t> new_page_buffer_;
  gpu::Program tiles_{{"map_tiles.comp.glsl"}};
};

}  // namespace snowbough::render
