#include "snow/texels/texel_tables.h"

#include <functional>
#include <string_view>

namespace snowbough::snow {
namespace {

template <typename Item>
std::string_view bytes_of(const std::vector<Item>& items) {
  return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item)};
}

/// Whether the tables are equal, to the bit.
bool have_one_table(const MapTopology& a, const MapTopology& b) {
  return a.resolution == b.resolution && a.vertex_count == b.vertex_count &&
         a.triangles == b.triangles && bytes_of(a.corner_uv) == bytes_of(b.corner_uv);
}

}  // namespace

struct TexelTables::Known {
  MapTopology topology;
  TexelTable table;
};

std::shared_ptr<const TexelTable> TexelTables::find_or_build(const MapTopology& topology) {
  const std::hash<std::string_view> hash;
  // Topologies with equal hashes do not share a table.
  std::weak_ptr<const Known>& place =
      known_[hash(bytes_of(topology.triangles)) ^ 31 * hash(bytes_of(topology.corner_uv))];
  std::shared_ptr<const Known> known = place.lock();
  if (known == nullptr || !have_one_table(known->topology, topology)) {
    known = std::make_shared<const Known>(Known{topology, build_texel_table(topology)});
    place = known;
  }
  return {known, &known->table};
}

}  // namespace snowbough::snow
