#include "snow/step/engine/engine_request.h"

#include <stdexcept>

namespace snowbough::snow {

EngineKind engine_kind(const std::string& name) {
  if (name == "AUTO") return EngineKind::kAuto;
  if (name == "GL") return EngineKind::kGl;
  if (name == "CPU") return EngineKind::kCpu;
  throw std::invalid_argument("engine must be AUTO, GL or CPU, not " + name);
}

}  // namespace snowbough::snow
