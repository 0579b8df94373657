#include "tree/crossings/crossings.h"

#include <algorithm>
#include <array>
#include <bit>
#include <glm/common.hpp>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>

#include "base/simd.h"
#include "tree/crossings/faces.h"
#include "tree/crossings/neighbourhoods.h"

namespace snowbough::tree {
namespace {

using base::bits;
using base::Float4;
using base::Int4;

/// Junctions per thread at a time: enough that most share faces with the one before, few enough
/// that the threads end together.
constexpr size_t kJunctionBlock = 64;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Float4 kNowhere = {kInfinity, kInfinity, kInfinity, kInfinity};

/// Bounding boxes of four faces, first along the axis of a sweep; unused lanes hold boxes that
/// overlap none.
struct Boxes {
  std::array<Float4, 3> low{kNowhere, kNowhere, kNowhere}, high{-kNowhere, -kNowhere, -kNowhere};
  /// -1 for faces that the previous junction had as well.
  Int4 known{};
};

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

/// Searches junctions one after the other. Neighbours along a limb share most faces; results for
/// these are reused. One per thread.
class CrossingSearch {
 public:
  /// @param memo  null: no cache.
  CrossingSearch(const Surface& surface, const VertexFaces& around, CrossingMemo* memo)
      : surface_(surface),
        neighbourhoods_(surface, around),
        memo_(memo),
        slot_(surface.quads.size(), 0) {
    if (memo_ != nullptr) prints_.emplace(surface);
  }

  /// Forgets all searched junctions.
  void begin() { searched_ = false; }

  /// All intersecting pairs near the junction, the lower index first, ascending.
  const Pairs& at(const Junction& junction) {
    const std::vector<int32_t>& numbers = neighbourhoods_.at(junction);
    const uint64_t print = prints_ ? prints_->of(numbers) : 0;
    const CrossingMemo::Places* known = prints_ ? memo_->known(junction.child, print) : nullptr;
    if (known != nullptr) {
      take_over(*known, numbers);
    } else {
      search(numbers);
      if (prints_) memo_->set(junction.child, print, places_among(numbers));
    }
    std::sort(found_.begin(), found_.end());
    searched_ = known == nullptr;
    return found_;
  }

 private:
  /// A face of the neighbourhood.
  struct Entry {
    /// Its beginning along the axis of the sweep.
    float low;
    /// Its index in faces_.
    int32_t slot;
    /// Whether the previous junction had it as well.
    int32_t known;
  };

  void take_over(const CrossingMemo::Places& known, const std::vector<int32_t>& numbers) {
    found_.clear();
    for (const auto& [a, b] : known) {
      found_.emplace_back(std::min(numbers[a], numbers[b]), std::max(numbers[a], numbers[b]));
    }
  }

  CrossingMemo::Places places_among(const std::vector<int32_t>& numbers) const {
    const auto place_of = [&](int32_t face) {
      return static_cast<int32_t>(std::find(numbers.begin(), numbers.end(), face) -
                                  numbers.begin());
    };
    CrossingMemo::Places places;
    for (const auto& [f, g] : found_) {
      places.emplace_back(place_of(f), place_of(g));
    }
    return places;
  }

  void search(const std::vector<int32_t>& numbers) {
    if (searched_) {
      std::erase_if(found_, [&](const auto& pair) {
        return !neighbourhoods_.has(pair.first) || !neighbourhoods_.has(pair.second);
      });
    } else {
      // No faces of the previous junction are available.
      faces_.clear();
      found_.clear();
    }
    gather(numbers);
    sweep();
  }

  /// Sorts the neighbourhood's faces by their beginning along its longest axis.
  void gather(const std::vector<int32_t>& numbers) {
    glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    order_.clear();
    for (size_t i = 0; i < numbers.size(); ++i) {
      const bool known = searched_ && neighbourhoods_.known()[i] != 0;
      if (!known) {
        slot_[numbers[i]] = static_cast<int32_t>(faces_.size());
        faces_.push_back(make_crossing_face(surface_.vertices, surface_.quads, numbers[i]));
      }
      const int32_t slot = slot_[numbers[i]];
      low = glm::min(low, faces_[slot].low);
      high = glm::max(high, faces_[slot].high);
      order_.push_back({0.0f, slot, known ? -1 : 0});
    }
    const glm::vec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                     : extent.y >= extent.z                       ? 1
                                                                  : 2;
    for (Entry& entry : order_) {
      entry.low = faces_[entry.slot].low[axis];
    }
    std::sort(order_.begin(), order_.end(), [](const Entry& a, const Entry& b) {
      return a.low != b.low ? a.low < b.low : a.slot < b.slot;
    });
    boxes_.assign((order_.size() + 3) / 4, Boxes());
    for (size_t i = 0; i < order_.size(); ++i) {
      const CrossingFace& face = faces_[order_[i].slot];
      Boxes& boxes = boxes_[i / 4];
      for (int k = 0; k < 3; ++k) {
        boxes.low[k][i % 4] = face.low[(axis + k) % 3];
        boxes.high[k][i % 4] = face.high[(axis + k) % 3];
      }
      boxes.known[i % 4] = order_[i].known;
    }
  }

