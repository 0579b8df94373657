#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <vector>

#include "fuzz_input.h"
#include "snow/texels/texel_table.h"

namespace snowbough::fuzz {

struct Mesh {
  snow::MapTopology topology;
  std::vector<glm::vec3> positions;
  /// True if all positions are within 100 m.
  bool is_moderate = true;
};

/// A coordinate in one of three forms: on a coarse grid, so that points and edges coincide; fine;
/// or any float.
inline float coordinate(Input& input, int32_t form) {
  if (form == 0) return static_cast<float>(input.take<uint8_t>()) / 16.0f;
  if (form == 1) return static_cast<float>(input.take<uint16_t>()) / 65535.0f;
  return input.take<float>();
}

/// A small mesh: at most 12 vertices, 16 triangles and a map of 64 to 71 texels per side. Corners
/// take their vertex's UV, or one of their own. Three of four layouts fill a quarter of the map,
/// which is faster. Positions are finite and at most 1e9, as the module requires.
inline Mesh take_mesh(Input& input) {
  Mesh mesh;
  const int32_t forms = input.take<uint8_t>();
  const int32_t uv_form = forms % 3, place_form = forms / 3 % 3;
  const float uv_scale = forms / 9 % 4 == 3 ? 1.0f : 0.25f;
  mesh.topology.resolution = 64 + forms / 36;
  mesh.topology.vertex_count = input.range(3, 12);
  std::vector<glm::vec2> uv;
  for (int32_t v = 0; v < mesh.topology.vertex_count; ++v) {
    glm::vec3 place;
    for (int k = 0; k < 3; ++k) {
      place[k] = coordinate(input, place_form) * (place_form == 0 ? 0.25f : 1.0f);
      if (!(std::abs(place[k]) <= 1e9f)) place[k] = 0.0f;
      mesh.is_moderate = mesh.is_moderate && std::abs(place[k]) <= 100.0f;
    }
    mesh.positions.push_back(place);
    const float scale = uv_form == 0 ? uv_scale / 16.0f : uv_scale;
    const float u = coordinate(input, uv_form) * scale;
    uv.emplace_back(u, coordinate(input, uv_form) * scale);
  }
  const int32_t triangles = input.range(1, 16);
  for (int32_t t = 0; t < triangles; ++t) {
    const bool has_own_uv = input.range(0, 3) == 3;
    for (int k = 0; k < 3; ++k) {
      const int32_t vertex = input.range(0, mesh.topology.vertex_count - 1);
      mesh.topology.triangles.push_back(vertex);
      glm::vec2 own = uv[static_cast<size_t>(vertex)];
      if (has_own_uv) {
        own.x = uv_scale * static_cast<float>(input.take<uint8_t>()) / 255.0f;
        own.y = uv_scale * static_cast<float>(input.take<uint8_t>()) / 255.0f;
      }
      mesh.topology.corner_uv.push_back(own);
    }
  }
  return mesh;
}

/// Heights of a map: 64 of the input's values repeat over it. Finite, within 10 m.
inline std::vector<float> take_heights(Input& input, int32_t resolution) {
  std::vector<float> values(64);
  for (float& value : values) value = static_cast<float>(input.take<int8_t>()) / 64.0f;
  const auto side = static_cast<size_t>(resolution);
  std::vector<float> heights(side * side);
  for (size_t i = 0; i < heights.size(); ++i) {
    heights[i] = values[(i / side / 8 % 8) * 8 + i % side / 8 % 8];
  }
  return heights;
}

}  // namespace snowbough::fuzz
