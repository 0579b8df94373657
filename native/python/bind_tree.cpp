#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "bindings.h"
#include "bound_mesh.h"
#include "choose.h"
#include "numpy_arrays.h"
#include "python_progress.h"
#include "tree/build_tree_mesh.h"
#include "tree/mesh/bones.h"
#include "tree/mesh/bones_reduce.h"
#include "tree/mesh/edges.h"
#include "tree/mesh/mesh_check.h"
#include "tree/original/base_uvs.h"
#include "tree/original/original_uvs.h"

namespace snowbough::python {
namespace {

using namespace snowbough::tree;

py::ssize_t size(size_t count) {
  return static_cast<py::ssize_t>(count);
}

py::dict check_dict(const MeshCheck& check) {
  py::dict dict;
  dict["components"] = check.components;
  dict["euler"] = check.euler;
  dict["boundary_edges"] = check.boundary_edges;
  dict["nonmanifold_edges"] = check.nonmanifold_edges;
  dict["nonmanifold_faces"] = check.nonmanifold_faces;
  dict["flipped_edges"] = check.flipped_edges;
  dict["zero_area_faces"] = check.zero_area_faces;
  dict["unused_vertices"] = check.unused_vertices;
  dict["winding_ok"] = check.winding_ok;
  dict["closed"] = check.closed();
  dict["volume"] = check.volume;
  return dict;
}

py::tuple uvs_to_numpy(OriginalUvs found) {
  const py::ssize_t faces = size(found.material.size());
  py::object uv = py::none();
  if (!found.uv.empty()) uv = to_numpy<float>(std::move(found.uv), {faces, 4, 2});
  return py::make_tuple(uv, to_numpy<int32_t>(std::move(found.material), {faces}));
}

void bind_mesh_class(py::module_& module) {
  using pybind11::object;
  const auto view = [](auto get, auto scalar, const std::vector<py::ssize_t>& columns) {
    using Scalar = decltype(scalar);
    return [get, columns](const object& self) {
      const auto& values = get(self.cast<const BoundMesh&>());
      std::vector<py::ssize_t> shape{size(values.size())};
      shape.insert(shape.end(), columns.begin(), columns.end());
      return view_numpy<Scalar>(values, std::move(shape), self);
    };
  };
#define SNOWBOUGH_FIELD(field)            \
  [](const BoundMesh& m) -> const auto& { \
    return m.mesh.field;                  \
  }
  const auto origins = [](auto get) {
    return [get](const BoundMesh& m) {
      std::vector<int32_t> values;
      values.reserve(m.mesh.origins.size());
      for (const FaceOrigin& origin : m.mesh.origins) {
        values.push_back(static_cast<int32_t>(get(origin)));
      }
      const py::ssize_t count = size(values.size());
      return to_numpy<int32_t>(std::move(values), {count});
    };
  };
  py::class_<BoundMesh>(
      module, "TreeMesh",
      R"(One closed, rigged, unwrapped surface around a skeleton. Arrays are read-only views.
Metres, Z up.)")
      .def_property_readonly("vertices", view(SNOWBOUGH_FIELD(vertices), float{}, {3}))
      .def_property_readonly("quads", view(SNOWBOUGH_FIELD(quads), int32_t{}, {4}))
      .def_property_readonly("uv_bark", view(SNOWBOUGH_FIELD(uv_bark), float{}, {4, 2}))
      .def_property_readonly("uv_snow", view(SNOWBOUGH_FIELD(uv_snow), float{}, {4, 2}))
      .def_property_readonly("branch_level", view(SNOWBOUGH_FIELD(branch_level), int32_t{}, {}))
      .def_property_readonly("bone_indices", view(SNOWBOUGH_FIELD(bone_indices), int32_t{}, {4}))
      .def_property_readonly("bone_weights", view(SNOWBOUGH_FIELD(bone_weights), float{}, {4}))
      .def_property_readonly("bone_heads", view(SNOWBOUGH_FIELD(bones.heads), float{}, {3}))
      .def_property_readonly("bone_tails", view(SNOWBOUGH_FIELD(bones.tails), float{}, {3}))
      .def_property_readonly("bone_parents", view(SNOWBOUGH_FIELD(bones.parents), int32_t{}, {}))
      .def_property_readonly("bone_branches", view(SNOWBOUGH_FIELD(bones.branches), int32_t{}, {}))
      .def_property_readonly("bone_levels", view(SNOWBOUGH_FIELD(bones.levels), int32_t{}, {}))
      .def_property_readonly("bone_head_radii",
                             view(SNOWBOUGH_FIELD(bones.head_radii), float{}, {}))
      .def_property_readonly("bone_tail_radii",
                             view(SNOWBOUGH_FIELD(bones.tail_radii), float{}, {}))
      .def_property_readonly("bone_names", [](const BoundMesh& m) { return m.mesh.bones.names; })
      .def_property_readonly(
          "bone_map",
          [](const object& self) -> object {
            const auto& map = self.cast<const BoundMesh&>().bone_map;
            if (map.empty()) {
              return py::none();
            }
            return view_numpy<int32_t>(map, {size(map.size())}, self);
          },
          "After reduce_bones: per old bone the new bone that replaces it; else None.")
      .def_property_readonly("continues_parent",
                             view(SNOWBOUGH_FIELD(continues_parent), uint8_t{}, {}))
      .def_property_readonly("branch_parents", view(SNOWBOUGH_FIELD(branch_parents), int32_t{}, {}),
                             "Per branch: the branch whose surface it leaves, or -1.")
      .def_property_readonly("branch_rows", view(SNOWBOUGH_FIELD(branch_rows), int32_t{}, {}))
      .def_property_readonly("face_branch", origins([](const FaceOrigin& o) { return o.branch; }))
      .def_property_readonly("face_row", origins([](const FaceOrigin& o) { return o.row; }))
      .def_property_readonly("face_side", origins([](const FaceOrigin& o) { return o.side; }))
      .def_property_readonly("face_part", origins([](const FaceOrigin& o) { return o.part; }),
                             "0 wall, 1 inset around a child's hole, 2 tip cap, 3 root cap")
      .def_property_readonly("warnings", [](const BoundMesh& m) { return m.mesh.warnings; })
      .def_property_readonly(
          "report",
          [](const BoundMesh& m) {
            py::dict dict = check_dict(m.report.check);
            dict["junctions"] = m.report.junctions;
            dict["crossing_junctions"] = m.report.crossing_junctions;
            return dict;
          },
          R"(The result of check_mesh for the four-sided base of this mesh, with junctions and
crossing_junctions.)");
#undef SNOWBOUGH_FIELD
}

void bind_mesh_functions(py::module_& module) {
  module.def(
      "build_tree_mesh",
      [](const Skeleton& skeleton, const std::string& width, const std::string& species,
         const std::string& detail, bool close_root, bool close_tips, int snow_resolution,
         int max_influences, int threads, const py::object& progress, bool root_bone) {
        TreeMeshOptions options;
        options.width.mode = choose<WidthMode>(
            "width", width, {{"ORIGINAL", WidthMode::kOriginal}, {"INVERSE", WidthMode::kInverse}});
        options.width.species = choose<Species>(
            "species", species,
            {{"BROADLEAF", Species::kBroadleaf}, {"EVERGREEN", Species::kEvergreen}});
        options.detail = choose<std::optional<Detail>>("detail", detail,
                                                       {{"BASE", std::nullopt},
                                                        {"DRAFT", Detail::kDraft},
                                                        {"GAME", Detail::kGame},
                                                        {"DEFAULT", Detail::kDefault},
                                                        {"FILM", Detail::kFilm}});
        options.close_root = close_root;
        options.close_tips = close_tips;
        options.snow_resolution = snow_resolution;
        options.max_influences = max_influences;
        options.threads = threads;
        options.root_bone = root_bone;
        return run_cancellable(progress, [&](const base::Progress& asked) {
          options.progress = asked;
          auto bound = std::make_unique<BoundMesh>();
          bound->mesh = build_tree_mesh(skeleton, options, &bound->report);
          return bound;
        });
      },
      py::arg("skeleton"), py::arg("width") = "ORIGINAL", py::arg("species") = "BROADLEAF",
      py::arg("detail") = "BASE", py::arg("close_root") = true, py::arg("close_tips") = true,
      py::arg("snow_resolution") = 1024, py::arg("max_influences") = 4, py::arg("threads") = 0,
      py::arg("progress") = py::none(), py::arg("root_bone") = true,
      R"(Rebuilds a tree as one continuous, rigged, weighted and unwrapped quad mesh.

width: ORIGINAL or INVERSE; species: BROADLEAF or EVERGREEN; detail: BASE (limbs of four
sides), or DRAFT, GAME, DEFAULT or FILM: sides by thickness, curved limbs, forks with fillets. root_bone: a tree of several roots has one
more bone, the first, that they hang from. threads: 0 = one per core; does not change the mesh. progress(share) is called
regularly; returning False (not None) cancels with KeyboardInterrupt. Raises ValueError for
options out of range.)");

  module.def(
      "reduce_bones",
      [](const BoundMesh& source, int max_bones, int max_bone_level) {
        ReleasedGil release;
        auto bound = std::make_unique<BoundMesh>(source);
        ReducedBones reduced = reduce_bones(source.mesh.bones, {max_bones, max_bone_level});
        remap_weights(reduced.bone_map, bound->mesh.bone_indices, bound->mesh.bone_weights);
        bound->mesh.bones = std::move(reduced.bones);
        bound->bone_map = std::move(reduced.bone_map);
        return bound;
      },
      py::arg("mesh"), py::arg("max_bones") = BoneBudget{}.max_bones,
      py::arg("max_bone_level") = BoneBudget{}.max_bone_level,
      R"(A copy of the mesh without its deepest bones (0 and -1: no limit); the nearest kept
ancestors receive their weights. Its bone_map holds the new bone of each old one.)");

  module.def(
      "leaf_bones",
      [](const Skeleton& skeleton, const BoundMesh& mesh) {
        std::vector<int32_t> bones;
        {
          ReleasedGil release;
          bones = leaf_bones(skeleton, mesh.mesh.bones);
        }
        const py::ssize_t count = size(bones.size());
        return to_numpy<int32_t>(std::move(bones), {count});
      },
      py::arg("skeleton"), py::arg("mesh"),
      "(L,) per leaf of skeleton.foliage: the bone of its branch nearest to its attach point.");

  module.def(
      "original_uvs",
      [](const Skeleton& skeleton, const BoundMesh& mesh, int threads, const py::object& progress) {
        OriginalUvs found = run_cancellable(progress, [&](const base::Progress& asked) {
          return original_uvs(skeleton, mesh.mesh, {threads, asked});
        });
        return uvs_to_numpy(std::move(found));
      },
      py::arg("skeleton"), py::arg("mesh"), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      R"((uv (F, 4, 2) or None, material (F,)): the export's own texture coordinates and materials
for a mesh that was built from `skeleton`, looked up on each branch's own polygons. Faces of pieces
without coordinates have those of uv_bark; None: no piece has any. material: index into
skeleton.wood_materials, -1 = none.)");

  module.def(
      "base_uvs",
      [](const BoundMesh& mesh, const std::optional<InputArray<float>>& uv,
         const InputArray<int32_t>& material) {
        OriginalUvs fine;
        if (uv) {
          if (uv->ndim() != 3 || uv->shape(1) != 4 || uv->shape(2) != 2) {
            throw std::invalid_argument("uv must have shape (F, 4, 2)");
          }
          const auto* begin = reinterpret_cast<const QuadUv*>(uv->data());
          fine.uv.assign(begin, begin + uv->shape(0));
        }
        fine.material.assign(material.data(), material.data() + material.size());
        OriginalUvs found;
        {
          ReleasedGil release;
          found = base_uvs(mesh.mesh, fine);
        }
        return uvs_to_numpy(std::move(found));
      },
      py::arg("mesh"), py::arg("uv"), py::arg("material"),
      R"(The same (uv, material) for the quads of the four-sided base from which `mesh` was refined.
uv, material: those of `mesh`, from original_uvs.)");

  module.def(
      "quad_edges",
      [](const InputArray<int32_t>& quads, size_t vertices) {
        const auto faces = rows_from_numpy<Quad, int32_t, 4>(quads, "quads");
        for (const Quad& quad : faces) {
          for (const int32_t v : quad) {
            if (v < 0 || static_cast<size_t>(v) >= vertices) {
              throw std::invalid_argument("quads refer to vertex " + std::to_string(v) +
                                          ", but there are " + std::to_string(vertices));
            }
          }
        }
        std::vector<std::array<int32_t, 2>> ends;
        std::vector<std::array<int32_t, 4>> of_face;
        {
          ReleasedGil release;
          Edges edges(faces, vertices);
          ends.reserve(edges.all.size());
          for (const Edges::Edge& edge : edges.all) ends.push_back({edge.a, edge.b});
          of_face = std::move(edges.of_face);
        }
        const auto count = static_cast<py::ssize_t>(ends.size());
        const auto quad_count = static_cast<py::ssize_t>(of_face.size());
        return py::make_tuple(to_numpy<int32_t>(std::move(ends), {count, 2}),
                              to_numpy<int32_t>(std::move(of_face), {quad_count, 4}));
      },
      py::arg("quads"), py::arg("vertices"),
      R"(The edges of a quad mesh with so many vertices: (ends, of_quad). ends (E, 2) int32: their vertices,
the lower one first; of_quad (F, 4) int32: the edge from each corner to the next.)");

  module.def(
      "check_mesh",
      [](const InputArray<float>& vertices, const InputArray<int32_t>& quads) {
        const auto points = rows_from_numpy<glm::vec3, float, 3>(vertices, "vertices");
        const auto faces = rows_from_numpy<Quad, int32_t, 4>(quads, "quads");
        MeshCheck check;
        {
          ReleasedGil release;
          check = check_mesh(points, faces);
        }
        return check_dict(check);
      },
      py::arg("vertices"), py::arg("quads"),
      R"(Checks a quad mesh: components, euler (one number per component), boundary_edges,
nonmanifold_edges, nonmanifold_faces, flipped_edges, zero_area_faces, unused_vertices, winding_ok,
closed, volume.)");
}

}  // namespace

void bind_tree(py::module_& module) {
  bind_mesh_class(module);
  bind_mesh_functions(module);
}

}  // namespace snowbough::python
