#include "tree/rings/squares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

/// Minimum cosine between a plane's normal and the limb for a plane across it.
constexpr float kAcrossCosine = 0.5f;
/// A step this many times longer than its neighbours indicates another limb.
constexpr float kSectionJump = 4.0f;
/// Cosine of a turn that does not occur within limbs.
constexpr float kSharpTurn = 0.3f;
/// Number of indications (sharp turn, sideways step, thickening, jump) that together begin a new
/// limb. Measured on two real trees without their groups: of 1,547 limbs, 30 are cut in the wrong
constexpr int kSignsOfANewLimb = 3;

std::vector<glm::vec3> face_corners(const ObjScene& scene, int32_t face) {
  std::vector<glm::vec3> corners;
  for (int32_t c = scene.face_begin[face]; c < scene.face_begin[face + 1]; ++c) {
    corners.push_back(scene.positions[scene.corner_vertex[c]]);
  }
  return corners;
}

/// Joins two triangles with two common corners to a quad: the second's own corner goes between the
/// shared ones. `same(i, j)`: corner i of the first is corner j of the second.
template <typename Same>
std::optional<CrossSection> join_triangles(const std::vector<glm::vec3>& first,
                                           const std::vector<glm::vec3>& second, const Same& same) {
  std::array<bool, 3> shared_first{};
  std::array<bool, 3> shared_second{};
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!shared_first[i] && !shared_second[j] && same(i, j)) {
        shared_first[i] = shared_second[j] = true;
        ++count;
      }
    }
  }
  if (count == 3) {
    // Both coincide, as where the limb has no thickness.
    return CrossSection{first};
  }
  if (count != 2) return std::nullopt;
  const auto own_first = std::find(shared_first.begin(), shared_first.end(), false);
  const auto own_second = std::find(shared_second.begin(), shared_second.end(), false);
  const auto i = static_cast<size_t>(own_first - shared_first.begin());
  const auto j = static_cast<size_t>(own_second - shared_second.begin());
  return CrossSection{{first[i], first[(i + 1) % 3], second[j], first[(i + 2) % 3]}};
}

/// The plane's normal, or no value for one without area.
std::optional<glm::vec3> plane_normal(const CrossSection& section) {
  glm::vec3 normal(0.0f);
  for (size_t c = 1; c + 1 < section.corners.size(); ++c) {
    normal += glm::cross(section.corners[c] - section.corners[0],
                         section.corners[c + 1] - section.corners[0]);
  }
  const float length = glm::length(normal);
  if (length == 0.0f) return std::nullopt;
  return normal / length;
}

/// The larger cosine between the line from one plane to the next and the planes' normals: 1 if the
/// line is perpendicular to one of them, or nothing has a direction.
float across_cosine(const CrossSection& first, const CrossSection& second, const glm::vec3& line) {
  const float length = glm::length(line);
  float best = -1.0f;
  for (const CrossSection* section : {&first, &second}) {
    if (const std::optional<glm::vec3> normal = plane_normal(*section); normal && length > 0.0f) {
      best = std::max(best, std::abs(glm::dot(*normal, line)) / length);
    }
  }
  return best < 0.0f ? 1.0f : best;
}

/// Cosine of the angle between two steps; 1 if one has no length.
float cosine(const glm::vec3& a, const glm::vec3& b) {
  const float lengths = glm::length(a) * glm::length(b);
  return lengths > 0.0f ? glm::dot(a, b) / lengths : 1.0f;
}

int turn_signs(const glm::vec3& before, const glm::vec3& step) {
  const float turn = cosine(before, step);
  return turn < kSharpTurn ? 2 : turn < 0.6f ? 1 : 0;
}

}  // namespace

std::optional<CrossSection> read_cross_section(const ObjScene& scene, const Parts& parts,
                                               int32_t part) {
  const std::span<const int32_t> faces = parts.part_faces(part);
  if (faces.size() == 1) {
    std::vector<glm::vec3> corners = face_corners(scene, faces[0]);
    if (corners.size() < 4) return std::nullopt;
    return CrossSection{std::move(corners)};
  }
  if (faces.size() != 2) return std::nullopt;
  const std::vector<glm::vec3> first = face_corners(scene, faces[0]);
  const std::vector<glm::vec3> second = face_corners(scene, faces[1]);
  if (first.size() != 3 || second.size() != 3) return std::nullopt;
  const int32_t* a = scene.corner_vertex.data() + scene.face_begin[faces[0]];
  const int32_t* b = scene.corner_vertex.data() + scene.face_begin[faces[1]];
  return join_triangles(first, second, [&](int i, int j) { return a[i] == b[j]; });
}

