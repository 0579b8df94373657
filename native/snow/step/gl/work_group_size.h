#pragma once

#include <cstdint>
#include <string>

namespace snowbough::snow {

/// How many invocations of a work group walk side by side along a run of texels or pixels, each
/// taking every so many-th: 64, as GPUs run them together; 8 where the driver is a software
/// renderer. Those run 8 as one vector, to the end, before the next, and are a third slower where
/// it leaves gaps in memory for others to come back to. For the current context. GPU thread.
int32_t walkers();

/// What the shaders that walk are compiled with.
std::string walkers_define(int32_t walkers);

}  // namespace snowbough::snow
