#include "render/tree/bark_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "gpu/gpu_thread.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec4;

/// Two quads of two materials.
BarkSource two_quads() {
  BarkSource source;
  source.uv = {{vec2(0, 0), vec2(1, 0), vec2(1, 2), vec2(0, 2)},
               {vec2(3, 4), vec2(5, 6), vec2(7, 8), vec2(9, 10)}};
  source.material = {1, 0};
  source.materials = {{glm::vec3(1.0f, 0.0f, 0.0f), {}}, {glm::vec3(0.0f, 1.0f, 0.0f), {}}};
  return source;
}

template <typename Work>
void on_gpu(const Work& work) {
  gpu::GpuThread::shared("")->run(work);
}

TEST(BarkImages, aPatchHasItsCornersAndItsLayer) {
  on_gpu([] {
    const BarkImages images(two_quads(), 2);
    const auto places = images.places.read_all<shared::BarkPlace>();
    ASSERT_EQ(places.size(), 2u);
    EXPECT_EQ(places[1].uv_01, vec4(3, 4, 5, 6));
    EXPECT_EQ(places[1].uv_23, vec4(7, 8, 9, 10));
    EXPECT_EQ(places[0].layer.x, 1.0f);
    EXPECT_EQ(places[1].layer.x, 0.0f);
    EXPECT_EQ(images.layers.layers(), 2);
  });
}

TEST(BarkImages, whatDoesNotFitTheTreeIsRefused) {
  on_gpu([] {
    const auto says = [](const BarkSource& source, size_t patches, const char* what) {
      EXPECT_THAT([&] { BarkImages(source, patches); },
                  testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr(what)));
    };
    says(two_quads(), 3, "the tree's 3 quads");
    BarkSource lost = two_quads();
    lost.material[1] = 2;
    says(lost, 2, "material index 2 of quad 1 must be at least 0 and below 2");
    BarkSource bare = two_quads();
    bare.materials.clear();
    says(bare, 2, "needs at least one material");
  });
}

}  // namespace
}  // namespace snowbough::render
