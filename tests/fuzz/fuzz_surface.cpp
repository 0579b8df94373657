// The snow surface of a small mesh, planned and posed.

#include "fuzz_mesh.h"
#include "snow/surface/snow_surface.h"

using namespace snowbough;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  fuzz::Input input(data, size);
  const fuzz::Mesh mesh = fuzz::take_mesh(input, 8);
  for (const glm::vec2 uv : mesh.topology.corner_uv) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return 0;
  }
  snow::SurfaceSource source{mesh.topology, mesh.positions, {}};
  if (input.range(0, 1) == 1) {
    for (size_t corner = 0; corner < mesh.topology.triangles.size(); ++corner) {
      source.shading.push_back(input.range(-1, 6));
    }
  }
  snow::SurfacePlan plan;
  plan.density.depth = static_cast<float>(input.range(1, 255)) / 128.0f;
  plan.density.scale = static_cast<float>(input.range(8, 64)) / 8.0f;
  plan.density.most_points = 16;
  plan.seed = input.take<uint16_t>();
  plan.wind = {static_cast<float>(input.take<int8_t>()) / 128.0f, 0.0f};
  const std::vector<float> last = fuzz::take_heights(input, mesh.topology.resolution);
  const snow::SnowSurface surface = snow::plan_surface(
      source, last, last, input.range(0, 1) == 1 ? last : std::vector<float>{}, plan);
  const auto points = static_cast<int32_t>(surface.point_count());
  fuzz::require(static_cast<size_t>(surface.faces.begin.back()) == surface.faces.corner.size(),
                "the last face does not end with the last corner");
  for (const int32_t corner : surface.faces.corner) {
    fuzz::require(corner >= 0 && corner < points, "a face has no point");
  }
  snow::SurfaceFrame frame;
  frame.height = last.data();
  frame.open_depth = plan.density.depth;
  if (input.range(0, 1) == 1) frame.positions = mesh.positions.data();
  for (const glm::vec3& point : snow::surface_points(surface, {1.0f, 1.0f, 1.0f, 1.0f}, frame)) {
    fuzz::require(!mesh.is_moderate || (std::abs(point.x) < 200.0f && std::abs(point.y) < 200.0f &&
                                        std::abs(point.z) < 200.0f),
                  "a point is not near the receiver");
  }
  return 0;
}
