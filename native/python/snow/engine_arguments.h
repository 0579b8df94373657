#pragma once

#include <pybind11/pybind11.h>

#include "snow/simulation.h"

namespace snowbough::python {

/// An engine's description as SnowSimulation.engine and Engine.info return it.
pybind11::dict engine_dict(const snow::EngineInfo& info);

}  // namespace snowbough::python
