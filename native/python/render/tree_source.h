#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "python/numpy_arrays.h"
#include "render/data/sources.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::python {

/// Converts a tree's four-sided base to the renderer's input.
/// @throws std::invalid_argument for a mesh that is already subdivided.
inline render::TreeSource tree_source(const tree::TreeMesh& mesh) {
  if (mesh.sections.empty()) {
    throw std::invalid_argument(
        "the renderer subdivides the tree itself: build the mesh with detail=\"BASE\"");
  }
  render::TreeSource source;
  source.vertices = mesh.vertices;
  source.bone_indices = mesh.bone_indices;
  source.bone_weights = mesh.bone_weights;
  source.bone_count = static_cast<int32_t>(mesh.bones.heads.size());
  source.quads = mesh.quads;
  source.bark_uv = mesh.uv_bark;
  source.snow_uv = mesh.uv_snow;
  source.branch_level = mesh.branch_level;
  std::vector<int32_t> first_section;
  int32_t next = 0;
  for (const int32_t rows : mesh.branch_rows) {
    first_section.push_back(next);
    next += rows;
  }
  for (const tree::FaceOrigin& origin : mesh.origins) {
    const bool wall = origin.part == tree::FacePart::kWall;
    const bool inset = origin.part == tree::FacePart::kInset;
    source.branch.push_back(origin.branch);
    source.section.push_back(wall || inset ? first_section[origin.branch] + origin.row : -1);
    source.kind.push_back(wall    ? render::QuadKind::kWall
                          : inset ? render::QuadKind::kInset
                                  : render::QuadKind::kCap);
  }
  for (const tree::LimbSection& section : mesh.sections) {
    source.sections.push_back({section.begin, section.axis, static_cast<float>(section.length),
                               static_cast<float>(section.begin_radius),
                               static_cast<float>(section.end_radius), section.from_hole});
  }
  return source;
}

/// Name of the snow UV array; optional.
constexpr const char* kSnowUv = "snow_uv";

/// Calls `field(name, vector, scalar, columns)` for each array of a source except kinds and
/// sections, which Python sees as plain numbers. An element consists of `columns` of `scalar`.
template <typename Source, typename Visitor>
void visit_tree_arrays(Source& source, const Visitor& field) {
  using Shape = std::vector<pybind11::ssize_t>;
  field("vertices", source.vertices, float{}, Shape{3});
  field("bone_indices", source.bone_indices, int32_t{}, Shape{4});
  field("bone_weights", source.bone_weights, float{}, Shape{4});
  field("quads", source.quads, int32_t{}, Shape{4});
  field("bark_uv", source.bark_uv, float{}, Shape{4, 2});
  field(kSnowUv, source.snow_uv, float{}, Shape{4, 2});
  field("branch_level", source.branch_level, int32_t{}, Shape{});
  field("branch", source.branch, int32_t{}, Shape{});
  field("section", source.section, int32_t{}, Shape{});
}

/// Numbers of a section, in this order: begin, axis, length, radii at begin and end, from_hole.
constexpr pybind11::ssize_t kSectionNumbers = 10;

/// A source as numpy arrays by name, for storing in a file.
inline pybind11::dict tree_arrays(render::TreeSource source) {
  namespace py = pybind11;
  py::dict arrays;
  visit_tree_arrays(
      source, [&](const char* name, auto& values, auto scalar, std::vector<py::ssize_t> columns) {
        columns.insert(columns.begin(), static_cast<py::ssize_t>(values.size()));
        arrays[name] = to_numpy<decltype(scalar)>(std::move(values), std::move(columns));
      });
  std::vector<int32_t> kinds;
  for (const render::QuadKind kind : source.kind) kinds.push_back(static_cast<int32_t>(kind));
  const auto quads = static_cast<py::ssize_t>(kinds.size());
  arrays["kind"] = to_numpy<int32_t>(std::move(kinds), {quads});
  std::vector<float> sections;
  for (const render::LimbSection& s : source.sections) {
    sections.insert(sections.end(),
                    {s.begin.x, s.begin.y, s.begin.z, s.axis.x, s.axis.y, s.axis.z, s.length,
                     s.begin_radius, s.end_radius, s.from_hole ? 1.0f : 0.0f});
  }
  const auto count = static_cast<py::ssize_t>(source.sections.size());
  arrays["sections"] = to_numpy<float>(std::move(sections), {count, kSectionNumbers});
  arrays["bone_count"] = source.bone_count;
  return arrays;
}

/// The inverse of tree_arrays. @throws std::invalid_argument naming an array that is missing or has
/// another shape.
inline render::TreeSource tree_source(const pybind11::dict& arrays) {
  namespace py = pybind11;
  const auto find = [&](const char* name) -> py::object {
    if (!arrays.contains(name)) {
      throw std::invalid_argument(std::string("a tree's arrays lack '") + name + "'");
    }
    return arrays[name];
  };
  const auto read = [&](const char* name, auto scalar, const std::vector<py::ssize_t>& columns) {
    auto array = py::cast<InputArray<decltype(scalar)>>(find(name));
    bool right = array.ndim() == static_cast<py::ssize_t>(columns.size()) + 1;
    for (size_t k = 0; right && k < columns.size(); ++k) {
      right = array.shape(static_cast<py::ssize_t>(k) + 1) == columns[k];
    }
    if (!right) {
      throw std::invalid_argument(std::string("a tree's array '") + name + "' has another shape");
    }
    require_finite(array, std::string("a tree's array '") + name + "'");
    return array;
  };
  render::TreeSource source;
  visit_tree_arrays(source, [&](const char* name, auto& values, auto scalar,
                                const std::vector<py::ssize_t>& columns) {
    if (name == kSnowUv && !arrays.contains(name)) return;
    const auto array = read(name, scalar, columns);
    values.resize(static_cast<size_t>(array.shape(0)));
    if (!values.empty()) {
      std::memcpy(static_cast<void*>(values.data()), array.data(),
                  values.size() * sizeof values[0]);
    }
  });
  const auto kinds = read("kind", int32_t{}, {});
  for (py::ssize_t f = 0; f < kinds.shape(0); ++f) {
    const int32_t kind = kinds.at(f);
    if (kind < 0 || kind > 2) throw std::invalid_argument("a tree's kinds are 0, 1 or 2");
    source.kind.push_back(static_cast<render::QuadKind>(kind));
  }
  const auto sections = read("sections", float{}, {kSectionNumbers});
  const auto rows = sections.unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    source.sections.push_back({{rows(i, 0), rows(i, 1), rows(i, 2)},
                               {rows(i, 3), rows(i, 4), rows(i, 5)},
                               rows(i, 6),
                               rows(i, 7),
                               rows(i, 8),
                               rows(i, 9) > 0.5f});
  }
  source.bone_count = py::cast<int32_t>(find("bone_count"));
  return source;
}

}  // namespace snowbough::python
