#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "tree/surface/surface.h"

namespace snowbough::tree {

/// Hashes of faces, to tell whether faces of a surface equal those of an earlier or rebuilt one:
/// the same corners, shared in the same way, in the same order. One object per thread.
class Fingerprints {
 public:
  /// The surface must outlive this object.
  explicit Fingerprints(const Surface& surface);

  /// 64 bits; collisions of different faces are improbable.
  uint64_t of(std::span<const int32_t> faces);

 private:
  const Surface& surface_;
  /// Per vertex: its number of first use, counted across calls.
  std::vector<int64_t> number_;
  int64_t next_ = 0;
};

/// Results of the last search near every junction.
class CrossingMemo {
 public:
  /// Pairs of intersecting faces, as indices into the faces searched.
  using Places = std::vector<std::pair<int32_t, int32_t>>;

  explicit CrossingMemo(size_t branches) : entries_(branches) {}

  /// The result for faces with this hash near the child's junction; null if unknown.
  const Places* known(int32_t child, uint64_t print) const {
    const Entry& entry = entries_[child];
    if (!entry.filled || entry.print != print) return nullptr;
    hits_.fetch_add(1, std::memory_order_relaxed);
    return &entry.places;
  }

  /// Number of cache hits.
  int64_t hits() const { return hits_.load(std::memory_order_relaxed); }

  /// Different threads may set different children.
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
