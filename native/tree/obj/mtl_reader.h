#pragma once

#include <map>
#include <string>
#include <vector>

#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

/// Reads the material libraries of an OBJ file that stand beside it.
///
/// Takes `Kd`, `d`, `Tr`, `map_Kd` and `map_d`, with texture options and names with blanks.
/// Textures are looked for at the path given, below the library's folder, and by their bare name
/// beside the library and in its folders named textures, texture, maps, tex or images; upper and
/// lower case are the same.
///
/// @param obj_path the OBJ file.
/// @param libraries as the OBJ names them.
/// @param warnings receives one line for every library and texture that is missing, with its name,
///   and for every malformed line, with file and line.
/// @return materials by name; of a name that comes twice, the first.
///
/// Format: Wavefront, "MTL material format (Lightwave, OBJ)", 1995.
std::map<std::string, FoliageMaterial> read_materials(const std::string& obj_path,
                                                      const std::vector<std::string>& libraries,
                                                      std::vector<std::string>& warnings);

}  // namespace snowbough::tree
