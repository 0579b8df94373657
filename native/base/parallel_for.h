#pragma once

#include <cstddef>
#include <functional>

#include "tree/progress.h"

namespace snowbough::tree {

/// How a stage of the import may work.
struct Execution {
  /// Threads that may share the work, the calling one included; 0 = one a core. The result does not
  /// depend on it.
  int threads = 0;
  /// Asked between blocks of work whether to go on.
  Progress progress = {};

  /// The same work as the part from `from` to `to` of a longer one's progress.
  Execution part(float from, float to) const;
};

/// Calls work(begin, end) for consecutive blocks of [0, count), no longer than `block`, on several
/// threads at once. What a block writes must depend on its range alone and concern no other block.
///
/// Progress is reported from the calling thread, which works too; when it says stop, blocks under
/// way are finished and no new one is begun.
/// @throws Cancelled when progress says stop; else what the first block that failed threw.
void parallel_blocks(size_t count, size_t block, const Execution& execution,
                     const std::function<void(size_t begin, size_t end)>& work);

}  // namespace snowbough::tree
