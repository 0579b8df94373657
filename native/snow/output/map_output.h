#pragma once

#include <glm/vec3.hpp>
#include <variant>
#include <vector>

namespace snowbough::snow {

/// Maps that an output has only on request.
struct MapRequest {
  bool normal = false;
  bool wet = false;
  bool operator==(const MapRequest&) const = default;
};

/// A receiver's map for display: smoothed, extended beyond its charts, level across its seams. The
/// stored map stays unchanged. All arrays have resolution^2 values, row 0 = v 0; those that were
/// not requested are empty.
struct MapOutput {
  /// Metres.
  std::vector<float> height;
  /// Tangent space (see normals.h).
  std::vector<glm::vec3> normal;
  /// Water as a part of what soaks in, 0 to 1; only of simulations that follow it.
  std::vector<float> wet;
};

/// A map on request. Its name is its key in Python and begins the names of its files.
struct MapKind {
  const char* name;
  bool MapRequest::*is_requested;
  std::variant<std::vector<float> MapOutput::*, std::vector<glm::vec3> MapOutput::*> values;
};

inline constexpr MapKind kMapsOnRequest[] = {
    {"normal", &MapRequest::normal, &MapOutput::normal},
    {"wet", &MapRequest::wet, &MapOutput::wet},
};

}  // namespace snowbough::snow
