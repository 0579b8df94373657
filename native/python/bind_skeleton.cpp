#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "bindings.h"
#include "numpy_arrays.h"
#include "python_progress.h"
#include "tree/read_tree.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::python {
namespace {

using tree::Branch;
using tree::Foliage;
using tree::ImportReport;
using tree::KeptSurface;
using tree::MaterialTexture;
using tree::ObjMaterial;
using tree::PolygonMesh;
using tree::ReadTreeOptions;
using tree::Simplify;
using tree::Skeleton;
using tree::UpAxis;

UpAxis up_axis_from(const std::string& name) {
  if (name == "AUTO") return UpAxis::kAuto;
  if (name == "Y") return UpAxis::kY;
  if (name == "Z") return UpAxis::kZ;
  throw std::invalid_argument("up_axis must be AUTO, Y or Z, not '" + name + "'");
}

Simplify simplify_from(const std::string& name) {
  if (name == "NONE") return Simplify::kNone;
  if (name == "THESIS") return Simplify::kThesis;
  if (name == "TOLERANCE") return Simplify::kTolerance;
  throw std::invalid_argument("simplify must be NONE, THESIS or TOLERANCE, not '" + name + "'");
}

/// foliage: a bool, "AUTO" (keep it), "NONE" (leave it out), or the name prefixes of foliage.
void set_foliage(const py::object& foliage, ReadTreeOptions& options) {
  if (py::isinstance<py::bool_>(foliage)) {
    options.foliage = foliage.cast<bool>();
    return;
  }
  if (!py::isinstance<py::str>(foliage)) {
    throw std::invalid_argument(
        "foliage must be True, False, 'AUTO', 'NONE' or name prefixes separated by commas");
  }
  const auto text = foliage.cast<std::string>();
  options.foliage = text != "NONE";
  if (options.foliage && text != "AUTO") options.foliage_names = text;
}

std::string path_from(const py::object& path) {
  // os.fsdecode takes str, bytes and pathlib.Path.
  return py::module_::import("os").attr("fsdecode")(path).cast<std::string>();
}

ReadTreeOptions read_options(const std::string& up_axis, const std::string& levels,
                             const std::string& simplify, float tolerance,
                             const py::object& foliage, double unit, double height,
                             bool keep_surface, const py::object& bones) {
  ReadTreeOptions options;
  options.keep_surface = keep_surface;
  options.bones = path_from(bones);
  options.up_axis = up_axis_from(up_axis);
  options.levels = levels;
  options.simplify = simplify_from(simplify);
  options.tolerance = tolerance;
  options.unit = unit;
  options.height = height;
  set_foliage(foliage, options);
  return options;
}

Skeleton read_tree(const py::object& path, const std::string& up_axis, const std::string& levels,
                   const std::string& simplify, float tolerance, const py::object& foliage,
                   double unit, double height, const py::object& progress, bool outside_files,
                   bool keep_surface, const py::object& bones) {
  ReadTreeOptions options = read_options(up_axis, levels, simplify, tolerance, foliage, unit,
                                         height, keep_surface, bones);
  options.outside_files = outside_files;
  const std::string file = path_from(path);
  return run_cancellable(progress, [&](const base::Progress& asked) {
    options.progress = asked;
    return tree::read_tree(file, options);
  });
}

std::vector<int32_t> indices_from(const InputArray<int32_t>& array, size_t below,
                                  const std::string& what) {
  if (array.ndim() != 1) throw std::invalid_argument(what + " must have shape (N,)");
  std::vector<int32_t> indices(array.data(), array.data() + array.size());
  for (const int32_t index : indices) {
    if (index >= 0 && index < static_cast<int64_t>(below)) continue;
    throw std::invalid_argument(what + " holds " + std::to_string(index) + ", out of range");
  }
  return indices;
}

tree::ObjScene scene_from_arrays(size_t vertices, const InputArray<int32_t>& face_begin,
                                 const InputArray<int32_t>& corner_vertex,
                                 const std::optional<InputArray<float>>& corner_uv,
                                 const std::optional<InputArray<float>>& corner_normal,
                                 const InputArray<int32_t>& face_names,
                                 std::vector<std::string> names,
                                 std::vector<std::string> materials) {
  tree::ObjScene scene;
  scene.corner_vertex = indices_from(corner_vertex, vertices, "corner_vertex");
  scene.face_begin = indices_from(face_begin, scene.corner_vertex.size() + 1, "face_begin");
  const bool faces_have_corners =
      scene.face_begin.size() > 1 && scene.face_begin.front() == 0 &&
      scene.face_begin.back() == static_cast<int32_t>(scene.corner_vertex.size()) &&
      std::adjacent_find(scene.face_begin.begin(), scene.face_begin.end(),
                         [](int32_t a, int32_t b) { return b < a + 3; }) == scene.face_begin.end();
  if (!faces_have_corners) {
    throw std::invalid_argument(
        "face_begin must rise by at least 3 from 0 to the number of corners");
  }
  const auto chosen = rows_from_numpy<std::array<int32_t, 2>, int32_t, 2>(face_names, "face_names");
  if (chosen.size() + 1 != scene.face_begin.size()) {
    throw std::invalid_argument("face_names must have a row for each face");
  }
  for (size_t f = 0; f < chosen.size(); ++f) {
    const auto [object, material] = chosen[f];
    if (object < -1 || object >= static_cast<int64_t>(names.size()) || material < -1 ||
        material >= static_cast<int64_t>(materials.size())) {
      throw std::invalid_argument("face_names: row " + std::to_string(f) + " is out of range");
    }
    if (f > 0 && chosen[f] == chosen[f - 1]) continue;
    scene.runs.push_back({static_cast<int32_t>(f), object, -1, material});
  }
  const auto own_row = [&](size_t rows, const std::string& what, std::vector<int32_t>& index) {
    if (rows != scene.corner_vertex.size()) {
      throw std::invalid_argument(what + " must have a row for each corner");
    }
    index.resize(rows);
    std::iota(index.begin(), index.end(), 0);
  };
  if (corner_uv) {
    scene.uvs = rows_from_numpy<glm::vec2, float, 2>(*corner_uv, "corner_uv");
    own_row(scene.uvs.size(), "corner_uv", scene.corner_uv);
  }
  if (corner_normal) {
    scene.normals = rows_from_numpy<glm::vec3, float, 3>(*corner_normal, "corner_normal");
    own_row(scene.normals.size(), "corner_normal", scene.corner_normal);
  }
  scene.names = std::move(names);
  scene.materials = std::move(materials);
  return scene;
}

Skeleton read_tree_mesh(const std::string& name, const InputArray<double>& vertices,
                        const InputArray<int32_t>& face_begin,
                        const InputArray<int32_t>& corner_vertex,
                        const std::optional<InputArray<float>>& corner_uv,
                        const InputArray<int32_t>& face_names, std::vector<std::string> names,
                        std::vector<std::string> materials,
                        const std::optional<InputArray<float>>& corner_normal,
                        const std::string& up_axis, const std::string& levels,
                        const std::string& simplify, float tolerance, const py::object& foliage,
                        double unit, double height, const py::object& progress, bool keep_surface,
                        const py::object& bones) {
  ReadTreeOptions options = read_options(up_axis, levels, simplify, tolerance, foliage, unit,
                                         height, keep_surface, bones);
  const auto positions = rows_from_numpy<glm::dvec3, double, 3>(vertices, "vertices");
  tree::ObjScene scene =
      scene_from_arrays(positions.size(), face_begin, corner_vertex, corner_uv, corner_normal,
                        face_names, std::move(names), std::move(materials));
  return run_cancellable(progress, [&](const base::Progress& asked) {
    options.progress = asked;
    return tree::read_tree(std::move(scene), positions, name, options);
  });
}

std::vector<float> floats_from(const py::handle& object, const std::string& what) {
  const auto array = InputArray<float>::ensure(object);
  if (!array || array.ndim() != 1) {
    PyErr_Clear();
    throw std::invalid_argument(what + " must be numbers of shape (N,)");
  }
  require_finite(array, what);
  return std::vector<float>(array.data(), array.data() + array.size());
}

glm::vec3 point_from(const py::handle& object, const std::string& what) {
  const std::vector<float> values = floats_from(object, what);
  if (values.size() != 3) throw std::invalid_argument(what + " must have shape (3,)");
  return {values[0], values[1], values[2]};
}

py::handle required(const py::dict& fields, const char* key, const std::string& what) {
  if (!fields.contains(key)) throw std::invalid_argument(what + " lacks '" + key + "'");
  return fields[key];
}

/// Reads one dict with name, level, parent, attach_point, points, radii, areas.
Branch branch_from_dict(const py::dict& fields, size_t index) {
  const std::string what = "branch " + std::to_string(index);
  Branch branch;
  try {
    branch.name = required(fields, "name", what).cast<std::string>();
    branch.level = required(fields, "level", what).cast<int32_t>();
    branch.parent = required(fields, "parent", what).cast<int32_t>();
  } catch (const py::cast_error&) {
    throw std::invalid_argument(what + ": name must be a string, level and parent integers");
  }
  const auto points = InputArray<float>::ensure(required(fields, "points", what));
  if (!points) {
    PyErr_Clear();
    throw std::invalid_argument(what + ": points must be numbers of shape (N, 3)");
  }
  branch.points = rows_from_numpy<glm::vec3, float, 3>(points, what + ": points");
  branch.radii = floats_from(required(fields, "radii", what), what + ": radii");
  branch.areas = floats_from(required(fields, "areas", what), what + ": areas");
  branch.attach_point = point_from(required(fields, "attach_point", what), what + ": attach_point");
  return branch;
}

Skeleton skeleton_from_branches(const py::sequence& branches) {
  Skeleton skeleton;
  for (size_t i = 0; i < branches.size(); ++i) {
    if (!py::isinstance<py::dict>(branches[i])) {
      throw std::invalid_argument("branch " + std::to_string(i) + " must be a dict");
    }
    skeleton.branches.push_back(branch_from_dict(branches[i].cast<py::dict>(), i));
  }
  skeleton.report.form = "FROM_BRANCHES";
  skeleton.report.up_axis = "Z";
  tree::complete_skeleton(skeleton);
  return skeleton;
}

py::dict report_dict(const ImportReport& report) {
  py::list skipped;
  for (const auto& [name, why] : report.skipped_parts) {
    skipped.append(py::dict(py::arg("name") = name, py::arg("reason") = why));
  }
  return py::dict(py::arg("form") = report.form, py::arg("up_axis") = report.up_axis,
                  py::arg("branches_per_level") = report.branches_per_level,
                  py::arg("skipped_parts") = skipped, py::arg("extra_roots") = report.extra_roots,
                  py::arg("foliage_parts") = report.foliage_parts,
                  py::arg("wood_name") = report.wood_name, py::arg("coverage") = report.coverage,
                  py::arg("warnings") = report.warnings);
}

py::ssize_t count_of(const auto& values) {
  return static_cast<py::ssize_t>(values.size());
}

/// A read-only (N,) or (N, Columns) view of a member vector, kept alive by its object.
template <typename Class, typename Scalar, int Columns, typename Element>
auto array_view(std::vector<Element> Class::*member) {
  return [member](const py::object& self) {
    const std::vector<Element>& values = self.cast<const Class&>().*member;
    std::vector<py::ssize_t> shape{count_of(values)};
    if constexpr (Columns > 1) shape.push_back(Columns);
    return view_numpy<Scalar>(values, std::move(shape), self);
  };
}

py::array_t<float> point_array(const glm::vec3& point) {
  return copied_numpy(&point.x, 3);
}

py::tuple pair_of(const glm::vec2& pair) {
  return py::make_tuple(pair.x, pair.y);
}

}  // namespace

