#include "snow/state/checkpoint.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <span>
#include <stdexcept>
#include <string_view>

#include "image/atomic_file.h"
#include "snow/state/check_sum.h"

namespace snowbough::snow {
namespace {

constexpr std::string_view kMagic{"SNOWBOUGH-STATE\n", 16};
/// Of states without planes and pressers, and of those with any.
constexpr uint32_t kVersion = 4;
constexpr uint32_t kVersionWithPlanes = 5;
/// With planes, and with sums after the first kFirstSums of each object: one more in each version.
constexpr uint32_t kLastVersion = 7;
constexpr size_t kFirstSums = 16;
constexpr int32_t kLargestResolution = 8192;
/// Magic, version, length of the body, and its check sum.
constexpr size_t kHeaderBytes = 16 + 4 + 8 + 4;

class Writer {
 public:
  template <typename Unsigned>
  void number(Unsigned value) {
    for (size_t byte = 0; byte < sizeof(Unsigned); ++byte) {
      bytes_.push_back(static_cast<char>((value >> (8 * byte)) & 0xff));
    }
  }
  void text(std::string_view value) {
    number(static_cast<uint32_t>(value.size()));
    bytes_.append(value);
  }
  void doubles(std::span<const double> values) {
    for (const double value : values) number(std::bit_cast<uint64_t>(value));
  }
  void raw(std::string_view value) { bytes_.append(value); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Parses the output of a Writer; throws for inconsistent data.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  template <typename Unsigned>
  Unsigned number() {
    const std::string_view part = raw(sizeof(Unsigned));
    Unsigned value = 0;
    for (size_t byte = 0; byte < sizeof(Unsigned); ++byte) {
      const auto digit = static_cast<Unsigned>(static_cast<unsigned char>(part[byte]));
      value = static_cast<Unsigned>(value | (digit << (8 * byte)));
    }
    return value;
  }
  std::string text() { return std::string(raw(number<uint32_t>())); }
  void doubles(std::span<double> values) {
    for (double& value : values) value = std::bit_cast<double>(number<uint64_t>());
  }
  std::string_view raw(uint64_t count) {
    if (count > rest_.size()) throw std::runtime_error("its content is inconsistent");
    const std::string_view part = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return part;
  }
  bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

/// Whether a texel is not stored: 0, but not -0.
bool is_bare(float height) {
  return std::bit_cast<uint32_t>(height) == 0;
}

/// One bit per texel, 1 if it is not bare, the first in the highest bit.
std::string mask_of(const std::vector<float>& height) {
  std::string mask((height.size() + 7) / 8, '\0');
  for (size_t i = 0; i < height.size(); ++i) {
    if (!is_bare(height[i])) mask[i / 8] = static_cast<char>(mask[i / 8] | (0x80 >> (i % 8)));
  }
  return mask;
}

bool is_set(const std::string& mask, size_t texel) {
  return (static_cast<unsigned char>(mask[texel / 8]) & (0x80u >> (texel % 8))) != 0;
}

std::string pack(const std::string& data) {
  uLongf size = compressBound(data.size());
  std::string packed(size, '\0');
  const int result = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(data.data()), data.size(), 1);
  if (result != Z_OK) throw std::runtime_error("zlib could not pack a map");
  packed.resize(size);
  return packed;
}

std::string unpack(std::string_view packed, size_t size) {
  std::string data(size, '\0');
  uLongf written = size;
  const int result = uncompress(reinterpret_cast<Bytef*>(data.data()), &written,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (result != Z_OK || written != size)
    throw std::runtime_error("one of its maps cannot be unpacked");
  return data;
}

size_t mask_bytes(const ObjectState& object) {
  return (size_t(object.resolution) * object.resolution + 7) / 8;
}

void write_plane(Writer& body, const std::vector<float>& plane) {
  const std::string mask = pack(mask_of(plane));
  body.number(static_cast<uint64_t>(mask.size()));
  body.raw(mask);
  for (const float value : plane) {
    if (!is_bare(value)) body.number(std::bit_cast<uint32_t>(value));
  }
}

void write_object(Writer& body, const ObjectState& object) {
  body.text(object.name);
  body.number(static_cast<uint32_t>(object.resolution));
  body.doubles(std::span(object.sums).first(kFirstSums));
  write_plane(body, object.height);
}

/// How many sums after the first kFirstSums a state needs.
size_t later_sums(const SimulationState& state) {
  size_t count = 0;
  for (const ObjectState& object : state.objects) {
    for (size_t i = kFirstSums; i < object.sums.size(); ++i) {
      if (object.sums[i] != 0.0) count = std::max(count, i + 1 - kFirstSums);
    }
  }
  return count;
}

bool has_planes(const SimulationState& state) {
  return !state.pressers.empty() ||
         std::any_of(state.objects.begin(), state.objects.end(),
                     [](const ObjectState& object) { return !object.planes.empty(); });
}

void write_planes(Writer& body, const SimulationState& state) {
  for (const ObjectState& object : state.objects) {
    body.number(static_cast<uint32_t>(object.planes.size()));
    for (const auto& [name, plane] : object.planes) {
      body.text(name);
      write_plane(body, plane);
    }
  }
  body.number(static_cast<uint32_t>(state.pressers.size()));
  for (const auto& [name, positions] : state.pressers) {
    body.text(name);
    body.number(static_cast<uint32_t>(positions.size()));
    for (const glm::vec3& point : positions) {
      for (int axis = 0; axis < 3; ++axis) body.number(std::bit_cast<uint32_t>(point[axis]));
    }
  }
}

void write_landing(Writer& body, const LandingState& landing) {
  body.number(std::bit_cast<uint64_t>(landing.clock));
  body.number(std::bit_cast<uint64_t>(landing.on_floors));
  body.number(std::bit_cast<uint64_t>(landing.left));
  body.number(static_cast<uint32_t>(landing.air.size()));
  for (const FallingSnow& snow : landing.air) {
    body.number(std::bit_cast<uint64_t>(snow.time));
    body.text(snow.receiver);
    body.number(static_cast<uint32_t>(snow.place));
    body.number(static_cast<uint8_t>(snow.is_back ? 1 : 0));
    body.number(std::bit_cast<uint64_t>(snow.units));
  }
}

LandingState read_landing(Reader& reader) {
  LandingState landing;
  landing.clock = std::bit_cast<int64_t>(reader.number<uint64_t>());
  landing.on_floors = std::bit_cast<int64_t>(reader.number<uint64_t>());
  landing.left = std::bit_cast<int64_t>(reader.number<uint64_t>());
  for (auto count = reader.number<uint32_t>(); count > 0; --count) {
    FallingSnow snow;
    snow.time = std::bit_cast<int64_t>(reader.number<uint64_t>());
    snow.receiver = reader.text();
    snow.place = static_cast<int32_t>(reader.number<uint32_t>());
    snow.is_back = reader.number<uint8_t>() != 0;
    snow.units = std::bit_cast<int64_t>(reader.number<uint64_t>());
    landing.air.push_back(std::move(snow));
  }
  return landing;
}

/// A plane as stored in the file.
struct PackedPlane {
  std::string_view mask;
  std::string_view values;
};

/// A map as stored in the file.
struct PackedObject {
  ObjectState object;  // without its heights and planes
  PackedPlane heights;
  std::map<std::string, PackedPlane> planes;
};

PackedPlane read_plane(Reader& reader, const ObjectState& object) {
  PackedPlane packed;
  packed.mask = reader.raw(reader.number<uint64_t>());
  uint64_t covered = 0;
  for (const char byte : unpack(packed.mask, mask_bytes(object))) {
    covered += static_cast<uint64_t>(std::popcount(static_cast<unsigned char>(byte)));
  }
  packed.values = reader.raw(sizeof(float) * covered);
  return packed;
}

PackedObject read_object(Reader& reader) {
  PackedObject packed;
  ObjectState& object = packed.object;
  object.name = reader.text();
  const auto resolution = reader.number<uint32_t>();
  if (resolution == 0 || resolution > kLargestResolution) {
    throw std::runtime_error("one of its maps has an impossible size");
  }
  object.resolution = static_cast<int32_t>(resolution);
  reader.doubles(std::span(object.sums).first(kFirstSums));
  packed.heights = read_plane(reader, object);
  return packed;
}

std::vector<float> unpacked(const PackedPlane& packed, const ObjectState& object) {
  const std::string mask = unpack(packed.mask, mask_bytes(object));
  Reader values(packed.values);
  std::vector<float> plane(size_t(object.resolution) * object.resolution);
  for (size_t i = 0; i < plane.size(); ++i) {
    if (is_set(mask, i)) plane[i] = std::bit_cast<float>(values.number<uint32_t>());
  }
  return plane;
}

ObjectState with_heights(PackedObject&& packed) {
  ObjectState object = std::move(packed.object);
  object.height = unpacked(packed.heights, object);
  for (const auto& [name, plane] : packed.planes) object.planes[name] = unpacked(plane, object);
  return object;
}

void read_planes(Reader& reader, std::vector<PackedObject>& objects, SimulationState& state) {
  for (PackedObject& object : objects) {
    for (auto count = reader.number<uint32_t>(); count > 0; --count) {
      const std::string name = reader.text();
      object.planes[name] = read_plane(reader, object.object);
    }
  }
  for (auto count = reader.number<uint32_t>(); count > 0; --count) {
    std::vector<glm::vec3>& positions = state.pressers[reader.text()];
    const auto points = reader.number<uint32_t>();
    Reader numbers(reader.raw(uint64_t{12} * points));
    positions.resize(points);
    for (glm::vec3& point : positions) {
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = std::bit_cast<float>(numbers.number<uint32_t>());
      }
    }
  }
}

Checkpoint parse(std::string_view body, uint32_t version,
                 const std::function<void(const CheckpointOutline&)>& check) {
  Reader reader(body);
  Checkpoint checkpoint;
  checkpoint.description = reader.text();
  checkpoint.state.step_number = reader.number<uint32_t>();
  CheckpointOutline outline{checkpoint.description, {}};
  std::vector<PackedObject> objects;
  for (auto count = reader.number<uint32_t>(); count > 0; --count) {
    objects.push_back(read_object(reader));
    const ObjectState& object = objects.back().object;
    if (!outline.maps.empty() && object.name <= outline.maps.back().first) {
      throw std::runtime_error("its maps are not sorted by name");
    }
    outline.maps.emplace_back(object.name, object.resolution);
  }
  checkpoint.state.landing = read_landing(reader);
  if (version >= kVersionWithPlanes) read_planes(reader, objects, checkpoint.state);
  for (PackedObject& packed : objects) {
    if (version <= kVersionWithPlanes) break;
    reader.doubles(std::span(packed.object.sums).subspan(kFirstSums, version - kVersionWithPlanes));
  }
  if (!reader.at_end()) throw std::runtime_error("it has bytes after its end");
  if (check) check(outline);
  for (PackedObject& packed : objects) {
    checkpoint.state.objects.push_back(with_heights(std::move(packed)));
  }
  return checkpoint;
}

Checkpoint check_and_parse(std::string_view file,
                           const std::function<void(const CheckpointOutline&)>& check) {
  if (!file.starts_with(kMagic.substr(0, std::min(file.size(), kMagic.size()))) || file.empty()) {
    throw std::runtime_error("it is not a Snowbough checkpoint");
  }
  if (file.size() < kHeaderBytes) throw std::runtime_error("it is truncated");
  Reader header(file.substr(kMagic.size()));
  const auto version = header.number<uint32_t>();
  if (version < kVersion || version > kLastVersion) {
    throw std::runtime_error("it has version " + std::to_string(version) +
                             ", this Snowbough reads versions " + std::to_string(kVersion) +
                             " to " + std::to_string(kLastVersion) +
                             "; bake again from the first frame");
  }
  const auto bytes = header.number<uint64_t>();
  const auto expected_sum = header.number<uint32_t>();
  const std::string_view body = file.substr(kHeaderBytes);
  if (body.size() < bytes) {
    throw std::runtime_error("it is truncated: " + std::to_string(body.size()) + " of " +
                             std::to_string(bytes) + " bytes are there");
  }
  if (body.size() > bytes || check_sum(body) != expected_sum) {
    throw std::runtime_error("it is damaged: the check sum does not match");
  }
  return parse(body, version, check);
}

}  // namespace

void save_checkpoint(const std::string& path, const Checkpoint& checkpoint) {
  Writer body;
  body.text(checkpoint.description);
  body.number(checkpoint.state.step_number);
  body.number(static_cast<uint32_t>(checkpoint.state.objects.size()));
  for (const ObjectState& object : checkpoint.state.objects) {
    const int64_t texels = int64_t{object.resolution} * object.resolution;
    if (object.resolution < 1 || object.resolution > kLargestResolution ||
        static_cast<int64_t>(object.height.size()) != texels) {
      throw std::invalid_argument("the map of '" + object.name + "' has " +
                                  std::to_string(object.height.size()) + " heights, not " +
                                  std::to_string(object.resolution) + " squared");
    }
    for (const auto& [name, plane] : object.planes) {
      if (static_cast<int64_t>(plane.size()) == texels) continue;
      throw std::invalid_argument("the plane '" + name + "' of '" + object.name + "' has " +
                                  std::to_string(plane.size()) + " values, not " +
                                  std::to_string(object.resolution) + " squared");
    }
    write_object(body, object);
  }
  write_landing(body, checkpoint.state.landing);
  const size_t more = later_sums(checkpoint.state);
  const bool with_planes = more > 0 || has_planes(checkpoint.state);
  if (with_planes) write_planes(body, checkpoint.state);
  for (const ObjectState& object : checkpoint.state.objects) {
    body.doubles(std::span(object.sums).subspan(kFirstSums, more));
  }
  Writer file;
  file.raw(kMagic);
  file.number(with_planes ? kVersionWithPlanes + static_cast<uint32_t>(more) : kVersion);
  file.number(static_cast<uint64_t>(body.bytes().size()));
  file.number(check_sum(body.bytes()));
  file.raw(body.bytes());
  image::atomic_write(path, file.bytes());
}

Checkpoint load_checkpoint(const std::string& path,
                           const std::function<void(const CheckpointOutline&)>& check) {
  const std::string file = image::read_file(path);
  try {
    return check_and_parse(file, check);
  } catch (const std::invalid_argument&) {
    throw;  // of `check`
  } catch (const std::exception& error) {
    throw std::runtime_error("the checkpoint '" + path + "' cannot be used: " + error.what());
  }
}

}  // namespace snowbough::snow
