#include "tree/obj_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

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

/// Reads what nearly all numbers of an OBJ look like: up to 15 digits with or without a point.
/// Mantissa and power of ten are then exact, and so is the rounding of their quotient (W. D.
/// Clinger, PLDI 1990).
bool plain_decimal(const char* at, const char* end, double& value) {
  constexpr std::array kPowers{1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                               1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  int64_t mantissa = 0;
  size_t digits = 0;
  size_t decimals = 0;
  bool point = false;
  for (; at != end; ++at) {
    if (*at == '.' && !point) {
      point = true;
    } else if (*at >= '0' && *at <= '9' && digits < 15) {
      mantissa = 10 * mantissa + (*at - '0');
      ++digits;
      decimals += point ? 1 : 0;
    } else {
      return false;
    }
  }
  if (digits == 0) return false;
  value = static_cast<double>(mantissa) / kPowers[decimals];
  if (negative) value = -value;
  return true;
}

/// Gives every distinct name a number in the order of appearance.
class NameTable {
 public:
  explicit NameTable(std::vector<std::string>& names) : names_(names) {}

  int32_t index(std::string_view name) {
    const auto [found, added] =
        numbers_.try_emplace(std::string(name), static_cast<int32_t>(names_.size()));
    if (added) names_.emplace_back(name);
    return found->second;
  }

 private:
  std::vector<std::string>& names_;
  std::unordered_map<std::string, int32_t> numbers_;
};

/// An index that pointed past what had been read when it was met; judged at the end.
struct ForwardIndex {
  int64_t index = 0;
  int64_t line = 0;
};

class ObjParser {
 public:
  explicit ObjParser(std::string name)
      : name_(std::move(name)), groups_(scene_.names), materials_(scene_.materials) {}

  void parse_line(const char* begin, const char* end, int64_t line_number) {
    line_number_ = line_number;
    Line line{begin, end};
    const std::string_view keyword = line.token();
    if (keyword.empty() || keyword[0] == '#') return;
    if (keyword == "v") {
      const float x = number(line);
      const float y = number(line);
      const float z = number(line);
      check_room(scene_.positions.size(), "vertices");
      scene_.positions.emplace_back(x, y, z);
    } else if (keyword == "vt") {
      const float u = number(line);
      const float v = line.done() ? 0.0f : number(line);
      check_room(scene_.uvs.size(), "texture coordinates");
      scene_.uvs.emplace_back(u, v);
    } else if (keyword == "vn") {
      number(line);
      number(line);
      number(line);
      ++normal_count_;
    } else if (keyword == "f" || keyword == "fo") {
      parse_face(line);
    } else if (keyword == "g") {
      // A bare `g` ends the group; the faces after it belong to the default one.
      const std::string_view group = line.rest();
      run_.group = group.empty() ? -1 : groups_.index(group);
    } else if (keyword == "o") {
      // A new object ends the group of the one before.
      const std::string_view object = line.rest();
      run_.object = object.empty() ? -1 : groups_.index(object);
      run_.group = -1;
    } else if (keyword == "usemtl") {
      const std::string_view material = line.rest();
      run_.material = material.empty() ? -1 : materials_.index(material);
    } else if (keyword == "mtllib") {
      const std::string_view library = line.rest();
      if (!library.empty()) scene_.material_libraries.emplace_back(library);
    } else if (keyword == "l" || keyword == "p") {
      ++scene_.loose_elements;
    }
  }

  ObjScene finish() {
    check_forward(forward_vertex_, static_cast<int64_t>(scene_.positions.size()), "vertex");
    check_forward(forward_uv_, static_cast<int64_t>(scene_.uvs.size()), "texture coordinate");
    check_forward(forward_normal_, normal_count_, "normal");
    if (scene_.positions.empty() && scene_.face_count() == 0) {
      throw std::invalid_argument(
          name_ + ": holds no vertices and no faces; it is empty or no Wavefront OBJ file");
    }
    if (scene_.face_count() == 0) {
      throw std::invalid_argument(name_ +
                                  ": holds vertices but no faces; export the tree as polygons");
    }
    return std::move(scene_);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(name_ + ":" + std::to_string(line_number_) + ": " + what);
  }

 private:
  void check_room(size_t count, const char* what) const {
    if (count >= static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
      fail(std::string("more than 2147483647 ") + what);
    }
  }

  double any_number(const char* begin, const char* end, std::string_view token) const {
    double value = 0.0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error == std::errc::result_out_of_range && stop == end) {
      // Too small becomes 0 here, too large infinity.
      return std::strtod(std::string(token).c_str(), nullptr);
    }
    if (error != std::errc() || stop != end) fail("malformed number '" + std::string(token) + "'");
    return value;
  }

  float number(Line& line) const {
    const std::string_view token = line.token();
    if (token.empty()) fail("a number is missing");
    const char* begin = token.data();
    const char* end = begin + token.size();
    if (*begin == '+') ++begin;
    double value = 0.0;
    if (!plain_decimal(begin, end, value)) value = any_number(begin, end, token);
    const auto single = static_cast<float>(value);
    if (!std::isfinite(single)) fail("number '" + std::string(token) + "' is not finite");
    return single;
  }

  /// One index of a face corner at `at`: zero-based and never negative on return.
  int64_t index(const char*& at, const char* end, int64_t count, const char* what,
                std::vector<ForwardIndex>& forward) {
    int64_t value = 0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error == std::errc::result_out_of_range) fail(std::string(what) + " index is out of range");
    if (error != std::errc()) fail(std::string("malformed ") + what + " index");
    at = stop;
    if (value == 0) fail(std::string(what) + " index 0: OBJ counts from 1");
    if (value < 0) {
      if (value < -count) {
        fail(std::string(what) + " index " + std::to_string(value) + " is out of range (" +
             std::to_string(count) + " so far)");
      }
      return count + value;
    }
    if (value > count) {
      // Legal if the file brings it later. The first offence in the file, if any, is always larger
      // than all before it, so that only running maxima need remembering.
      if (value > std::numeric_limits<int32_t>::max()) {
        fail(std::string(what) + " index " + std::to_string(value) + " is out of range");
      }
      if (forward.empty() || value > forward.back().index) {
        forward.push_back({value, line_number_});
      }
    }
    return value - 1;
  }

  void parse_face(Line& line) {
    const auto vertex_count = static_cast<int64_t>(scene_.positions.size());
    const auto uv_count = static_cast<int64_t>(scene_.uvs.size());
    const size_t first_corner = scene_.corner_vertex.size();
    while (!line.done()) {
      const char* at = line.at;
      const auto vertex =
          static_cast<int32_t>(index(at, line.end, vertex_count, "vertex", forward_vertex_));
      int32_t uv = -1;
      if (at != line.end && *at == '/') {
        ++at;
        if (at != line.end && *at != '/' && !is_blank(*at)) {
          uv = static_cast<int32_t>(
              index(at, line.end, uv_count, "texture coordinate", forward_uv_));
        }
        if (at != line.end && *at == '/') {
          ++at;
          if (at != line.end && !is_blank(*at)) {
            index(at, line.end, normal_count_, "normal", forward_normal_);
          }
        }
      }
      if (at != line.end && !is_blank(*at)) {
        Line corner{line.at, line.end};
        fail("malformed face corner '" + std::string(corner.token()) + "'");
      }
      line.at = at;
      check_room(scene_.corner_vertex.size(), "face corners");
      scene_.corner_vertex.push_back(vertex);
      if (uv >= 0 || !scene_.corner_uv.empty()) {
        scene_.corner_uv.resize(scene_.corner_vertex.size(), -1);
        scene_.corner_uv.back() = uv;
      }
    }
    if (scene_.corner_vertex.size() - first_corner < 3) {
      scene_.corner_vertex.resize(first_corner);
      if (scene_.corner_uv.size() > first_corner) scene_.corner_uv.resize(first_corner);
      ++scene_.short_faces;
      return;
    }
    if (scene_.runs.empty() || run_.group != scene_.runs.back().group ||
        run_.object != scene_.runs.back().object || run_.material != scene_.runs.back().material) {
      run_.first_face = scene_.face_count();
      scene_.runs.push_back(run_);
    }
    scene_.face_begin.push_back(static_cast<int32_t>(scene_.corner_vertex.size()));
  }

  void check_forward(const std::vector<ForwardIndex>& forward, int64_t count, const char* what) {
    for (const ForwardIndex& entry : forward) {
      if (entry.index > count) {
        line_number_ = entry.line;
        fail(std::string(what) + " index " + std::to_string(entry.index) +
             " is out of range (the file has " + std::to_string(count) + ")");
      }
    }
  }

  std::string name_;
  ObjScene scene_;
  NameTable groups_;
  NameTable materials_;
  FaceRun run_;
  int64_t normal_count_ = 0;
  int64_t line_number_ = 0;
  std::vector<ForwardIndex> forward_vertex_;
  std::vector<ForwardIndex> forward_uv_;
  std::vector<ForwardIndex> forward_normal_;
};

