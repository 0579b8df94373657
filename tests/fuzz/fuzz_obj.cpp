// OBJ files. The first byte chooses the size of the read buffer: the scene and the error must not
// depend on it. Then the tree reader takes the whole file.
#include <sstream>
#include <stdexcept>

#include "fuzz_input.h"
#include "tree/obj/obj_reader.h"
#include "tree/read_tree.h"

namespace {

using namespace snowbough;

struct Outcome {
  tree::ObjScene scene;
  std::string error;
};

Outcome read(std::string_view text, size_t buffer_size) {
  Outcome outcome;
  std::istringstream stream{std::string(text)};
  tree::ObjReadOptions options;
  options.buffer_size = buffer_size;
  options.total_size = text.size();
  options.threads = 1;
  try {
    outcome.scene = tree::read_obj(stream, "fuzz.obj", options);
  } catch (const std::invalid_argument& error) {
    outcome.error = error.what();
  }
  return outcome;
}

void check_indices(const tree::ObjScene& scene) {
  for (const int32_t vertex : scene.corner_vertex) {
    fuzz::require(vertex >= 0 && static_cast<size_t>(vertex) < scene.positions.size(),
                  "a corner has no vertex");
  }
  for (const int32_t uv : scene.corner_uv) {
    fuzz::require(uv >= -1 && uv < static_cast<int32_t>(scene.uvs.size()), "a corner has no UV");
  }
  fuzz::require(static_cast<size_t>(scene.face_begin.back()) == scene.corner_vertex.size(),
                "the last face does not end with the last corner");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const fuzz::ScratchFolder scratch;
  fuzz::Input input(data, size);
  const auto buffer_size = static_cast<size_t>(input.range(1, 64));
  const Outcome small = read(input.rest(), buffer_size);
  const Outcome whole = read(input.rest(), size_t{1} << 16);
  // In a binary file, the first error depends on it.
  const bool is_text = input.rest().find('\0') == std::string_view::npos;
  fuzz::require(
      small.error.empty() == whole.error.empty() && (small.error == whole.error || !is_text),
      "the error depends on the buffer");
  if (!whole.error.empty()) return 0;
  check_indices(whole.scene);
  fuzz::require(small.scene.positions == whole.scene.positions &&
                    small.scene.corner_vertex == whole.scene.corner_vertex &&
                    small.scene.corner_uv == whole.scene.corner_uv &&
                    small.scene.face_begin == whole.scene.face_begin &&
                    small.scene.names == whole.scene.names,
                "the scene depends on the buffer");
  tree::ReadTreeOptions options;
  options.threads = 1;
  try {
    tree::read_tree(scratch.write("pack/model/fuzz.obj", input.rest()), options);
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