void bind_skeleton(py::module_& module) {
  py::class_<Branch>(module, "Branch", "One limb from its root to its tip; metres, Z up.")
      .def_readonly("name", &Branch::name)
      .def_readonly("level", &Branch::level, "0 is the trunk.")
      .def_readonly("parent", &Branch::parent, "Index of the parent branch, -1 for a root.")
      .def_property_readonly(
          "attach_point", [](const Branch& branch) { return point_array(branch.attach_point); },
          "(3,): attach point on the parent's centreline.")
      .def_property_readonly("points", array_view<Branch, float, 3>(&Branch::points),
                             "(N, 3): centres of the rings, root to tip.")
      .def_property_readonly("radii", array_view<Branch, float, 1>(&Branch::radii), "(N,)")
      .def_property_readonly("areas", array_view<Branch, float, 1>(&Branch::areas), "(N,) in m2.");

  py::class_<MaterialTexture>(module, "MaterialTexture", "A texture of a material.")
      .def_property_readonly(
          "path",
          [](const MaterialTexture& texture) {
            // A file name may not be valid UTF-8.
            return py::module_::import("os").attr("fsdecode")(py::bytes(texture.path));
          },
          "Absolute path of an existing file, or empty.")
      .def_property_readonly(
          "scale", [](const MaterialTexture& texture) { return pair_of(texture.scale); },
          "(u, v): the texture is sampled at uv * scale + offset.")
      .def_property_readonly(
          "offset", [](const MaterialTexture& texture) { return pair_of(texture.offset); });

  py::class_<ObjMaterial>(module, "ObjMaterial", "A material of the export's MTL file.")
      .def_readonly("name", &ObjMaterial::name)
      .def_readonly("defined", &ObjMaterial::defined, "Whether a library defines it.")
      .def_property_readonly(
          "diffuse", [](const ObjMaterial& material) { return point_array(material.diffuse); })
      .def_readonly("opacity", &ObjMaterial::opacity)
      .def_property_readonly(
          "transmission",
          [](const ObjMaterial& material) { return point_array(material.transmission); },
          "Tf: colour of the transmitted light; white by default.")
      .def_readonly("bump_strength", &ObjMaterial::bump_strength)
      .def_readonly("diffuse_texture", &ObjMaterial::diffuse_texture)
      .def_readonly("alpha_texture", &ObjMaterial::alpha_texture)
      .def_readonly("specular_texture", &ObjMaterial::specular_texture)
      .def_readonly("bump_texture", &ObjMaterial::bump_texture)
      .def_readonly("normal_texture", &ObjMaterial::normal_texture);

  py::class_<PolygonMesh>(module, "PolygonMesh", "Polygons of the file; metres, Z up.")
      .def_property_readonly("vertices", array_view<PolygonMesh, float, 3>(&PolygonMesh::vertices),
                             "(V, 3)")
      .def_property_readonly("face_begin",
                             array_view<PolygonMesh, int32_t, 1>(&PolygonMesh::face_begin),
                             "(F + 1,): face f owns corners [face_begin[f], face_begin[f + 1]).")
      .def_property_readonly(
          "corner_vertex", array_view<PolygonMesh, int32_t, 1>(&PolygonMesh::corner_vertex), "(C,)")
      .def_property_readonly("corner_uv",
                             array_view<PolygonMesh, float, 2>(&PolygonMesh::corner_uv), "(C, 2)")
      .def_property_readonly("corner_normal",
                             array_view<PolygonMesh, float, 3>(&PolygonMesh::corner_normal),
                             "(C, 3): unit normals, zero for none; (0, 3) if all are flat.")
      .def_property_readonly("face_material",
                             array_view<PolygonMesh, int32_t, 1>(&PolygonMesh::face_material),
                             "(F,): index into materials, -1 = none.")
      .def_readonly("materials", &PolygonMesh::materials);

  py::class_<Foliage, PolygonMesh>(module, "Foliage", "Leaves, needles and flowers as in the file.")
      .def_property_readonly("face_leaf", array_view<Foliage, int32_t, 1>(&Foliage::face_leaf),
                             "(F,)")
      .def_property_readonly("leaf_branch", array_view<Foliage, int32_t, 1>(&Foliage::leaf_branch),
                             "(L,): index into the skeleton's branches.")
      .def_property_readonly("leaf_attach_point",
                             array_view<Foliage, float, 3>(&Foliage::leaf_attach_point), "(L, 3)");

  py::class_<KeptSurface, PolygonMesh>(module, "KeptSurface",
                                       "The wood as in the file; empty unless it was asked for.")
      .def_readonly("textured", &KeptSurface::textured,
                    "Whether any polygon has texture coordinates.")
      .def_readonly("flat", &KeptSurface::flat, "Whether its normals are those of flat polygons.")
      .def_property_readonly("vertex_branch",
                             array_view<KeptSurface, int32_t, 1>(&KeptSurface::vertex_branch),
                             "(V,): index into the skeleton's branches.");

  py::class_<Skeleton>(module, "Skeleton",
                       "Branches sorted so that a parent comes before its children.")
      .def_property_readonly(
          "branches",
          [](const py::object& self) {
            py::list branches;
            for (const Branch& branch : self.cast<const Skeleton&>().branches) {
              branches.append(py::cast(&branch, py::return_value_policy::reference_internal, self));
            }
            return branches;
          })
      .def_property_readonly(
          "report", [](const Skeleton& skeleton) { return report_dict(skeleton.report); },
          "dict: form, up_axis, branches_per_level, skipped_parts, extra_roots, foliage_parts, "
          "wood_name, coverage, warnings")
      .def_readonly("height", &Skeleton::height, "Extent of the wood along Z in metres.")
      .def_property_readonly(
          "origin",
          [](const Skeleton& skeleton) {
            const glm::dvec3& at = skeleton.origin;
            return py::make_tuple(at.x, at.y, at.z);
          },
          R"((x, y, z): origin of all points in the file's space, metres, Z up; not 0 for trees far
from the file's origin.)")
      .def_readonly("foliage", &Skeleton::foliage)
      .def_readonly("kept", &Skeleton::kept)
      .def_property_readonly(
          "wood_materials",
          [](const Skeleton& skeleton) -> const auto& { return skeleton.wood.materials; },
          "Materials of the wood's own polygons: see original_uvs.")
      .def_static(
          "from_branches", &skeleton_from_branches, py::arg("branches"),
          R"(A skeleton from dicts with name, level, parent (index or -1), attach_point (3,),
points (N, 3), radii (N,) and areas (N,); metres, Z up, parents before children. Raises ValueError
for anything else.)");

  module.def("read_tree", &read_tree, py::arg("path"), py::arg("up_axis") = "AUTO",
             py::arg("levels") = "", py::arg("simplify") = "NONE", py::arg("tolerance") = 0.5f,
             py::arg("foliage") = "AUTO", py::arg("unit") = 1.0, py::arg("height") = 0.0,
             py::arg("progress") = py::none(), py::arg("outside_files") = false,
             py::arg("keep_surface") = false, py::arg("bones") = "",
             R"(Reads a tree from a Wavefront OBJ file and finds its skeleton; Z up, metres.

levels: level names from the trunk on, separated by commas; '' derives them from the group names.

simplify: 'NONE', 'THESIS' or 'TOLERANCE'; tolerance: for TOLERANCE, in local radii.

foliage: 'AUTO' or True keeps leaves, 'NONE' or False leaves them out; any other string lists name
prefixes, separated by commas: exactly the parts whose group, object or material starts with one
of them are foliage.

unit: length of one unit of the file in metres; height: height of the wood in metres, 0 keeps the
height that unit gives.

outside_files: whether to read material libraries and textures outside the file's folder and its
parent folder.

keep_surface: whether to keep the wood's own polygons in `kept`.

bones: path of SpeedTree's raw XML of the same tree, whose bones become the skeleton; '' traces the
polygons. Needs keep_surface.

progress(share) is called regularly; returning False (not None) cancels with KeyboardInterrupt.
Raises ValueError with file and line for malformed input.)");

  module.def("read_tree_mesh", &read_tree_mesh, py::arg("name"), py::arg("vertices"),
             py::arg("face_begin"), py::arg("corner_vertex"), py::arg("corner_uv"),
             py::arg("face_names"), py::arg("names"), py::arg("materials"),
             py::arg("corner_normal") = py::none(), py::arg("up_axis") = "AUTO",
             py::arg("levels") = "", py::arg("simplify") = "NONE", py::arg("tolerance") = 0.5f,
             py::arg("foliage") = "AUTO", py::arg("unit") = 1.0, py::arg("height") = 0.0,
             py::arg("progress") = py::none(), py::arg("keep_surface") = false,
             py::arg("bones") = "",
             R"(As read_tree, for polygons that are already in memory; `name` stands for the file in
messages.

vertices (V, 3); face_begin (F + 1,): polygon f has the corners from face_begin[f] to
face_begin[f + 1]; corner_vertex (C,); corner_uv (C, 2) or None; face_names (F, 2): indices into
`names`, of objects, and into `materials`, -1 = none; corner_normal (C, 3) or None. Materials keep only
their names.)");
}

}  // namespace snowbough::python