std::vector<CrossSection> read_cross_sections(const ObjScene& scene, const Parts& parts,
                                              std::span<const int32_t> branch_parts,
                                              std::vector<int32_t>& unread) {
  std::vector<CrossSection> sections;
  std::optional<std::vector<glm::vec3>> half;
  int32_t half_part = -1;
  for (const int32_t part : branch_parts) {
    if (std::optional<CrossSection> section = read_cross_section(scene, parts, part)) {
      sections.push_back(std::move(*section));
      continue;
    }
    const std::span<const int32_t> faces = parts.part_faces(part);
    if (faces.size() != 1) {
      unread.push_back(part);
      continue;
    }
    std::vector<glm::vec3> triangle = face_corners(scene, faces[0]);
    if (half) {
      if (std::optional<CrossSection> section = join_triangles(
              *half, triangle, [&](int i, int j) { return (*half)[i] == triangle[j]; })) {
        sections.push_back(std::move(*section));
        half.reset();
        continue;
      }
      unread.push_back(half_part);
    }
    half = std::move(triangle);
    half_part = part;
  }
  if (half) unread.push_back(half_part);
  return sections;
}

double row_share(std::span<const CrossSection> sections) {
  if (sections.size() < 2) return 0.0;
  const Limb limb = limb_from_cross_sections(sections);
  size_t across = 0;
  for (size_t i = 0; i + 1 < sections.size(); ++i) {
    const glm::vec3 line = limb.points[i + 1] - limb.points[i];
    across += across_cosine(sections[i], sections[i + 1], line) >= kAcrossCosine ? 1 : 0;
  }
  return static_cast<double>(across) / static_cast<double>(sections.size() - 1);
}

void count_turns(std::span<const CrossSection> sections, Turns& turns) {
  const Limb limb = limb_from_cross_sections(sections);
  for (size_t i = 2; i < limb.points.size(); ++i) {
    const float turn =
        glm::dot(limb.points[i - 1] - limb.points[i - 2], limb.points[i] - limb.points[i - 1]);
    ++turns.all;
    turns.back += turn < 0.0f ? 1 : 0;
  }
}

std::vector<size_t> chain_cross_sections(std::span<const CrossSection> sections) {
  if (sections.empty()) return {};
  const Limb limb = limb_from_cross_sections(sections);
  std::vector<glm::vec3> steps;
  for (size_t i = 0; i + 1 < sections.size(); ++i) {
    steps.push_back(limb.points[i + 1] - limb.points[i]);
  }
  std::vector<size_t> rows{0};
  for (size_t i = 1; i < steps.size(); ++i) {
    // A limb has at least two planes.
    if (i == rows.back()) continue;
    const bool last = i + 1 == steps.size();
    int signs = turn_signs(steps[i - 1], steps[i]);
    if (!last && cosine(steps[i], steps[i + 1]) < kSharpTurn) signs += 1;
    const float across = across_cosine(sections[i], sections[i + 1], steps[i]);
    signs += across < 0.7f ? 2 : across < 0.9f ? 1 : 0;
    const float before = limb.radii[i];
    const float after = limb.radii[i + 1];
    signs += after > 2.5f * before ? 2 : after > 1.3f * before ? 1 : 0;
    const float step = glm::length(steps[i]);
    if (step > kSectionJump * glm::length(steps[i - 1]) &&
        (last || step > kSectionJump * glm::length(steps[i + 1]))) {
      signs += 1;
    }
    if (signs >= kSignsOfANewLimb) rows.push_back(i + 1);
  }
  return rows;
}

Limb limb_from_cross_sections(std::span<const CrossSection> sections) {
  Limb limb;
  for (const CrossSection& section : sections) append_ring(section.corners, limb);
  return limb;
}

}  // namespace snowbough::tree
