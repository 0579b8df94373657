#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "snow/simulation.h"

namespace snowbough::python {

/// The mapping of that name. @throws std::invalid_argument for an unknown name.
snow::DepositMapping mapping_from(const std::string& name);

/// An engine's description as SnowSimulation.engine and Engine.info return it.
pybind11::dict engine_dict(const snow::EngineInfo& info);

}  // namespace snowbough::python
