#pragma once

#include <unistd.h>

namespace snowbough::base {

/// The process in which it was made. A forked process has the memory of the one before it, but none
/// of its threads: what waits for one there would wait for ever.
class ProcessMark {
 public:
  bool is_here() const { return ::getpid() == made_in_; }

 private:
  pid_t made_in_ = ::getpid();
};

}  // namespace snowbough::base
