#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Reads the material libraries of an OBJ file that stand beside it; where it names none, or none
/// of those it names is there, the one that has its own name.
///
/// Takes `Kd`, `d`, `Tr`, `Tf`, `map_Kd`, `map_d`, `map_Ks`, `map_bump` (also `bump`) and `norm`
/// (also `map_Kn`), with the texture options -s, -o and -bm and names with blanks or in quotes. A
/// `map_bump` whose file is called a normal map (normal, nrm, nor, norm between its words, or a
/// mere n at its end) is one. Textures are looked for at the path given, below the folders of the
/// library and of the OBJ, and by their bare name beside both, in the folders named textures,
/// texture, maps, tex or images beside or above them, and in the folders within those beside; upper
/// and lower case are the same. In place of one that is missing the only image is taken that has
/// its name but another ending.
///
/// @param obj_path the OBJ file.
/// @param libraries as the OBJ names them.
/// @param used names of the materials that are wanted: what others lack is nobody's loss.
/// @param outside_files whether files are read that lie, links followed, neither below the OBJ's
///   folder nor below the folder above it: a downloaded library may name any file.
/// @param warnings receives one line for every library and texture that is missing, with its name
///   and what is taken for it, and for every malformed line, with file and line.
/// @return materials by name; of a name that comes twice, the first.
///
/// Format: Wavefront, "MTL material format (Lightwave, OBJ)", 1995.
std::map<std::string, ObjMaterial> read_materials(const std::string& obj_path,
                                                  const std::vector<std::string>& libraries,
                                                  const std::set<std::string>& used,
                                                  bool outside_files,
                                                  std::vector<std::string>& warnings);

}  // namespace snowbough::tree
