#pragma once

#include <map>
#include <memory>

#include "snow/texels/texel_table.h"

namespace snowbough::snow {

/// The texel tables of a scene: meshes with equal triangles, texture coordinates and resolution,
/// such as copies of one object, share a table.
class TexelTables {
 public:
  /// The table of an equal topology that is still in use, or a new one.
  /// @throws std::invalid_argument as build_texel_table.
  std::shared_ptr<const TexelTable> find_or_build(const MapTopology& topology);

 private:
  struct Known;
  /// By a hash of the topology; never iterated over.
  std::map<size_t, std::weak_ptr<const Known>> known_;
};

}  // namespace snowbough::snow
