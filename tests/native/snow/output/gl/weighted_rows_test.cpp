#include "snow/output/gl/weighted_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "gpu/gpu_thread.h"

namespace snowbough::snow {
namespace {

TEST(WeightedRowsPass, writesSumsAndWhatHasNoTerms) {
  gpu::GpuThread::shared()->run([] {
    RowBuffers rows;
    rows.count = 3;
    rows.begin = gpu::Buffer(std::vector<int32_t>{0, 2, 2, 3});
    rows.source = gpu::Buffer(std::vector<int32_t>{0, 2, 1});
    rows.weight = gpu::Buffer(std::vector<float>{0.5f, 2.0f, 3.0f});
    rows.target = gpu::Buffer(std::vector<int32_t>{4, 5, 3});
    const gpu::Buffer values(std::vector<float>{1.0f, 10.0f, 100.0f, 7.0f, 7.0f, 7.0f});
    WeightedRowsPass pass;
    pass.run(rows, values, values, true);
    EXPECT_THAT(values.read_all<float>(),
                testing::ElementsAre(1.0f, 10.0f, 100.0f, 30.0f, 200.5f, kNothing));
    pass.run(rows, values, values, false);
    EXPECT_EQ(values.read_all<float>().back(), 0.0f);
  });
}

}  // namespace
}  // namespace snowbough::snow
