#include "tree/obj/obj_reader.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/file_path.h"
#include "base/parallel_for.h"
#include "tree/obj/obj_assembler.h"
#include "tree/obj/obj_fragment.h"
#include "tree/obj/text.h"

namespace snowbough::tree {
namespace {

/// Pieces per buffer: more than threads, since lines of faces and of vertices take different times.
constexpr size_t kPieces = 16;

/// Whether a logical line certainly ends before `at`: after a backslash a break may continue the
/// line.
/// @param begin  beginning of a logical line.
bool ends_line(const char* begin, const char* at) {
  if (at == begin || at[-1] != '\n') return false;
  const char* last = at - 1;
  if (last != begin && last[-1] == '\r') --last;
  return last == begin || last[-1] != '\\';
}

/// End of the last complete logical line of [begin, end); `begin` if there is none.
char* last_line_end(char* begin, char* end) {
  while (end != begin && !ends_line(begin, end)) --end;
  return end;
}

/// Cuts complete lines into pieces of similar size: piece i is [result[i], result[i + 1]).
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

/// Text of the file after the lines that were parsed.
struct Chunk {
  std::vector<char> buffer;
  size_t held = 0;
  bool at_end = false;

  /// Reads more text after the current one.
  /// @param bytes_read  incremented by the number of bytes.
  void read(std::istream& stream, const std::string& name, size_t& bytes_read) {
    // Reserves one byte for the line break after the last line.
    if (held + 1 >= buffer.size()) buffer.resize(buffer.size() * 2 + 1);
    stream.read(buffer.data() + held, static_cast<std::streamsize>(buffer.size() - held - 1));
    const auto got = static_cast<size_t>(stream.gcount());
    if (stream.bad()) throw std::runtime_error(name + ": reading failed");
    bytes_read += got;
    if (std::memchr(buffer.data() + held, '\0', got) != nullptr) {
      throw std::invalid_argument(name + ": is not a text file, hence not a Wavefront OBJ");
    }
    char* const from = buffer.data() + held - (held > 0 ? 1 : 0);
    held += got;
    end_lines_by_newline(from, buffer.data() + held);
    at_end = got == 0 || stream.eof();
    if (at_end) buffer[held++] = '\n';
  }
};

/// Parses complete lines, all pieces in parallel, and appends them.
/// @param share  fraction of the file at their end; 0 = unknown.
/// @param beside  work for one thread at the same time.
void read_lines(char* begin, char* end, double share, const ObjReadOptions& options,
                const std::function<void()>& beside, ObjAssembler& all) {
  const int threads = options.threads;
  const std::vector<char*> cuts = cut_pieces(begin, end);
  const ObjCounts known = all.counts();
  std::vector<ObjFragment> fragments(cuts.size() - 1);
  base::parallel_for(fragments.size() + 1, 1, {threads, {}}, [&](size_t block, size_t) {
    if (block == 0) {
      beside();
    } else {
      fragments[block - 1] = read_obj_fragment(cuts[block - 1], cuts[block], known, options.origin);
    }
  });
  all.append(std::move(fragments), share, threads);
}

}  // namespace

ObjScene read_obj(std::istream& stream, const std::string& name, const ObjReadOptions& options) {
  ObjAssembler all(name);
  size_t bytes_read = 0;
  Chunk now, next;
  now.buffer.resize(std::max<size_t>(options.buffer_size, 1));
  base::report_progress(options.progress, 0.0f);
  now.read(stream, name, bytes_read);
  bool first = true;
  while (true) {
    const double share = options.total_size == 0
                             ? 0.0
                             : std::min(1.0, static_cast<double>(bytes_read) /
                                                 static_cast<double>(options.total_size));
    base::report_progress(options.progress, static_cast<float>(share));
    char* begin = now.buffer.data();
    char* end = begin + now.held;
    if (first && now.held >= 3 && std::memcmp(begin, "\xEF\xBB\xBF", 3) == 0) {
      begin += 3;
    }
    char* cut = now.at_end ? end : last_line_end(begin, end);
    if (now.at_end) {
      read_lines(
          begin, cut, share, options, [] {}, all);
      return all.finish();
    }
    if ((first && now.held < 3) || cut == begin) {
      now.read(stream, name, bytes_read);
      continue;
    }
    // Errors in the lines take precedence over errors behind them.
    std::exception_ptr error;
    next.buffer.resize(now.buffer.size());
    next.held = static_cast<size_t>(end - cut);
    std::copy(cut, end, next.buffer.begin());
    const auto read_on = [&] {
      try {
        next.read(stream, name, bytes_read);
      } catch (...) {
        error = std::current_exception();
      }
    };
    read_lines(begin, cut, share, options, read_on, all);
    if (error) std::rethrow_exception(error);
    first = false;
    std::swap(now, next);
  }
}

ObjScene read_obj_file(const std::string& path, ObjReadOptions options) {
  std::error_code error;
  const std::filesystem::path file = base::openable(base::as_path(path));
  if (std::filesystem::is_directory(file, error)) {
    throw std::invalid_argument(path + ": is a directory, not an OBJ file");
  }
  std::ifstream stream;
  // Disables the stream's own buffer.
  stream.rdbuf()->pubsetbuf(nullptr, 0);
  stream.open(file, std::ios::binary);
  if (!stream) throw std::invalid_argument(path + ": cannot be opened");
  const auto size = std::filesystem::file_size(file, error);
  options.total_size = error ? 0 : static_cast<size_t>(size);
  if (!error) options.buffer_size = std::min(options.buffer_size, options.total_size + 2);
  return read_obj(stream, path, options);
}

}  // namespace snowbough::tree
