#pragma once

#include <string>

namespace snowbough::snow {

/// The engine that the user requests.
enum class EngineKind {
  /// GL on a hardware driver, else CPU.
  kAuto,
  kGl,
  kCpu,
};

/// "AUTO", "GL" or "CPU".
std::string engine_name(EngineKind kind);

/// @throws std::invalid_argument for names other than AUTO, GL and CPU.
EngineKind engine_kind(const std::string& name);

/// How an engine deposits snow.
enum class DepositMapping {
  /// Texels gather snow from the sky that they see: smooth, and bit-deterministic.
  kCompute,
  /// Pixels scatter their snow onto the texels under them: the thesis's Algorithm 1, for
  /// comparison. Only the GL engine has it.
  kGeometry,
};

/// The choices, for help texts.
inline constexpr const char* kMappingHelp =
    "COMPUTE, or GEOMETRY for the thesis's own scatter, which only engine GL has";

/// The mapping of that name. @throws std::invalid_argument for other names.
DepositMapping deposit_mapping(const std::string& name);

struct EngineRequest {
  EngineKind kind = EngineKind::kAuto;
  DepositMapping mapping = DepositMapping::kCompute;
  /// EGL device, see gpu::GlContext. With a device named here or in the environment, AUTO means
  /// GL.
  std::string device = {};
};

}  // namespace snowbough::snow
