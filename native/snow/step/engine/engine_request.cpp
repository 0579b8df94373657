#include "snow/step/engine/engine_request.h"

#include <stdexcept>

namespace snowbough::snow {

std::string engine_name(EngineKind kind) {
  switch (kind) {
    case EngineKind::kGl:
      return "GL";
    case EngineKind::kCpu:
      return "CPU";
    case EngineKind::kAuto:
      break;
  }
  return "AUTO";
}

EngineKind engine_kind(const std::string& name) {
  for (const EngineKind kind : {EngineKind::kAuto, EngineKind::kGl, EngineKind::kCpu}) {
    if (name == engine_name(kind)) return kind;
  }
  throw std::invalid_argument("engine must be AUTO, GL or CPU, not " + name);
}

DepositMapping deposit_mapping(const std::string& name) {
  if (name == "COMPUTE") return DepositMapping::kCompute;
  if (name == "GEOMETRY") return DepositMapping::kGeometry;
  throw std::invalid_argument("mapping must be one of COMPUTE, GEOMETRY, not '" + name + "'");
}

}  // namespace snowbough::snow
