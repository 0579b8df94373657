// The seam table of a small mesh, and the levelling of a map across its seams.
#include <stdexcept>

#include "fuzz_mesh.h"
#include "snow/seams/seam_leveller.h"
#include "snow/seams/seam_table.h"

using namespace snowbough;

namespace {

void check_lines(const snow::TexelLines& lines, size_t texels) {
  for (const int32_t place : lines.place) {
    fuzz::require(place >= 0 && place < lines.length, "a texel without place");
  }
  for (size_t ghost = 0; ghost < lines.ghosts.size(); ++ghost) {
    double sum = 0.0;
    for (int32_t t = lines.ghosts.begin[ghost]; t < lines.ghosts.begin[ghost + 1]; ++t) {
      const auto term = static_cast<size_t>(t);
      fuzz::require(static_cast<size_t>(lines.ghosts.source[term]) < texels, "no such texel");
      sum += static_cast<double>(lines.ghosts.weight[term]);
    }
    fuzz::require(
        lines.ghosts.begin[ghost] == lines.ghosts.begin[ghost + 1] || std::abs(sum - 1.0) < 1e-4,
        "weights of a ghost do not sum to 1");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  fuzz::Input input(data, size);
  const fuzz::Mesh mesh = fuzz::take_mesh(input);
  snow::TexelTable table;
  try {
    table = snow::build_texel_table(mesh.topology, 1);
  } catch (const std::invalid_argument&) {
    return 0;
  }
  const snow::SeamTable seams = snow::build_seam_table(mesh.topology, table, mesh.positions);
  check_lines(seams.u, table.texel.size());
  check_lines(seams.v, table.texel.size());
  const std::vector<float> map = fuzz::take_heights(input, mesh.topology.resolution);
  std::vector<float> level = map;
  snow::SeamLeveller(seams.levelling).run(level);
  const auto [low, high] = std::minmax_element(map.begin(), map.end());
  for (const float height : level) {
    fuzz::require(height >= std::min(*low, 0.0f) && height <= std::max(*high, 0.0f),
                  "a levelled height outside the map's range");
  }
  return 0;
}
