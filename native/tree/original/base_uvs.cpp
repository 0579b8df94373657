#include "tree/original/base_uvs.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <vector>

namespace snowbough::tree {
namespace {

/// Greatest difference of a jump from a whole number.
constexpr float kSameJump = 1e-3f;

/// The parts of a base quad, consecutive quads of the fine mesh, joined along their edges.
class Parts {
 public:
  Parts(const TreeMesh& mesh, const std::vector<QuadUv>& uv) : mesh_(mesh), uv_(uv) {}

  void set(size_t begin, size_t end) {
    begin_ = begin;
    end_ = end;
  }

  /// The part whose middle is nearest to that of the base quad.
  size_t nearest(const Quad& base) const {
    if (end_ - begin_ == 1) return begin_;
    const glm::vec3 middle = middle_of(base);
    size_t found = begin_;
    float least = std::numeric_limits<float>::infinity();
    for (size_t f = begin_; f < end_; ++f) {
      const float distance = glm::distance(middle_of(mesh_.quads[f]), middle);
      if (distance >= least) continue;
      least = distance;
      found = f;
    }
    return found;
  }

  /// Coordinates of the base quad's corners, continued from `first`.
  QuadUv corners(const Quad& base, size_t first) {
    shifts_.assign(end_ - begin_, glm::vec2(0.0f));
    reached_.assign(end_ - begin_, 0);
    order_.clear();
    reach(first, glm::vec2(0.0f));
    for (size_t i = 0; i < order_.size(); ++i) {
      for (size_t f = begin_; f < end_; ++f) {
        if (reached_[f - begin_] == 0) continue_to(f, order_[i]);
      }
    }
    QuadUv found;
    for (int k = 0; k < 4; ++k) found[k] = at(base[k]);
    return found;
  }

 private:
  glm::vec3 middle_of(const Quad& quad) const {
    glm::vec3 sum(0.0f);
    for (const int32_t v : quad) sum += mesh_.vertices[v];
    return 0.25f * sum;
  }

  void reach(size_t part, const glm::vec2& shift) {
    reached_[part - begin_] = 1;
    shifts_[part - begin_] = shift;
    order_.push_back(part);
  }

  /// Continues from a part that was reached to one beside it, unless a seam lies between them.
  void continue_to(size_t part, size_t from) {
    glm::vec2 jumps[2];
    int shared = 0;
    for (int k = 0; k < 4 && shared < 2; ++k) {
      for (int i = 0; i < 4; ++i) {
        if (mesh_.quads[part][k] != mesh_.quads[from][i]) continue;
        jumps[shared++] = uv_[from][i] - uv_[part][k];
        break;
      }
    }
    if (shared < 2) return;
    const glm::vec2 jump = glm::round(jumps[0]);
    for (const glm::vec2& other : jumps) {
      if (glm::distance(other, jump) > kSameJump) return;
    }
    reach(part, shifts_[from - begin_] + jump);
  }

  /// Coordinates of a vertex, or of the nearest one of the parts that were reached.
  glm::vec2 at(int32_t vertex) const {
    glm::vec2 found(0.0f);
    float least = std::numeric_limits<float>::infinity();
    for (const size_t f : order_) {
      for (int k = 0; k < 4; ++k) {
        const int32_t v = mesh_.quads[f][k];
        const float distance =
            v == vertex ? 0.0f : glm::distance(mesh_.vertices[v], mesh_.vertices[vertex]);
        if (distance >= least) continue;
        least = distance;
        found = uv_[f][k] + shifts_[f - begin_];
      }
    }
    return found;
  }

  const TreeMesh& mesh_;
  const std::vector<QuadUv>& uv_;
  size_t begin_ = 0, end_ = 0;
  std::vector<glm::vec2> shifts_;
  std::vector<uint8_t> reached_;
  std::vector<size_t> order_;
};

}  // namespace

OriginalUvs base_uvs(const TreeMesh& mesh, const OriginalUvs& fine) {
  if (!mesh.base) throw std::invalid_argument("base_uvs: the mesh has no base");
  const size_t faces = mesh.quads.size();
  if (fine.material.size() != faces || (!fine.uv.empty() && fine.uv.size() != faces)) {
    throw std::invalid_argument("base_uvs: give the original_uvs of the same mesh");
  }
  OriginalUvs result;
  Parts parts(mesh, fine.uv);
  size_t end = 0;
  for (size_t b = 0; b < mesh.base->quads.size(); ++b) {
    const size_t begin = end;
    while (end < faces && mesh.origins[end] == mesh.base->origins[b]) ++end;
    if (begin == end) throw std::invalid_argument("base_uvs: a quad of the base has no parts");
    parts.set(begin, end);
    const size_t middle = parts.nearest(mesh.base->quads[b]);
    result.material.push_back(fine.material[middle]);
    if (!fine.uv.empty()) result.uv.push_back(parts.corners(mesh.base->quads[b], middle));
  }
  return result;
}

}  // namespace snowbough::tree
