#pragma once

#include <unistd.h>

namespace snowbough::base {

/// Remembers the process in which it was made. A forked process copies the memory but none of the
/// threads, so waiting for one there would never end.
class ProcessMark {
 public:
  bool is_here() const { return ::getpid() == made_in_; }

 private:
  pid_t made_in_ = ::getpid();
};

}  // namespace snowbough::base
