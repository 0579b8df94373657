#include "base/thread_pool.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/parallel_for.h"

#ifdef __linux__
#include <sys/resource.h>
#include <sys/time.h>

#include <chrono>
#endif

namespace snowbough::base {
namespace {

TEST(ParallelParts, callsEveryPartOnce) {
  for (const int32_t threads : {1, 2, 5}) {
    std::array<int, 5> calls{};
    parallel_for(threads, [&](size_t part, size_t parts) {
      EXPECT_EQ(parts, static_cast<size_t>(threads));
      ++calls[part];
    });
    for (int32_t part = 0; part < 5; ++part) EXPECT_EQ(calls[part], part < threads ? 1 : 0);
  }
}

TEST(ParallelParts, throwsTheErrorOfTheFirstFailedPart) {
  try {
    parallel_for(4, [](size_t part, size_t) {
      if (part > 1) throw std::runtime_error(std::to_string(part));
    });
    FAIL() << "must throw";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "2");
  }
}

TEST(ParallelParts, canBeCalledByManyAndFromWithin) {
  start_thread_pool();
  std::atomic<int> calls = 0;
  std::vector<std::jthread> callers;
  for (int caller = 0; caller < 8; ++caller) {
    callers.emplace_back([&] {
      for (int round = 0; round < 50; ++round) {
        parallel_for(3, [&](size_t, size_t) { parallel_for(2, [&](size_t, size_t) { ++calls; }); });
      }
    });
  }
  callers.clear();
  EXPECT_EQ(calls, 8 * 50 * 3 * 2);
}

TEST(ParallelParts, runsItsPartsAtTheSameTime) {
  if (default_threads() < 2) GTEST_SKIP() << "one core";
  // Each part waits for the other: they run on two threads.
  std::atomic<int> begun = 0;
  parallel_for(2, [&](size_t, size_t) {
    ++begun;
    while (begun < 2) std::this_thread::yield();
  });
  EXPECT_EQ(begun, 2);
}

TEST(ThreadPool, hasAtLeastOneThread) {
  EXPECT_GE(default_threads(), 1);
}

TEST(ThreadPool, aPoolOfFourRunsFourPartsAtTheSameTime) {
  ThreadPool pool(4);
  // Each part waits for the others: they run on four threads.
  std::atomic<int> begun = 0;
  pool.run(4, [&](size_t) {
    ++begun;
    while (begun < 4) std::this_thread::yield();
  });
  EXPECT_EQ(begun, 4);
}

TEST(ThreadPool, theFirstPartIsTheCallingThreads) {
  ThreadPool pool(3);
  for (int round = 0; round < 100; ++round) {
    std::thread::id first;
    pool.run(3, [&](size_t part) {
      if (part == 0) first = std::this_thread::get_id();
    });
    EXPECT_EQ(first, std::this_thread::get_id());
  }
}

TEST(ThreadPool, aPoolOfOneDoesAllOnTheCallingThread) {
  ThreadPool pool(1);
  std::vector<size_t> parts;
  pool.run(4, [&](size_t part) { parts.push_back(part); });
  EXPECT_EQ(parts, (std::vector<size_t>{0, 1, 2, 3}));
}

TEST(ThreadPool, beginsNoPartAfterOneHasFailed) {
  ThreadPool pool(1);
  size_t last = 0;
  EXPECT_THROW(pool.run(10,
                        [&](size_t part) {
                          last = part;
                          if (part == 3) throw std::runtime_error("three");
                        }),
               std::runtime_error);
  EXPECT_EQ(last, 3u);
}

TEST(ThreadPool, worksOnAfterAPartHasFailed) {
  ThreadPool pool(4);
  for (int round = 0; round < 100; ++round) {
    std::atomic<int> calls = 0;
    EXPECT_THROW(pool.run(8, [](size_t) { throw std::runtime_error("each"); }), std::runtime_error);
    pool.run(8, [&](size_t) { ++calls; });
    EXPECT_EQ(calls, 8);
  }
}

TEST(ThreadPool, throwsTheErrorOfTheFirstFailedPart) {
  ThreadPool pool(4);
  for (int round = 0; round < 100; ++round) {
    try {
      pool.run(8, [](size_t part) {
        if (part >= 2) throw part;
      });
      FAIL() << "must throw";
    } catch (const size_t& part) {
      EXPECT_EQ(part, 2u);
    }
  }
}

#ifdef __linux__
/// Niceness of the threads that the shared pool gives to the calling one, itself included. Every
/// part takes its time, so that all threads get some.
std::vector<int> nicenesses_of_the_shared_pool() {
  std::vector<int> found(64);
  ThreadPool::shared().run(found.size(), [&](size_t part) {
    found[part] = getpriority(PRIO_PROCESS, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  return found;
}

TEST(SharedPool, hasThePriorityOfItsCaller) {
  const int before = getpriority(PRIO_PROCESS, 0);
  EXPECT_EQ(nicenesses_of_the_shared_pool(), std::vector<int>(64, before));
  std::jthread([&] {
    ASSERT_EQ(setpriority(PRIO_PROCESS, 0, before + 3), 0);
    EXPECT_EQ(nicenesses_of_the_shared_pool(), std::vector<int>(64, before + 3));
  }).join();
  EXPECT_EQ(nicenesses_of_the_shared_pool(), std::vector<int>(64, before));
}
#endif

TEST(BegunWork, RunsOnAThreadOfThePool) {
  std::promise<std::thread::id> ran;
  ThreadPool pool(2);
  pool.begin([&] { ran.set_value(std::this_thread::get_id()); });
  EXPECT_NE(ran.get_future().get(), std::this_thread::get_id());
}

TEST(BegunWork, DoesNotDelayCallersOfRun) {
  std::promise<void> started;
  std::promise<void> go_on;
  ThreadPool pool(2);
  pool.begin([&] {
    started.set_value();
    go_on.get_future().wait();
  });
  started.get_future().wait();
  std::atomic<int> calls = 0;
  pool.run(3, [&](size_t) { ++calls; });
  go_on.set_value();
  EXPECT_EQ(calls, 3);
}

TEST(BegunWork, IsNotCalledWithoutThreads) {
  bool was_called = false;
  ThreadPool(1).begin([&] { was_called = true; });
  EXPECT_FALSE(was_called);
}

}  // namespace
}  // namespace snowbough::base
