#include "tree/crossings/whole.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "base/parallel_for.h"
#include "tree/crossings/faces.h"

namespace snowbough::tree {
namespace {

/// Number of faces that are compared pairwise, and maximum number of halvings.
constexpr size_t kFew = 40;
constexpr int kMostHalvings = 20;
/// A part is not halved if both halves together would have more than this many times its faces.
constexpr double kWorthwhile = 1.15;

/// Parts and faces per thread at a time.
constexpr size_t kParts = 64;
constexpr size_t kFaces = 4096;

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

/// Calls work(begin, end) for all blocks; directly if there is only one.
template <typename Work>
void in_blocks(size_t count, size_t block, int threads, const Work& work) {
  if (count > block) {
    base::parallel_for(count, block, {threads, {}}, work);
  } else if (count > 0) {
    work(size_t{0}, count);
  }
}

int longest_axis(const glm::vec3& size) {
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Finds pairs by halving space: a pair belongs to the part that contains the lowest corner of its
/// boxes' intersection, so that none is found twice.
class PairFinder {
 public:
  PairFinder(std::vector<CrossingFace> faces, std::span<const uint8_t> changed)
      : faces_(std::move(faces)), changed_(changed) {}

  Pairs find(int threads) {
    std::vector<int32_t> all(faces_.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int32_t>(i);
    halve(std::move(all), glm::vec3(-1e30f), glm::vec3(1e30f), 0);
    std::vector<Pairs> found((parts_.size() + kParts - 1) / kParts);
    in_blocks(parts_.size(), kParts, threads, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) compare(parts_[i], found[begin / kParts]);
    });
    Pairs pairs;
    for (const Pairs& some : found) pairs.insert(pairs.end(), some.begin(), some.end());
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  /// Faces to compare pairwise, for pairs between `above` and `up_to`.
  struct Part {
    std::vector<int32_t> faces;
    glm::vec3 above, up_to;
  };

  bool is_changed(int32_t i) const { return changed_.empty() || changed_[faces_[i].number] != 0; }

  /// @param above, up_to  the part of space to halve, without its lower sides.
  void halve(std::vector<int32_t> part, const glm::vec3& above, const glm::vec3& up_to, int depth) {
    if (std::none_of(part.begin(), part.end(), [&](int32_t i) { return is_changed(i); })) return;
    glm::vec3 size = extent(part);
    // Along the longest axis, or along another if faces are too long for it.
    for (int turn = 0; turn < 3 && part.size() > kFew && depth < kMostHalvings; ++turn) {
      const int axis = longest_axis(size);
      const float cut = middle(part, axis);
      std::vector<int32_t> under, over;
      for (const int32_t i : part) {
        if (faces_[i].low[axis] <= cut) under.push_back(i);
        if (faces_[i].high[axis] > cut) over.push_back(i);
      }
      if (static_cast<double>(under.size() + over.size()) >
          kWorthwhile * static_cast<double>(part.size())) {
        size[axis] = -1.0f;
        continue;
      }
      std::vector<int32_t>().swap(part);
      glm::vec3 under_to(up_to), over_above(above);
      under_to[axis] = std::min(cut, up_to[axis]);
      over_above[axis] = std::max(cut, above[axis]);
      halve(std::move(under), above, under_to, depth + 1);
      halve(std::move(over), over_above, up_to, depth + 1);
      return;
    }
    parts_.push_back({std::move(part), above, up_to});
  }

  /// Extent of the faces' beginnings.
  glm::vec3 extent(const std::vector<int32_t>& part) const {
    glm::vec3 low(1e30f), high(-1e30f);
    for (const int32_t i : part) {
      low = glm::min(low, faces_[i].low);
      high = glm::max(high, faces_[i].low);
    }
    return high - low;
  }

  /// Median of the faces' beginnings along an axis.
  float middle(const std::vector<int32_t>& part, int axis) const {
    std::vector<float> lows;
    lows.reserve(part.size());
    for (const int32_t i : part) lows.push_back(faces_[i].low[axis]);
    const auto half = lows.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
    std::nth_element(lows.begin(), half, lows.end());
    return *half;
  }

  /// Sweeps along the axis with the largest extent.
  void compare(Part& part, Pairs& found) const {
    const int axis = longest_axis(extent(part.faces));
    std::sort(part.faces.begin(), part.faces.end(), [&](int32_t a, int32_t b) {
      const float of_a = faces_[a].low[axis], of_b = faces_[b].low[axis];
      return of_a != of_b ? of_a < of_b : a < b;
    });
    for (size_t i = 0; i < part.faces.size(); ++i) {
      const CrossingFace& f = faces_[part.faces[i]];
      for (size_t j = i + 1;
           j < part.faces.size() && faces_[part.faces[j]].low[axis] <= f.high[axis]; ++j) {
        const CrossingFace& g = faces_[part.faces[j]];
        if (!glm::all(glm::lessThanEqual(f.low, g.high)) ||
            !glm::all(glm::lessThanEqual(g.low, f.high)) ||
            !(is_changed(part.faces[i]) || is_changed(part.faces[j]))) {
          continue;
        }
        const glm::vec3 lowest = glm::max(f.low, g.low);
        if (glm::all(glm::greaterThan(lowest, part.above)) &&
            glm::all(glm::lessThanEqual(lowest, part.up_to)) && faces_cross(f, g)) {
          found.emplace_back(std::minmax(f.number, g.number));
        }
      }
    }
  }

  std::vector<CrossingFace> faces_;
  std::span<const uint8_t> changed_;
  std::vector<Part> parts_;
};

}  // namespace

std::vector<std::pair<int32_t, int32_t>> crossing_quads(std::span<const glm::dvec3> vertices,
                                                        std::span<const Quad> quads,
                                                        std::span<const int32_t> only,
                                                        std::span<const uint8_t> changed,
                                                        int threads) {
  std::vector<CrossingFace> faces(only.size());
  in_blocks(only.size(), kFaces, threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) faces[i] = make_crossing_face(vertices, quads, only[i]);
  });
  return PairFinder(std::move(faces), changed).find(threads);
}

}  // namespace snowbough::tree
