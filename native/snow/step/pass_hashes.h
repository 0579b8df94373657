#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snow/step/engine/engine.h"

namespace snowbough::snow {

/// Hash of the data that a pass has written for one object, or for one tile of the occlusion grid.
struct PassHash {
  uint32_t step = 0;
  /// In the order of a step: positions and projection (the inputs), triangles, occlusion, deposit,
  /// stability, repose, statistics.
  std::string pass;
  /// The object's name; "tile X Y" for occlusion, "all" for the projection.
  std::string object;
  uint32_t hash = 0;
};

/// Hashes what the passes of one step write, so that two runs that should be the same name the
/// first pass that differs. Does nothing without `hashes`. On the engine's thread.
class PassHasher {
 public:
  PassHasher(Engine& engine, const std::vector<SceneObject*>& objects, uint32_t step,
             std::vector<PassHash>* hashes)
      : engine_(engine), objects_(objects), step_(step), hashes_(hashes) {}

  void inputs(const shared::ProjectionFrame& frame);
  void triangles();
  void occlusion(const Tile& tile);
  void deposit();
  /// `pass`: stability or repose.
  void heights(const char* pass);
  void statistics();

 private:
  template <typename Item>
  void add(const char* pass, const std::string& object, const std::vector<Item>& data);

  Engine& engine_;
  const std::vector<SceneObject*>& objects_;
  uint32_t step_;
  std::vector<PassHash>* hashes_;
};

}  // namespace snowbough::snow
