// The texel table of a small mesh: ranges, and shares that sum to 1 per triangle.
#include <stdexcept>

#include "fuzz_mesh.h"

using namespace snowbough;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  fuzz::Input input(data, size);
  fuzz::Mesh mesh = fuzz::take_mesh(input);
  const auto wrong = input.take<uint8_t>();
  if (wrong == 1) mesh.topology.triangles[0] = input.take<int32_t>();
  if (wrong == 2) mesh.topology.corner_uv.pop_back();
  if (wrong == 3) mesh.topology.resolution = input.range(0, 63);
  snow::TexelTable table;
  try {
    table = snow::build_texel_table(mesh.topology, 1);
  } catch (const std::invalid_argument&) {
    return 0;
  }
  const auto triangles = static_cast<int32_t>(mesh.topology.triangles.size() / 3);
  std::vector<double> share(static_cast<size_t>(triangles), 0.0);
  fuzz::require(table.fragment_begin.size() == table.texel.size() + 1, "fragments without texel");
  for (size_t i = 0; i < table.texel.size(); ++i) {
    fuzz::require(table.texel[i] < table.resolution * table.resolution &&
                      (i == 0 ? table.texel[i] >= 0 : table.texel[i] > table.texel[i - 1]),
                  "texels are not ascending");
    fuzz::require(table.triangle[i] >= 0 && table.triangle[i] < triangles, "no such triangle");
    fuzz::require(table.coverage[i] >= 0.0f && table.coverage[i] <= 1.0f, "coverage beyond 0 to 1");
    const glm::vec2 at = table.barycentric[i];
    fuzz::require(at.x >= -1e-3f && at.y >= -1e-3f && at.x + at.y <= 1.001f,
                  "a sample outside its triangle");
    fuzz::require(table.fragment_begin[i] < table.fragment_begin[i + 1],
                  "a texel without fragment");
    for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
      const auto part = static_cast<size_t>(f);
      fuzz::require(table.fragment_share[part] >= 0.0f, "a negative share");
      share[static_cast<size_t>(table.fragment_triangle[part])] +=
          static_cast<double>(table.fragment_share[part]);
    }
  }
  int32_t bare = 0;
  for (const double sum : share) {
    if (sum == 0.0) ++bare;
    fuzz::require(sum == 0.0 || std::abs(sum - 1.0) < 1e-4, "shares of a triangle do not sum to 1");
  }
  fuzz::require(bare == table.degenerate_triangles, "a triangle with area has no fragment");
  return 0;
}
