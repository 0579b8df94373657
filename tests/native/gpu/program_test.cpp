#include "gpu/program.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "gpu/gpu_thread.h"
#include "gpu/resources.h"
#include "native/gpu/weighted_rows.h"

namespace snowbough::gpu {
namespace {

TEST(Program, DispatchItemsReachesEveryItemInRowsOfGroups) {
  GpuThread::shared()->run([] {
    // Row r takes value r to place r; 1000 rows in groups of 64, at most 3 groups side by side.
    constexpr int32_t kCount = 1000;
    std::vector<int32_t> begin(kCount + 1), place(kCount);
    std::iota(begin.begin(), begin.end(), 0);
    std::iota(place.begin(), place.end(), 0);
    std::vector<float> values(kCount);
    std::iota(values.begin(), values.end(), 1.0f);
    Program rows({"weighted_rows.comp.glsl"});
    const Buffer begins(begin), places(place), weights(std::vector<float>(kCount, 1.0f));
    const Buffer source(values);
    Buffer target(int64_t{4} * kCount);
    use_for(rows, {begins, places, weights, places, source, target}, kCount);
    rows.dispatch_items(kCount, 64, 3);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    EXPECT_EQ(target.read_all<float>(), values);
  });
}

}  // namespace
}  // namespace snowbough::gpu
