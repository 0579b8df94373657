#include "render/tree/snow_pages.h"

#include <algorithm>
#include <glm/vec2.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shaders/lib/map_tiles.h"

namespace snowbough::render {
namespace {

using glm::ivec2;
using glm::ivec4;
using shared::kPageTiles;
using shared::kSnowPage;

int32_t page_count(const ivec4& map) {
  return shared::pages_along(map.x) * shared::pages_along(map.y);
}

}  // namespace

template <typename Work>
void SnowPages::each_page(const ivec4& map, const Work& work) {
  for (int32_t y = 0; y < map.y; y += kSnowPage) {
    for (int32_t x = 0; x < map.x; x += kSnowPage) {
      const int32_t layer = shared::snow_page(ivec2(x, y) / kSnowPage, map);
      const ivec2 size = glm::min(ivec2(map.x - x, map.y - y), ivec2(kSnowPage));
      if (size != ivec2(kSnowPage)) {
        glClearTexSubImage(texture_.id(), 0, 0, 0, layer, kSnowPage, kSnowPage, 1, GL_RED, GL_FLOAT,
                           nullptr);
      }
      work(ivec2(x, y), size, layer);
      new_pages_.insert(layer);
    }
  }
}

void SnowPages::make_layers(int32_t count) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most);
  if (count > most) {
    throw std::runtime_error("the snow maps of the trees need " + std::to_string(count) +
                             " pages of 512 x 512 texels, and this driver has " +
                             std::to_string(most) + ": use smaller maps");
  }
  const int32_t before = texture_.layers();
  if (count <= before) return;
  gpu::Texture larger(GL_R32F, kSnowPage, kSnowPage,
                      std::min(std::max(count, 3 * before / 2), most));
  gpu::Buffer tiles(int64_t{larger.layers()} * kPageTiles * kPageTiles *
                    static_cast<int64_t>(sizeof(float)));
  if (before > 0) {
    glCopyImageSubData(texture_.id(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, larger.id(),
                       GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, kSnowPage, kSnowPage, before);
    glCopyNamedBufferSubData(tile_depths_.id(), tiles.id(), 0, 0, tile_depths_.bytes());
  }
  texture_ = std::move(larger);
  tile_depths_ = std::move(tiles);
}

ivec4 SnowPages::add(int32_t width, int32_t height) {
  ivec4 map(width, height, 0, 0);
  make_layers(std::max(pages_.end(), pages_.place_for(page_count(map)) + page_count(map)));
  map.z = pages_.add(page_count(map));
  return map;
}

void SnowPages::remove(const ivec4& map) {
  pages_.remove(map.z, page_count(map));
}

void SnowPages::write(const ivec4& map, const float* heights) {
  glPixelStorei(GL_UNPACK_ROW_LENGTH, map.x);
  each_page(map, [&](const ivec2& first, const ivec2& size, int32_t layer) {
    glTextureSubImage3D(texture_.id(), 0, 0, 0, layer, size.x, size.y, 1, GL_RED, GL_FLOAT,
                        heights + static_cast<int64_t>(first.y) * map.x + first.x);
  });
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

void SnowPages::copy(const ivec4& map, const gpu::Texture& heights) {
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  each_page(map, [&](const ivec2& first, const ivec2& size, int32_t layer) {
    glCopyImageSubData(heights.id(), GL_TEXTURE_2D, 0, first.x, first.y, 0, texture_.id(),
                       GL_TEXTURE_2D_ARRAY, 0, 0, 0, layer, size.x, size.y, 1);
  });
}

void SnowPages::find_depths() {
  if (new_pages_.empty()) return;
  new_page_buffer_.update(std::vector<int32_t>(new_pages_.begin(), new_pages_.end()));
  tiles_.use();
  tiles_.bind_texture("snow_pages", texture_);
  tiles_.bind("NewPages", new_page_buffer_.buffer());
  tiles_.bind("TileDepths", tile_depths_);
  tiles_.dispatch(kPageTiles, kPageTiles, static_cast<int32_t>(new_pages_.size()));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  new_pages_.clear();
}

}  // namespace snowbough::render
