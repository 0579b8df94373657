// Checkpoints. The first byte chooses: a whole file; a body, to which the harness adds header and
// check sum; or a checkpoint, which must come back from its file as it was.
#include <zlib.h>

#include <stdexcept>

#include "fuzz_input.h"
#include "snow/state/checkpoint.h"

namespace {

using namespace snowbough;

constexpr int32_t kLargestMap = 64;

void append(std::string& bytes, auto value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string with_header(std::string_view body) {
  std::string file = "SNOWBOUGH-STATE\n";
  append(file, uint32_t{3});
  append(file, static_cast<uint64_t>(body.size()));
  append(file, static_cast<uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(body.data()),
                                           static_cast<uInt>(body.size()))));
  return file.append(body);
}

/// A simulation of small maps: memory for larger ones must not be allocated.
void refuse_large(const snow::CheckpointOutline& outline) {
  for (const auto& [name, resolution] : outline.maps) {
    if (resolution > kLargestMap) throw std::invalid_argument("a large map");
  }
}

snow::Checkpoint take_checkpoint(fuzz::Input& input) {
  snow::Checkpoint checkpoint;
  checkpoint.description = input.bytes(input.take<uint8_t>());
  checkpoint.state.step_number = input.take<uint32_t>();
  const int32_t count = input.range(0, 3);
  for (int32_t i = 0; i < count; ++i) {
    snow::ObjectState object;
    object.name = static_cast<char>('a' + i) + std::string(input.bytes(input.range(0, 8)));
    object.resolution = input.range(1, 16);
    for (double& sum : object.sums) sum = input.take<float>();
    object.height.resize(static_cast<size_t>(object.resolution * object.resolution));
    for (float& height : object.height)
      height = input.range(0, 1) == 0 ? 0.0f : input.take<float>();
    checkpoint.state.objects.push_back(std::move(object));
  }
  return checkpoint;
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const fuzz::ScratchFolder scratch;
  fuzz::Input input(data, size);
  const int32_t kind = input.range(0, 2);
  std::string path = scratch.file("state");
  if (kind == 2) {
    snow::save_checkpoint(path, take_checkpoint(input));
  } else {
    scratch.write("state", kind == 0 ? std::string(input.rest()) : with_header(input.rest()));
  }
  try {
    const snow::Checkpoint loaded = snow::load_checkpoint(path, refuse_large);
    const std::string again = scratch.file("again");
    snow::save_checkpoint(again, loaded);
    const snow::Checkpoint second = snow::load_checkpoint(again);
    fuzz::require(second.description == loaded.description &&
                      second.state.step_number == loaded.state.step_number &&
                      second.state.objects.size() == loaded.state.objects.size(),
                  "a checkpoint changes when it is saved");
    fuzz::require(kind != 2 || bytes_of(path) == bytes_of(again),
                  "the bytes of a checkpoint change when it is saved");
  } catch (const std::runtime_error&) {
    fuzz::require(kind != 2, "a checkpoint of ours is refused");
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
