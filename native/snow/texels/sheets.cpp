#include "snow/texels/sheets.h"

#include "base/union_find.h"

namespace snowbough::snow {

Sheets find_sheets(const std::vector<int32_t>& triangles, int32_t vertex_count) {
  base::UnionFind vertices(vertex_count);
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    vertices.join(triangles[t], triangles[t + 1]);
    vertices.join(triangles[t], triangles[t + 2]);
  }
  Sheets sheets;
  sheets.sheet.reserve(triangles.size() / 3);
  std::vector<int32_t> sheet_of_root(static_cast<size_t>(vertex_count), -1);
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    int32_t& sheet = sheet_of_root[static_cast<size_t>(vertices.find(triangles[t]))];
    if (sheet < 0) sheet = sheets.count++;
    sheets.sheet.push_back(sheet);
  }
  return sheets;
}

}  // namespace snowbough::snow
