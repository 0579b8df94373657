#include "tree/obj/obj_fragment.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "tree/obj/text.h"

namespace snowbough::tree {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// A cursor over one logical line.
struct Line {
  const char* at;
  const char* end;

  void skip_blanks() {
    while (at != end && is_blank(*at)) ++at;
  }
  bool done() {
    skip_blanks();
    return at == end;
  }
  std::string_view token() {
    skip_blanks();
    const char* begin = at;
    while (at != end && !is_blank(*at)) ++at;
    return {begin, static_cast<size_t>(at - begin)};
  }
  std::string_view rest() {
    skip_blanks();
    const char* last = end;
    while (last != at && is_blank(last[-1])) --last;
    return {at, static_cast<size_t>(last - at)};
  }
};

/// Parses the usual numbers of an OBJ: up to 15 digits with or without a point, up to a blank or
/// the end of the line. Mantissa and power of ten are then exact, and their quotient is rounded
/// correctly (W. D. Clinger, PLDI 1990).
/// @param at  becomes the end of the number if it is one of these, otherwise stays.
bool plain_decimal(const char*& at, const char* end, double& value) {
  constexpr std::array kPowers{1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                               1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const char* from = at;
  const bool negative = from != end && *from == '-';
  if (negative) ++from;
  // Too many digits overflow, and are rejected.
  uint64_t mantissa = 0;
  const auto take_digits = [&] {
    const char* first = from;
    for (; from != end; ++from) {
      const auto digit = static_cast<unsigned char>(*from - '0');
      if (digit > 9) break;
      mantissa = 10 * mantissa + digit;
    }
    return static_cast<size_t>(from - first);
  };
  size_t digits = take_digits();
  size_t decimals = 0;
  if (from != end && *from == '.') {
    ++from;
    decimals = take_digits();
    digits += decimals;
  }
  if (digits == 0 || digits > 15 || (from != end && !is_blank(*from))) return false;
  value = static_cast<double>(mantissa) / kPowers[decimals];
  if (negative) value = -value;
  at = from;
  return true;
}

/// Parses an index of up to nine digits; 0 for anything else.
int64_t plain_index(const char*& at, const char* end) {
  int64_t value = 0;
  const char* from = at;
  for (; from != end && from - at < 10; ++from) {
    const auto digit = static_cast<unsigned char>(*from - '0');
    if (digit > 9) break;
    value = 10 * value + digit;
  }
  if (from - at > 9) return 0;
  if (value > 0) at = from;
  return value;
}

/// Numbers distinct names in order of appearance.
class NameTable {
 public:
  explicit NameTable(std::vector<std::string>& names) : names_(names) {}

  int32_t index(std::string_view name) {
    const auto [found, added] =
        numbers_.try_emplace(std::string(name), static_cast<int32_t>(names_.size()));
    if (added) names_.push_back(to_utf8(name));
    return found->second;
  }

 private:
  std::vector<std::string>& names_;
  std::unordered_map<std::string, int32_t> numbers_;
};

/// Why a line is invalid.
struct BadLine {
  std::string why;
};

[[noreturn]] void fail(std::string why) {
  throw BadLine{std::move(why)};
}

class FragmentParser {
 public:
  FragmentParser(const ObjCounts& known, const glm::dvec3& origin)
      : known_(known), origin_(origin), groups_(scene_.names), materials_(scene_.materials) {}

  ObjFragment take() { return std::move(fragment_); }

  /// @return false if the line is invalid; the fragment holds the reason.
  bool parse(const char* begin, const char* end) {
    try {
      parse_line(begin, end);
      return true;
    } catch (BadLine& bad) {
      fragment_.error = std::move(bad.why);
      fragment_.error_line = fragment_.line_count;
      forget_corners();
      return false;
    }
  }

  void add_lines(int64_t count) { fragment_.line_count += count; }

 private:
  void parse_line(const char* begin, const char* end) {
    Line line{begin, end};
    const std::string_view keyword = line.token();
    if (keyword.empty() || keyword[0] == '#') return;
    if (keyword == "v") {
      const float x = number(line, origin_.x);
      const float y = number(line, origin_.y);
      const float z = number(line, origin_.z);
      scene_.positions.emplace_back(x, y, z);
    } else if (keyword == "vt") {
      const float u = number(line);
      const float v = line.done() ? 0.0f : number(line);
      scene_.uvs.emplace_back(u, v);
    } else if (keyword == "vn") {
      const float x = number(line);
      const float y = number(line);
      const float z = number(line);
      scene_.normals.emplace_back(x, y, z);
    } else if (keyword == "f" || keyword == "fo") {
      parse_face(line);
    } else if (keyword == "g") {
      // A bare `g` ends the group; the following faces belong to the default group.
      const std::string_view group = line.rest();
      run_.group = group.empty() ? -1 : groups_.index(group);
    } else if (keyword == "o") {
      // A new object ends the previous object's group.
      const std::string_view object = line.rest();
      run_.object = object.empty() ? -1 : groups_.index(object);
      run_.group = -1;
    } else if (keyword == "usemtl") {
      const std::string_view material = line.rest();
      run_.material = material.empty() ? -1 : materials_.index(material);
    } else if (keyword == "mtllib") {
      const std::string_view library = line.rest();
      if (!library.empty()) scene_.material_libraries.push_back(to_utf8(library));
    } else if (keyword == "l" || keyword == "p") {
      ++scene_.loose_elements;
    }
  }

  static double any_number(const char* begin, const char* end, std::string_view token) {
    double value = 0.0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error == std::errc::result_out_of_range && stop == end) {
      // Values that are too small become 0, those that are too large infinity.
      return std::strtod(std::string(token).c_str(), nullptr);
    }
    if (error != std::errc() || stop != end) fail("malformed number '" + to_utf8(token) + "'");
    return value;
  }

  static float number(Line& line, double origin = 0.0) {
    line.skip_blanks();
    const char* begin = line.at;
    double value = 0.0;
    if (!plain_decimal(line.at, line.end, value)) {
      const std::string_view token = line.token();
      if (token.empty()) fail("a number is missing");
      const char* end = begin + token.size();
      value = any_number(*begin == '+' ? begin + 1 : begin, end, token);
    }
    const auto single = static_cast<float>(value - origin);
    if (!std::isfinite(single)) {
      fail("number '" + std::string(begin, line.at) + "' is not finite");
    }
    return single;
  }

  int64_t count_of(ObjIndex kind) const {
    switch (kind) {
      case ObjIndex::kVertex:
        return static_cast<int64_t>(scene_.positions.size());
      case ObjIndex::kUv:
        return static_cast<int64_t>(scene_.uvs.size());
      default:
        return static_cast<int64_t>(scene_.normals.size());
    }
  }

  /// One zero-based index of a face corner at `at`; 0 for a relative one, which is recorded.
  int32_t index(const char*& at, const char* end, ObjIndex kind, const char* what) {
    const auto number = static_cast<int>(kind);
    const int64_t count = count_of(kind);
    int64_t value = plain_index(at, end);
    if (value == 0) {
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error == std::errc::result_out_of_range) {
        fail(std::string(what) + " index is out of range");
      }
      if (error != std::errc()) fail(std::string("malformed ") + what + " index");
      at = stop;
      if (value == 0) fail(std::string(what) + " index 0: OBJ counts from 1");
    }
    if (value < 0) {
      const auto corner = static_cast<int32_t>(scene_.corner_vertex.size());
      fragment_.relative.push_back({kind, corner, fragment_.line_count, value, count});
      return 0;
    }
    if (value > known_.of[number] + count) {
      // Valid if the element is before the fragment or later in the file.
      if (value > std::numeric_limits<int32_t>::max()) {
        fail(std::string(what) + " index " + std::to_string(value) + " is out of range");
      }
      std::vector<ForwardIndex>& forward = fragment_.forward[number];
      if (forward.empty() || value > forward.back().index) {
        forward.push_back({value, fragment_.line_count});
      }
    }
    return static_cast<int32_t>(value - 1);
  }

