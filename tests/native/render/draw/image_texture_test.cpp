#include "render/draw/image_texture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "gpu/gpu_thread.h"

namespace snowbough::render {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes texels_of(const gpu::Texture& texture, int32_t layer = 0) {
  Bytes bytes(static_cast<size_t>(texture.width()) * texture.height() * 4);
  texture.read(layer, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<int64_t>(bytes.size()), bytes.data());
  return bytes;
}

const Image kTwoTexels{2, 1, {10, 20, 30, 40, 50, 60, 70, 80}};

template <typename Work>
void on_gpu(const Work& work) {
  gpu::GpuThread::shared("")->run(work);
}

TEST(ImageTexture, bytesComeBackAsTheyAre) {
  on_gpu([] {
    const gpu::Texture texture = image_texture(kTwoTexels, "it");
    EXPECT_EQ(texture.width(), 2);
    EXPECT_EQ(texels_of(texture), kTwoTexels.rgba);
    EXPECT_EQ(texture.format(), static_cast<GLenum>(GL_SRGB8_ALPHA8));
  });
}

TEST(ImageTexture, noImageIsAWhiteTexel) {
  on_gpu([] { EXPECT_EQ(texels_of(image_texture({}, "it")), Bytes(4, 255)); });
}

TEST(ImageTexture, bytesThatDoNotFitTheSizeAreRefusedByName) {
  on_gpu([] {
    const Image torn{2, 2, Bytes(4 * 3, 0)};
    EXPECT_THAT([&] { image_texture(torn, "the bark"); },
                testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("the bark")));
    EXPECT_THROW(material_layers({{glm::vec3(1.0f), torn}}, "it"), std::invalid_argument);
  });
}

TEST(MaterialLayers, smallerImagesAreRepeatedTexelByTexel) {
  on_gpu([] {
    const Image large{4, 1, Bytes(16, 200)};
    const gpu::Texture layers =
        material_layers({{glm::vec3(1.0f), large}, {glm::vec3(1.0f), kTwoTexels}}, "it");
    EXPECT_EQ(layers.layers(), 2);
    EXPECT_EQ(layers.width(), 4);
    EXPECT_EQ(texels_of(layers, 1),
              (Bytes{10, 20, 30, 255, 10, 20, 30, 255, 50, 60, 70, 255, 50, 60, 70, 255}));
  });
}

TEST(MaterialLayers, coloursMultiplyLightNotBytes) {
  on_gpu([] {
    // Half the light of white is 188 in sRGB, a quarter is 137.
    const gpu::Texture layers = material_layers(
        {{glm::vec3(0.5f, 1.0f, 0.0f), {}}, {glm::vec3(0.5f), {1, 1, {188, 188, 188, 255}}}}, "it");
    EXPECT_EQ(texels_of(layers, 0), (Bytes{188, 255, 0, 255}));
    EXPECT_EQ(texels_of(layers, 1), (Bytes{137, 137, 137, 255}));
  });
}

}  // namespace
}  // namespace snowbough::render
