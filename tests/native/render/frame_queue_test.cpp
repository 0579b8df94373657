#include "render/frame_queue.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "gpu/gpu_thread.h"
#include "native/render/gl_calls.h"

namespace snowbough::render {
namespace {

TEST(FrameQueue, onlyOnePumpWaitsAtATime) {
  FrameQueue queue;
  EXPECT_TRUE(queue.claim_pump());
  EXPECT_FALSE(queue.claim_pump());
}

TEST(FrameQueue, anErrorIsReportedOnceAndEndsTheWait) {
  FrameQueue queue;
  queue.request(Camera{}, RenderSettings{});
  EXPECT_TRUE(queue.claim_pump());
  queue.fail(std::make_exception_ptr(std::runtime_error("no context")));
  EXPECT_THROW(queue.take(), std::runtime_error);
  EXPECT_FALSE(queue.take().has_value());
  EXPECT_TRUE(queue.claim_pump());
}

TEST(FrameQueue, theNewestRequestIsDrawnAndArrivesUnderItsTicket) {
  gpu::GpuThread::shared("")->run([] {
    FrameQueue queue;
    FrameReader reader;
    // White light is 255 * (1 / 2)^(1 / 2.2) = 186 of a byte.
    gpu::Texture light(GL_RGBA16F, 2, 1);
    const std::vector<float> texels{1, 1, 1, 1, 0, 0, 0, 1};
    light.write(0, GL_RGBA, GL_FLOAT, texels.data());

    EXPECT_EQ(queue.request(Camera{}, RenderSettings{}), 1u);
    EXPECT_EQ(queue.request(Camera{}, RenderSettings{}), 2u);
    EXPECT_TRUE(queue.is_busy());
    std::vector<uint64_t> drawn;
    const auto draw = [&](const FrameQueue::Request& asked) -> const gpu::Texture& {
      drawn.push_back(asked.ticket);
      return light;
    };
    queue.pump(reader, draw);
    glFinish();
    queue.pump(reader, draw);
    EXPECT_EQ(drawn, std::vector<uint64_t>{2});
    const auto frame = queue.take();
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->ticket, 2u);
    EXPECT_EQ(frame->words, (std::vector<uint32_t>{0x3F000000u + 0xBABABAu, 0x3F000000u}));
    EXPECT_FALSE(queue.is_busy());
    EXPECT_FALSE(queue.take().has_value());
  });
}

TEST(FrameReader, threePicturesAreReadWithoutWaiting) {
  gpu::GpuThread::shared("")->run([] {
    FrameReader reader;
    const gpu::Texture light(GL_RGBA16F, 2, 1);
    for (uint64_t ticket = 1; ticket <= 3; ++ticket) {
      EXPECT_TRUE(reader.has_room());
      reader.begin(light, ticket);  // makes its buffer
    }
    EXPECT_FALSE(reader.has_room());
    EXPECT_THROW(reader.begin(light, 4), std::logic_error);
    glFinish();
    EXPECT_EQ(reader.arrived()->ticket, 3u);
    const GlWatch watch;
    reader.begin(light, 4);
    reader.arrived();
    EXPECT_EQ(watch.seen().waits, 0);
    EXPECT_EQ(watch.seen().read_backs, 0);
  });
}

}  // namespace
}  // namespace snowbough::render
