#include "render/draw/image_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace snowbough::render {
namespace {

void check(const Image& image, const char* what) {
  if (image.rgba.empty()) return;
  if (image.width <= 0 || image.height <= 0 ||
      image.rgba.size() != static_cast<size_t>(image.width) * image.height * 4) {
    throw std::invalid_argument(std::string(what) +
                                ": an image must have height x width x 4 bytes");
  }
}

void repeat(const gpu::Texture& texture) {
  glTextureParameteri(texture.id(), GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTextureParameteri(texture.id(), GL_TEXTURE_WRAP_T, GL_REPEAT);
}

/// Decodes an sRGB value to linear light (IEC 61966-2-1).
float decoded(float c) {
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}
float encoded(float c) {
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
}

/// Table from each byte of an sRGB channel to the byte whose light is multiplied by `factor`.
std::array<uint8_t, 256> multiplied(float factor) {
  std::array<uint8_t, 256> bytes{};
  for (size_t i = 0; i < bytes.size(); ++i) {
    const float light = decoded(static_cast<float>(i) / 255.0f) * factor;
    const float byte = 255.0f * encoded(std::clamp(light, 0.0f, 1.0f));
    bytes[i] = static_cast<uint8_t>(std::lround(byte));
  }
  return bytes;
}

/// A material's image resampled to another size and multiplied by the material's colour.
std::vector<uint8_t> layer_of(const Material& material, int32_t width, int32_t height) {
  std::vector<uint8_t> made(static_cast<size_t>(width) * height * 4, 255);
  const Image& image = material.image;
  for (int c = 0; c < 3; ++c) {
    const std::array<uint8_t, 256> bytes = multiplied(material.color[c]);
    for (int32_t y = 0; y < height; ++y) {
      for (int32_t x = 0; x < width; ++x) {
        uint8_t texel = 255;
        if (!image.rgba.empty()) {
          const size_t row = static_cast<size_t>(y) * image.height / height;
          const size_t column = static_cast<size_t>(x) * image.width / width;
          texel = image.rgba[4 * (row * image.width + column) + c];
        }
        made[4 * (static_cast<size_t>(y) * width + x) + c] = bytes[texel];
      }
    }
  }
  return made;
}

}  // namespace

gpu::Texture image_texture(const Image& image, const char* what) {
  check(image, what);
  const bool empty = image.rgba.empty();
  const std::vector<uint8_t> white(4, 255);
  gpu::Texture texture(GL_SRGB8_ALPHA8, empty ? 1 : image.width, empty ? 1 : image.height, 0,
                       GL_LINEAR);
  texture.write(0, GL_RGBA, GL_UNSIGNED_BYTE, empty ? white.data() : image.rgba.data());
  repeat(texture);
  return texture;
}

gpu::Texture material_layers(const std::vector<Material>& materials, const char* what) {
  int32_t width = 1, height = 1;
  for (const Material& material : materials) {
    check(material.image, what);
    width = std::max(width, material.image.width);
    height = std::max(height, material.image.height);
  }
  gpu::Texture layers(GL_SRGB8_ALPHA8, width, height, static_cast<int32_t>(materials.size()),
                      GL_LINEAR, gpu::all_mip_levels(width, height));
  for (size_t m = 0; m < materials.size(); ++m) {
    const std::vector<uint8_t> texels = layer_of(materials[m], width, height);
    layers.write(static_cast<int32_t>(m), GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  }
  glGenerateTextureMipmap(layers.id());
  glTextureParameteri(layers.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  repeat(layers);
  return layers;
}

}  // namespace snowbough::render
