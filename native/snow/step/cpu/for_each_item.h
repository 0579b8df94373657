#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "snow/in_parallel.h"

namespace snowbough::snow::cpu {

/// Calls `work(item)` for items 0 to count - 1, in any order, on as many threads.
template <typename Work>
void for_each_item(size_t count, int32_t threads, const Work& work) {
  std::atomic<size_t> next = 0;
  in_parallel(threads, [&](size_t, size_t) {
    for (size_t item; (item = next.fetch_add(1)) < count;) work(item);
  });
}

}  // namespace snowbough::snow::cpu
