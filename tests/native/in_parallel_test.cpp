#include "snow/in_parallel.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>

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

TEST(InParallel, hasAtLeastOneThread) {
  EXPECT_GE(default_threads(), 1);
}

}  // namespace
}  // namespace snowbough::snow
