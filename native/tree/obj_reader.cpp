#include "tree/obj_reader.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "tree/obj_assembler.h"
#include "tree/obj_fragment.h"
#include "tree/parallel.h"

namespace snowbough::tree {
namespace {

/// Pieces that a buffer is cut into: more than threads, as lines of faces and of vertices take
/// different times.
constexpr size_t kPieces = 16;

/// Whether a logical line surely ends before `at`: a break after a backslash may continue the line.
/// @param begin  beginning of a logical line.
bool ends_line(const char* begin, const char* at) {
  if (at == begin || at[-1] != '\n') return false;
  const char* last = at - 1;
  if (last != begin && last[-1] == '\r') --last;
  return last == begin || last[-1] != '\\';
}

/// End of the last whole logical line of [begin, end); `begin` if there is none.
char* last_line_end(char* begin, char* end) {
  while (end != begin && !ends_line(begin, end)) --end;
  return end;
}

/// Cuts whole lines into pieces of about the same size: piece i is [result[i], result[i + 1]).
std::vector<char*> cut_pieces(char* begin, char* end) {
  const size_t size = static_cast<size_t>(end - begin) / kPieces + 1;
  std::vector<char*> cuts{begin};
  while (static_cast<size_t>(end - cuts.back()) > size) {
    char* cut = cuts.back() + size;
    while (cut != end && !ends_line(begin, cut)) ++cut;
    cuts.push_back(cut);
  }
  if (cuts.back() != end) cuts.push_back(end);
  return cuts;
}

/// Reads whole lines, the pieces at once, and adds them to what was read before.
void read_lines(char* begin, char* end, int threads, ObjAssembler& all) {
  const std::vector<char*> cuts = cut_pieces(begin, end);
  const ObjCounts known = all.counts();
  std::vector<ObjFragment> fragments(cuts.size() - 1);
  parallel_blocks(fragments.size(), 1, {threads, {}}, [&](size_t piece, size_t) {
    fragments[piece] = read_obj_fragment(cuts[piece], cuts[piece + 1], known);
  });
  for (const ObjFragment& fragment : fragments) all.append(fragment);
}

}  // namespace

ObjScene read_obj(std::istream& stream, const std::string& name, const ObjReadOptions& options) {
  ObjAssembler all(name);
  std::vector<char> buffer(std::max<size_t>(options.buffer_size, 1));
  size_t held = 0;
  size_t bytes_read = 0;
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
    if (std::memchr(buffer.data() + held, '\0', got) != nullptr) {
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
    char* cut = at_end ? end : last_line_end(begin, end);
    if (cut != begin) read_lines(begin, cut, options.threads, all);
    held = static_cast<size_t>(end - cut);
    std::memmove(buffer.data(), cut, held);
  }
  return all.finish();
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
  if (!error) options.buffer_size = std::min(options.buffer_size, options.total_size + 2);
  return read_obj(stream, path, options);
}

}  // namespace snowbough::tree