/// The end of the logical line that starts at `begin`: continuation lines are joined in place by
/// blanking the backslash and the line break. Null when the buffer ends before the line does.
/// Comments are not joined: they end in Windows paths.
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

ObjScene read_obj(std::istream& stream, const std::string& name, const ObjReadOptions& options) {
  ObjParser parser(name);
  std::vector<char> buffer(std::max<size_t>(options.buffer_size, 1));
  size_t held = 0;
  size_t bytes_read = 0;
  int64_t line_number = 1;
  int64_t joined_before = 0;
  bool at_end = false;
  bool first = true;
  while (!at_end) {
    report_progress(
        options.progress,
        options.total_size == 0
            ? 0.0f
            : std::min(1.0f, static_cast<float>(static_cast<double>(bytes_read) /
                                                static_cast<double>(options.total_size))));
    // One byte is kept free for the line break that ends the last line.
    if (held + 1 >= buffer.size()) buffer.resize(buffer.size() * 2 + 1);
    stream.read(buffer.data() + held, static_cast<std::streamsize>(buffer.size() - held - 1));
    const auto got = static_cast<size_t>(stream.gcount());
    if (stream.bad()) throw std::runtime_error(name + ": reading failed");
    bytes_read += got;
    char* fresh = buffer.data() + held;
    if (std::memchr(fresh, '\0', got) != nullptr) {
      throw std::invalid_argument(name + ": is no text file, hence no Wavefront OBJ");
    }
    held += got;
    at_end = got == 0 || stream.eof();
    if (at_end) buffer[held++] = '\n';

    char* begin = buffer.data();
    char* end = begin + held;
    if (first && held >= 3 && std::memcmp(begin, "\xEF\xBB\xBF", 3) == 0) {
      begin += 3;
    }
    first = first && held < 3;
    while (begin != end) {
      int64_t joined = 0;
      char* stop = join_logical_line(begin, end, joined);
      if (stop == nullptr) {
        // Breaks already blanked in the part that is carried over must still be counted.
        joined_before += joined;
        break;
      }
      parser.parse_line(begin, stop, line_number);
      line_number += 1 + joined + joined_before;
      joined_before = 0;
      begin = stop + 1;
    }
    held = static_cast<size_t>(end - begin);
    std::memmove(buffer.data(), begin, held);
  }
  if (held > 0) {
    // The file ends in a continuation: what was joined is the last line.
    parser.parse_line(buffer.data(), buffer.data() + held, line_number);
  }
  return parser.finish();
}

ObjScene read_obj_file(const std::string& path, ObjReadOptions options) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw std::invalid_argument(path + ": is a directory, not an OBJ file");
  }
  std::ifstream stream;
  // Our own buffer is the only one.
  stream.rdbuf()->pubsetbuf(nullptr, 0);
  stream.open(path, std::ios::binary);
  if (!stream) throw std::invalid_argument(path + ": cannot be opened");
  const auto size = std::filesystem::file_size(path, error);
  options.total_size = error ? 0 : static_cast<size_t>(size);
  return read_obj(stream, path, options);
}

}  // namespace snowbough::tree