  /// Sets an index of the last corner. An array without any index stays empty.
  void add_to_corner(int32_t index, std::vector<int32_t>& indices) const {
    if (index < 0 && indices.empty()) return;
    indices.resize(scene_.corner_vertex.size(), -1);
    indices.back() = index;
  }

  void parse_face(Line& line) {
    const size_t first_corner = scene_.corner_vertex.size();
    const size_t first_relative = fragment_.relative.size();
    const bool had_uvs = !scene_.corner_uv.empty();
    const bool had_normals = !scene_.corner_normal.empty();
    while (!line.done()) {
      const char* at = line.at;
      const int32_t vertex = index(at, line.end, ObjIndex::kVertex, "vertex");
      int32_t uv = -1;
      int32_t normal = -1;
      if (at != line.end && *at == '/') {
        ++at;
        if (at != line.end && *at != '/' && !is_blank(*at)) {
          uv = index(at, line.end, ObjIndex::kUv, "texture coordinate");
        }
        if (at != line.end && *at == '/') {
          ++at;
          if (at != line.end && !is_blank(*at)) {
            normal = index(at, line.end, ObjIndex::kNormal, "normal");
          }
        }
      }
      if (at != line.end && !is_blank(*at)) {
        Line corner{line.at, line.end};
        fail("malformed face corner '" + to_utf8(corner.token()) + "'");
      }
      line.at = at;
      scene_.corner_vertex.push_back(vertex);
      add_to_corner(uv, scene_.corner_uv);
      add_to_corner(normal, scene_.corner_normal);
    }
    if (scene_.corner_vertex.size() - first_corner < 3) {
      leave_out(first_corner, first_relative, had_uvs, had_normals);
      return;
    }
    if (scene_.runs.empty() || run_.group != scene_.runs.back().group ||
        run_.object != scene_.runs.back().object || run_.material != scene_.runs.back().material) {
      run_.first_face = scene_.face_count();
      scene_.runs.push_back(run_);
    }
    scene_.face_begin.push_back(static_cast<int32_t>(scene_.corner_vertex.size()));
  }