  /// Tests each face against those that begin before it ends, except two faces of the previous
  /// junction.
  void sweep() {
    for (size_t i = 0; i < order_.size(); ++i) {
      const CrossingFace& one = faces_[order_[i].slot];
      const Boxes& own = boxes_[i / 4];
      const size_t lane = i % 4;
      // Within its own four only the later ones.
      uint32_t after = 0xeu << lane & 0xfu;
      for (size_t four = i / 4; four < boxes_.size(); ++four) {
        const Boxes& boxes = boxes_[four];
        if (boxes.low[0][0] > own.high[0][lane]) {
          break;
        }
        const Int4 meet =
            (boxes.low[0] <= own.high[0][lane]) & (boxes.low[1] <= own.high[1][lane]) &
            (boxes.high[1] >= own.low[1][lane]) & (boxes.low[2] <= own.high[2][lane]) &
            (boxes.high[2] >= own.low[2][lane]) & ~(boxes.known & own.known[lane]);
        for (uint32_t hits = bits(meet) & after; hits != 0; hits &= hits - 1) {
          test(one, faces_[order_[4 * four + std::countr_zero(hits)].slot]);
        }
        after = 0xf;
      }
    }
  }

  void test(const CrossingFace& one, const CrossingFace& other) {
    const CrossingFace& f = one.number < other.number ? one : other;
    const CrossingFace& g = one.number < other.number ? other : one;
    if (faces_cross(f, g)) {
      found_.emplace_back(f.number, g.number);
    }
  }

  const Surface& surface_;
  Neighbourhoods neighbourhoods_;
  std::optional<Fingerprints> prints_;
  CrossingMemo* memo_;
  /// Whether the previous junction was searched, since begin(), and not cached.
  bool searched_ = false;
  /// Faces met since the last junction without search, and per face of the surface its index among
  /// them.
  std::vector<CrossingFace> faces_;
  std::vector<int32_t> slot_;
  /// Result of the last junction.
  Pairs found_;
  /// Faces of the last junction.
  std::vector<Entry> order_;
  /// In that order, in groups of four.
  std::vector<Boxes> boxes_;
};

/// Searches not in use by a thread: one is as large as the surface, so blocks of junctions should
/// not create their own.
class SearchPool {
 public:
  SearchPool(const Surface& surface, const VertexFaces& around, CrossingMemo* memo)
      : surface_(surface), around_(around), memo_(memo) {}

  std::unique_ptr<CrossingSearch> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<CrossingSearch> one = std::move(free_.back());
        free_.pop_back();
        return one;
      }
    }
    return std::make_unique<CrossingSearch>(surface_, around_, memo_);
  }

  void give_back(std::unique_ptr<CrossingSearch> one) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(one));
  }

 private:
  const Surface& surface_;
  const VertexFaces& around_;
  CrossingMemo* memo_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<CrossingSearch>> free_;
};

}  // namespace

JunctionCrossings find_crossings(const Surface& surface, const std::vector<uint8_t>& only,
                                 const base::Execution& execution, CrossingMemo* memo) {
  const VertexFaces around(surface);
  JunctionCrossings crossings(surface.junctions.size());
  std::vector<size_t> wanted;
  for (size_t j = 0; j < crossings.size(); ++j) {
    if (only.empty() || only[j] != 0) {
      wanted.push_back(j);
    }
  }
  SearchPool pool(surface, around, memo);
  base::parallel_for(wanted.size(), kJunctionBlock, execution, [&](size_t begin, size_t end) {
    std::unique_ptr<CrossingSearch> search = pool.take();
    search->begin();
    for (size_t i = begin; i < end; ++i) {
      crossings[wanted[i]] = search->at(surface.junctions[wanted[i]]);
    }
    pool.give_back(std::move(search));
  });
  return crossings;
}

std::vector<int32_t> missing_limbs(const Surface& surface, const std::vector<uint8_t>& only) {
  // Only the first ring of a branch left out exists.
  std::vector<uint8_t> open(surface.vertices.size(), 0);
  std::vector<std::pair<int32_t, int32_t>> rims;
  for (size_t b = 0; b < surface.limbs.size(); ++b) {
    if (surface.limbs[b].rings.size() == 1) {
      for (const int32_t v : surface.limbs[b].rings.front().vertices) {
        rims.emplace_back(v, static_cast<int32_t>(b));
        open[v] = 1;
      }
    }
  }
  std::sort(rims.begin(), rims.end());
  const VertexFaces around(surface);
  Neighbourhoods neighbourhoods(surface, around);
  std::vector<int32_t> missing;
  for (size_t j = 0; j < surface.junctions.size(); ++j) {
    if (!only.empty() && only[j] == 0) {
      continue;
    }
    neighbourhoods.at(surface.junctions[j]);
    for (const int32_t v : neighbourhoods.expanded()) {
      if (open[v] == 0) {
        continue;
      }
      for (auto rim = std::lower_bound(rims.begin(), rims.end(), std::pair(v, 0));
           rim != rims.end() && rim->first == v; ++rim) {
        missing.push_back(rim->second);
      }
    }
  }
  std::sort(missing.begin(), missing.end());
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  return missing;
}

}  // namespace snowbough::tree
