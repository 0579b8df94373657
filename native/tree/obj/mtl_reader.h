#pragma once

#include <map>
#include <string>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Reads the material libraries of an OBJ file that stand beside it; where it names none, or none
/// of those it names is there, the one that has its own name.
///
/// Takes `Kd`, `d`, `Tr`, `Tf`, `map_Kd`, `map_d`, `map_Ks`, `map_bump` (also `bump`) and `norm`
/// (also `map_Kn`), with the texture options -s, -o and -bm and names with blanks. A `map_bump`
/// whose file is called a normal map (normal, nrm, nor, norm between its words) is one. Textures
/// are looked for at the path given, below the folders of the library and of the OBJ, and by their
/// bare name beside both and in the folders named textures, texture, maps, tex or images beside or
/// above them; upper and lower case are the same.
///
/// @param obj_path the OBJ file.
/// @param libraries as the OBJ names them.
/// @param warnings receives one line for every library and texture that is missing, with its name,
///   and for every malformed line, with file and line.
/// @return materials by name; of a name that comes twice, the first.
///
/// Format: Wavefront, "MTL material format (Lightwave, OBJ)", 1995.
std::map<std::string, ObjMaterial> read_materials(const std::string& obj_path,
                                                  const std::vector<std::string>& libraries,
                                                  std::vector<std::string>& warnings);

}  // namespace snowbough::tree
