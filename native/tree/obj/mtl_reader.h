#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Reads the material libraries of an OBJ file that are in its folder; if it names none, or none
/// that exists, the library with the OBJ's own name.
///
/// Supports `Kd`, `d`, `Tr`, `Tf`, `map_Kd`, `map_d`, `map_Ks`, `map_bump` (also `bump`) and `norm`
/// (also `map_Kn`), with the texture options -s, -o and -bm and names with blanks or in quotes. A
/// `map_bump` whose file name marks a normal map (the words normal, nrm, nor or norm, or a final n)
/// counts as `norm`. Textures are searched at the given path, below the folders of the library and
/// of the OBJ, and by file name in both folders, in folders named textures, texture, maps, tex or
/// images in or above them, and in the subfolders of those inside them, ignoring case. A missing
/// texture is replaced by the only image with its name and another extension.
///
/// @param obj_path the OBJ file.
/// @param libraries as the OBJ names them.
/// @param used names of the materials in use: missing textures of others are not reported.
/// @param outside_files whether to read files that are, after resolving links, outside the OBJ's
///   folder and its parent folder: a downloaded library may name any file.
/// @param warnings receives one line per missing library and texture, with its name and
///   replacement, and per malformed line, with file and line.
/// @return materials by name; the first of a repeated name.
///
/// Format: Wavefront, "MTL material format (Lightwave, OBJ)", 1995.
std::map<std::string, ObjMaterial> read_materials(const std::string& obj_path,
                                                  const std::vector<std::string>& libraries,
                                                  const std::set<std::string>& used,
                                                  bool outside_files,
                                                  std::vector<std::string>& warnings);

}  // namespace snowbough::tree
