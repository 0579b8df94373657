#include "base/parallel_for.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>

namespace snowbough::base {
namespace {

TEST(Parallel, EveryBlockIsDoneOnce) {
  for (const int threads : {0, 1, 3, 100}) {
    for (const size_t count : {size_t{0}, size_t{1}, size_t{10}, size_t{101}}) {
      std::vector<int> times(count, 0);
      parallel_for(count, 10, {threads, {}}, [&](size_t begin, size_t end) {
        EXPECT_LE(end - begin, 10u);
        for (size_t i = begin; i < end; ++i) {
          ++times[i];
        }
      });
      EXPECT_THAT(times, testing::Each(1));
    }
  }
}

TEST(Parallel, TheFirstBlockThatFailsIsReported) {
  for (const int threads : {1, 4}) {
    try {
      parallel_for(1000, 1, {threads, {}}, [](size_t begin, size_t) {
        if (begin >= 5) {
          throw std::invalid_argument(std::to_string(begin));
        }
      });
      FAIL() << "nothing was thrown";
    } catch (const std::invalid_argument& error) {
      EXPECT_STREQ(error.what(), "5");
    }
  }
}

TEST(Parallel, StopsWhenProgressSaysSo) {
  std::atomic<int> done{0};
  const Execution stop{1, [](float share) { return share < 0.25f; }};
  EXPECT_THROW(parallel_for(100, 1, stop, [&](size_t, size_t) { ++done; }), Cancelled);
  EXPECT_EQ(done, 25);
}

TEST(Parallel, ProgressIsReportedFromTheCallingThread) {
  const std::thread::id self = std::this_thread::get_id();
  int calls = 0;
  const Execution execution{4, [&](float share) {
                              ++calls;
                              EXPECT_EQ(std::this_thread::get_id(), self);
                              EXPECT_TRUE(share >= 0.0f && share <= 1.0f);
                              return true;
                            }};
  parallel_for(1000, 1, execution, [](size_t, size_t) { std::this_thread::yield(); });
  EXPECT_GT(calls, 0);
}

TEST(Parallel, APartOfTheProgressCoversItsOwnRange) {
  std::vector<float> shares;
  const Execution whole{0, [&](float share) {
                          shares.push_back(share);
                          return true;
                        }};
  report_progress(whole.part(0.5f, 0.75f).progress, 0.0f);
  report_progress(whole.part(0.5f, 0.75f).progress, 1.0f);
  EXPECT_THAT(shares, testing::ElementsAre(0.5f, 0.75f));
  EXPECT_FALSE(Execution{}.part(0.0f, 1.0f).progress);
}

}  // namespace
}  // namespace snowbough::base
