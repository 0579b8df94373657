#include "tree/read/wood.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <tuple>

namespace snowbough::tree {
namespace {

/// Replaces the branches' parts by pieces. @return the parts, ascending.
std::vector<int32_t> number_pieces(std::vector<Branch>& branches) {
  std::vector<int32_t> parts;
  for (const Branch& branch : branches) parts.push_back(branch.piece);
  std::sort(parts.begin(), parts.end());
  parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
  for (Branch& branch : branches) {
    const auto found = std::lower_bound(parts.begin(), parts.end(), branch.piece);
    branch.piece = static_cast<int32_t>(found - parts.begin());
  }
  return parts;
}

/// Calls with(face, material of the file) for a part's faces.
template <typename With>
void for_each_face(const ObjScene& scene, const Parts& parts, int32_t part, const With& with) {
  auto run = static_cast<size_t>(parts.run[part]);
  for (const int32_t f : parts.part_faces(part)) {
    while (run + 1 < scene.runs.size() && scene.runs[run + 1].first_face <= f) ++run;
    with(f, scene.runs[run].material);
  }
}

/// Whether the parts' triangles carry more than one material per part.
bool triangles_matter(const ObjScene& scene, const Parts& parts, const ClassifiedParts& classified,
                      const std::vector<int32_t>& wood) {
  bool matter = false;
  for (const int32_t part : wood) {
    if (matter) break;
    if (classified.role[part] == PartRole::kCrossSection) continue;
    const int32_t first = scene.runs[parts.run[part]].material;
    for_each_face(scene, parts, part, [&](int32_t f, int32_t material) {
      matter = matter || material != first ||
               (!scene.corner_uv.empty() && scene.corner_uv[scene.face_begin[f]] >= 0);
    });
  }
  return matter;
}

/// Per vertex of a part: a number shared by equal positions, from 0.
class PieceVertices {
 public:
  /// Appends each position once to `vertices`.
  PieceVertices(const ObjScene& scene, std::span<const int32_t> part,
                std::vector<glm::vec3>& vertices)
      : part_(part), number_(part.size()) {
    std::vector<int32_t> order(part.size());
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](int32_t i) {
      const glm::vec3& p = scene.positions[part[i]];
      return std::tuple(p.x, p.y, p.z);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](int32_t a, int32_t b) { return key(a) < key(b); });
    for (size_t i = 0; i < order.size(); ++i) {
      if (i == 0 || key(order[i - 1]) < key(order[i])) {
        vertices.push_back(scene.positions[part[order[i]]]);
      }
      number_[order[i]] = static_cast<int32_t>(vertices.size()) - 1;
    }
  }

  int32_t operator[](int32_t vertex) const {
    const auto found = std::lower_bound(part_.begin(), part_.end(), vertex);
    return number_[found - part_.begin()];
  }

 private:
  std::span<const int32_t> part_;
  std::vector<int32_t> number_;
};

/// Appends a part's faces as fans. @return whether all their corners have texture coordinates.
bool add_triangles(const ObjScene& scene, const Parts& parts, int32_t part,
                   const std::vector<int32_t>& material_number, OriginalWood& wood) {
  const PieceVertices vertices(scene, parts.part_vertices(part), wood.vertices);
  bool textured = !scene.corner_uv.empty();
  for_each_face(scene, parts, part, [&](int32_t f, int32_t material) {
    const int32_t first = scene.face_begin[f];
    for (int32_t c = first + 1; c + 1 < scene.face_begin[f + 1]; ++c) {
      std::array<int32_t, 3> triangle{};
      std::array<glm::vec2, 3> uv{};
      const std::array<int32_t, 3> corners{first, c, c + 1};
      for (int k = 0; k < 3; ++k) {
        triangle[k] = vertices[scene.corner_vertex[corners[k]]];
        const int32_t index = scene.corner_uv.empty() ? -1 : scene.corner_uv[corners[k]];
        textured = textured && index >= 0;
        if (index >= 0) uv[k] = scene.uvs[index];
      }
      wood.triangles.push_back(triangle);
      wood.uvs.push_back(uv);
      wood.triangle_material.push_back(material >= 0 ? material_number[material] : -1);
    }
  });
  return textured;
}

}  // namespace

OriginalWood gather_wood(const ObjScene& scene, const Parts& parts,
                         const ClassifiedParts& classified, std::vector<Branch>& branches) {
  OriginalWood wood;
  const std::vector<int32_t> pieces = number_pieces(branches);
  const bool matter = triangles_matter(scene, parts, classified, pieces);
  // Index in the file -> index in the wood, in order of use.
  std::vector<int32_t> material_number(scene.materials.size(), -1);
  for (const int32_t part : pieces) {
    for_each_face(scene, parts, part, [&](int32_t, int32_t material) {
      if (material < 0 || material_number[material] >= 0) return;
      material_number[material] = static_cast<int32_t>(wood.materials.size());
      ObjMaterial named;
      named.name = scene.materials[material];
      wood.materials.push_back(std::move(named));
    });
  }
  for (const int32_t part : pieces) {
    const bool is_surface = classified.role[part] != PartRole::kCrossSection;
    const int32_t material = scene.runs[parts.run[part]].material;
    wood.piece_material.push_back(material >= 0 ? material_number[material] : -1);
    wood.piece_textured.push_back(
        matter && is_surface && add_triangles(scene, parts, part, material_number, wood) ? 1 : 0);
    wood.piece_begin.push_back(static_cast<int32_t>(wood.triangles.size()));
  }
  return wood;
}

}  // namespace snowbough::tree
