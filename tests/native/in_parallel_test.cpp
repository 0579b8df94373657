#include "snow/in_parallel.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace snowbough::snow {
namespace {

TEST(InParallel, callsEveryPartOnce) {
  for (const int32_t threads : {1, 2, 5}) {
    std::array<int, 5> calls{};
    in_parallel(threads, [&](size_t part, size_t parts) {
      EXPECT_EQ(parts, static_cast<size_t>(threads));
      ++calls[part];
    });
    for (int32_t part = 0; part < 5; ++part) EXPECT_EQ(calls[part], part < threads ? 1 : 0);
  }
}

TEST(InParallel, throwsWhatTheFirstPartThatFailedThrew) {
  try {
    in_parallel(4, [](size_t part, size_t) {
      if (part > 1) throw std::runtime_error(std::to_string(part));
    });
    FAIL() << "must throw";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "2");
  }
}

TEST(InParallel, canBeCalledByManyAndFromWithin) {
  start_helpers();
  std::atomic<int> calls = 0;
  std::vector<std::jthread> callers;
  for (int caller = 0; caller < 8; ++caller) {
    callers.emplace_back([&] {
      for (int round = 0; round < 50; ++round) {
        in_parallel(3, [&](size_t, size_t) { in_parallel(2, [&](size_t, size_t) { ++calls; }); });
      }
    });
  }
  callers.clear();
  EXPECT_EQ(calls, 8 * 50 * 3 * 2);
}

TEST(InParallel, runsItsPartsAtTheSameTime) {
  if (default_threads() < 2) GTEST_SKIP() << "one core";
  // Each part waits for the other: they run on two threads.
  std::atomic<int> begun = 0;
  in_parallel(2, [&](size_t, size_t) {
    ++begun;
    while (begun < 2) std::this_thread::yield();
  });
  EXPECT_EQ(begun, 2);
}

TEST(InParallel, hasAtLeastOneThread) {
  EXPECT_GE(default_threads(), 1);
}

}  // namespace
}  // namespace snowbough::snow
