#include "snow/state/checkpoint.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string_view>

#include "image/atomic_file.h"

namespace snowbough::snow {
namespace {

constexpr std::string_view kMagic{"SNOWBOUGH-STATE\n", 16};
constexpr uint32_t kVersion = 1;
constexpr int32_t kLargestResolution = 8192;
/// The magic, the version, the length of what follows and its check sum.
constexpr size_t kHeaderBytes = 16 + 4 + 8 + 4;

uint32_t check_sum(std::string_view bytes) {
  uLong sum = crc32(0, nullptr, 0);
  while (!bytes.empty()) {
    const auto part = static_cast<uInt>(std::min(bytes.size(), size_t{1} << 30));
    sum = crc32(sum, reinterpret_cast<const Bytef*>(bytes.data()), part);
    bytes.remove_prefix(part);
  }
  return static_cast<uint32_t>(sum);
}

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
  void totals(const std::vector<std::pair<std::string, double>>& values) {
    number(static_cast<uint32_t>(values.size()));
    for (const auto& [name, value] : values) {
      text(name);
      number(std::bit_cast<uint64_t>(value));
    }
  }
  void raw(std::string_view value) { bytes_.append(value); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Takes apart what a Writer wrote; what does not fit is damage.
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
  std::vector<std::pair<std::string, double>> totals() {
    std::vector<std::pair<std::string, double>> values;
    for (uint32_t count = number<uint32_t>(); count > 0; --count) {
      std::string name = text();
      values.emplace_back(std::move(name), std::bit_cast<double>(number<uint64_t>()));
    }
    return values;
  }
  std::string_view raw(uint64_t count) {
    if (count > rest_.size()) throw std::runtime_error("its content does not fit together");
    const std::string_view part = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return part;
  }
  bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

/// The heights' bytes, all lowest bytes first, then the second ones and so on: exponents lie
/// together and pack well.
std::string to_planes(const std::vector<float>& height) {
  std::string planes(4 * height.size(), '\0');
  for (size_t i = 0; i < height.size(); ++i) {
    const auto bits = std::bit_cast<uint32_t>(height[i]);
    for (size_t byte = 0; byte < 4; ++byte) {
      planes[byte * height.size() + i] = static_cast<char>((bits >> (8 * byte)) & 0xff);
    }
  }
  return planes;
}

std::vector<float> from_planes(const std::string& planes) {
  const size_t count = planes.size() / 4;
  std::vector<float> height(count);
  for (size_t i = 0; i < count; ++i) {
    uint32_t bits = 0;
    for (size_t byte = 0; byte < 4; ++byte) {
      bits |= static_cast<uint32_t>(static_cast<unsigned char>(planes[byte * count + i]))
              << (8 * byte);
    }
    height[i] = std::bit_cast<float>(bits);
  }
  return height;
}

std::string pack(const std::string& data) {
  uLongf size = compressBound(data.size());
  std::string packed(size, '\0');
  const int result = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(data.data()), data.size(), 1);
  if (result != Z_OK) throw std::runtime_error("zlib could not pack a snow map");
  packed.resize(size);
  return packed;
}

std::string unpack(std::string_view packed, size_t size) {
  std::string data(size, '\0');
  uLongf written = size;
  const int result = uncompress(reinterpret_cast<Bytef*>(data.data()), &written,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (result != Z_OK || written != size) throw std::runtime_error("a map in it cannot be unpacked");
  return data;
}

CheckpointData parse(std::string_view body) {
  Reader reader(body);
  CheckpointData data;
  data.description = reader.text();
  data.step_number = reader.number<uint64_t>();
  data.totals = reader.totals();
  for (uint32_t count = reader.number<uint32_t>(); count > 0; --count) {
    CheckpointMap map;
    map.name = reader.text();
    const uint32_t resolution = reader.number<uint32_t>();
    if (resolution == 0 || resolution > kLargestResolution) {
      throw std::runtime_error("a map in it has an impossible size");
    }
    map.resolution = static_cast<int32_t>(resolution);
    map.totals = reader.totals();
    const uint64_t packed_bytes = reader.number<uint64_t>();
    map.height = from_planes(unpack(reader.raw(packed_bytes), size_t{4} * resolution * resolution));
    data.maps.push_back(std::move(map));
  }
  if (!reader.at_end()) throw std::runtime_error("there is more in it than there should be");
  return data;
}

CheckpointData check_and_parse(std::string_view file) {
  if (!file.starts_with(kMagic.substr(0, std::min(file.size(), kMagic.size()))) || file.empty()) {
    throw std::runtime_error("it is not a Snowbough checkpoint");
  }
  if (file.size() < kHeaderBytes) throw std::runtime_error("it is truncated");
  Reader header(file.substr(kMagic.size()));
  const auto version = header.number<uint32_t>();
  if (version != kVersion) {
    throw std::runtime_error("it has version " + std::to_string(version) +
                             ", this Snowbough reads version " + std::to_string(kVersion) +
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
  return parse(body);
}

}  // namespace

void save_checkpoint(const std::string& path, const CheckpointData& data) {
  Writer body;
  body.text(data.description);
  body.number(data.step_number);
  body.totals(data.totals);
  body.number(static_cast<uint32_t>(data.maps.size()));
  for (const CheckpointMap& map : data.maps) {
    const auto texels = static_cast<size_t>(map.resolution) * static_cast<size_t>(map.resolution);
    if (map.resolution < 1 || map.resolution > kLargestResolution || map.height.size() != texels) {
      throw std::invalid_argument("the map of '" + map.name + "' has " +
                                  std::to_string(map.height.size()) + " heights, not " +
                                  std::to_string(map.resolution) + " squared");
    }
    body.text(map.name);
    body.number(static_cast<uint32_t>(map.resolution));
    body.totals(map.totals);
    const std::string packed = pack(to_planes(map.height));
    body.number(static_cast<uint64_t>(packed.size()));
    body.raw(packed);
  }
  Writer file;
  file.raw(kMagic);
  file.number(kVersion);
  file.number(static_cast<uint64_t>(body.bytes().size()));
  file.number(check_sum(body.bytes()));
  file.raw(body.bytes());
  image::atomic_write(path, file.bytes());
}

CheckpointData load_checkpoint(const std::string& path) {
  const std::string file = image::read_file(path);
  try {
    return check_and_parse(file);
  } catch (const std::exception& error) {
    throw std::runtime_error("the checkpoint '" + path + "' cannot be used: " + error.what());
  }
}

}  // namespace snowbough::snow
