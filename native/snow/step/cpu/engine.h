#pragma once

#include <memory>

#include "snow/step/engine/engine.h"

namespace snowbough::snow::cpu {

/// All passes in C++ on the CPU's cores. Needs no OpenGL and no graphics driver; runs on the
/// calling thread.
std::unique_ptr<Engine> make_engine();

}  // namespace snowbough::snow::cpu
