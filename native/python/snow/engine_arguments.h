#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "snow/simulation.h"

namespace snowbough::python {

/// The way of depositing that `mapping` names. @throws std::invalid_argument for another name.
snow::gl::DepositMapping mapping_from(const std::string& name);

/// What an engine says of itself, as SnowSimulation.engine and Engine.info give it.
pybind11::dict engine_dict(const snow::EngineInfo& info);

}  // namespace snowbough::python
