#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Tells whether faces look as others did, of the same surface or of one that was built anew: the
/// same corners, shared the same way, in the same order. Each thread needs its own.
class Fingerprints {
 public:
  /// The surface must outlive this object.
  explicit Fingerprints(const Surface& surface);

  /// 64 bits; of faces that look different they are the same by chance only.
  uint64_t of(std::span<const int32_t> faces);

 private:
  const Surface& surface_;
  /// Per vertex: its number among those met, counted on from call to call.
  std::vector<int64_t> number_;
  int64_t next_ = 0;
};

/// What was found near every junction when it was last looked at.
class CrossingMemo {
 public:
  /// Pairs of faces that cross, by their places among the faces looked at.
  using Places = std::vector<std::pair<int32_t, int32_t>>;

  explicit CrossingMemo(size_t branches) : entries_(branches) {}

  /// What faces of that look hold near the child's junction; null where it is not known.
  const Places* known(int32_t child, uint64_t print) const {
    const Entry& entry = entries_[child];
    if (!entry.filled || entry.print != print) return nullptr;
    hits_.fetch_add(1, std::memory_order_relaxed);
    return &entry.places;
  }

  /// How often something was known.
  int64_t hits() const { return hits_.load(std::memory_order_relaxed); }

  /// Different children may be set by different threads.
  void set(int32_t child, uint64_t print, Places places) {
    entries_[child] = {print, std::move(places), true};
  }

 private:
  struct Entry {
    uint64_t print = 0;
    Places places;
    bool filled = false;
  };

  std::vector<Entry> entries_;
  mutable std::atomic<int64_t> hits_ = 0;
};

}  // namespace snowbough::tree