  /// Drops a face with too few corners after checking its indices.
  void leave_out(size_t first_corner, size_t first_relative, bool had_uvs, bool had_normals) {
    scene_.corner_vertex.resize(first_corner);
    scene_.corner_uv.resize(had_uvs ? first_corner : 0);
    scene_.corner_normal.resize(had_normals ? first_corner : 0);
    for (size_t i = first_relative; i < fragment_.relative.size(); ++i) {
      fragment_.relative[i].corner = -1;
    }
    ++scene_.short_faces;
  }

  /// After an invalid line: its relative indices are only checked, since its corners are
  /// incomplete.
  void forget_corners() {
    for (RelativeIndex& entry : fragment_.relative) {
      if (entry.line == fragment_.line_count) entry.corner = -1;
    }
  }

  ObjFragment fragment_;
  ObjScene& scene_ = fragment_.scene;
  FaceRun& run_ = fragment_.last;
  ObjCounts known_;
  glm::dvec3 origin_;
  NameTable groups_;
  NameTable materials_;
};

/// The end of the logical line that starts at `begin`: continuation lines are joined in place by
/// blanking the backslash and the line break. Null if the buffer ends before the line does.
/// Comments are not joined, since they may end in Windows paths.
char* join_logical_line(char* begin, char* end, int64_t& breaks_joined) {
  char* from = begin;
  const bool comment = begin != end && *begin == '#';
  breaks_joined = 0;
  while (true) {
    auto* stop = static_cast<char*>(std::memchr(from, '\n', static_cast<size_t>(end - from)));
    if (stop == nullptr) return nullptr;
    char* last = stop;
    if (last != begin && last[-1] == '\r') --last;
    if (comment || last == begin || last[-1] != '\\') return stop;
    ++breaks_joined;
    std::fill(last - 1, stop + 1, ' ');
    from = stop + 1;
  }
}

}  // namespace

ObjFragment read_obj_fragment(char* begin, char* end, const ObjCounts& known,
                              const glm::dvec3& origin) {
  FragmentParser parser(known, origin);
  while (begin != end) {
    int64_t joined = 0;
    char* stop = join_logical_line(begin, end, joined);
    if (stop == nullptr) {
      // The file ends without a line break or in a continuation: the joined text is the last line.
      parser.parse(begin, end);
      break;
    }
    if (!parser.parse(begin, stop)) break;
    parser.add_lines(1 + joined);
    begin = stop + 1;
  }
  return parser.take();
}

}  // namespace snowbough::tree
