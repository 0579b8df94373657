#include "image/exr.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>
#include <half.h>
#include <openexr.h>

#include <algorithm>
#include <cstring>
#include <glm/vec2.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "image/atomic_file.h"

namespace snowbough::image {
namespace {

class MemoryReader : public Imf::IStream {
 public:
  MemoryReader(const std::string& path, const std::string& bytes)
      : Imf::IStream(path.c_str()), bytes_(bytes) {}

  bool read(char target[], int count) override {
    // The file chooses the position, so a sum may overflow.
    if (position_ > bytes_.size() || static_cast<size_t>(count) > bytes_.size() - position_) {
      throw std::runtime_error("the file is truncated");
    }
    std::memcpy(target, bytes_.data() + position_, static_cast<size_t>(count));
    position_ += static_cast<size_t>(count);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  const std::string& bytes_;
  size_t position_ = 0;
};

void check_layout(const ExrLayout& layout) {
  if (layout.width < 1 || layout.height < 1 || layout.channels.empty()) {
    throw std::invalid_argument("an EXR image needs a width, a height and at least one channel");
  }
  std::vector<std::string> sorted = layout.channels;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.front().empty() || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
    throw std::invalid_argument("the channels of an EXR image need different names");
  }
}

/// @throws std::runtime_error with OpenEXR's words if `result` is no success.
void require(exr_result_t result) {
  if (result == EXR_ERR_SUCCESS) return;
  if (result == EXR_ERR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error(std::string("OpenEXR says: ") + exr_get_default_error_message(result));
}

/// Lets one of a chunk's channels be read or written as `Scalar`s of interleaved pixels in rows of
/// `width`.
template <typename Scalar>
void set_user_layout(const ExrLayout& layout, exr_pixel_type_t type,
                     exr_coding_channel_info_t& channel) {
  channel.user_data_type = static_cast<uint16_t>(type);
  channel.user_bytes_per_element = sizeof(Scalar);
  channel.user_pixel_stride = static_cast<int32_t>(sizeof(Scalar) * layout.channels.size());
  channel.user_line_stride = channel.user_pixel_stride * layout.width;
}

/// The place of a chunk's channel in a pixel: OpenEXR sorts the channels by name.
ptrdiff_t place_of(const ExrLayout& layout, const exr_coding_channel_info_t& channel) {
  return std::find(layout.channels.begin(), layout.channels.end(),
                   std::string_view(channel.channel_name)) -
         layout.channels.begin();
}

/// An EXR file in memory, so that only atomic_write writes to the disk. OpenEXR's C interface
/// works on the calling thread; that of C++ hands each line to its own threads, and within
/// Blender takes 4 times as long.
class MemoryFile {
 public:
  explicit MemoryFile(const ExrLayout& layout) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
    settings.user_data = &bytes_;
    settings.write_fn = &write;
    require(exr_start_write(&context_, "memory", EXR_WRITE_FILE_DIRECTLY, &settings));
    try {
      write_header(layout);
    } catch (...) {
      exr_finish(&context_);
      throw;
    }
  }
  ~MemoryFile() {
    exr_encoding_destroy(context_, &line_);
    exr_finish(&context_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  /// `pixels`: channels of a pixel one after another, the file's last line first.
  template <typename Scalar>
  void write_lines(const ExrLayout& layout, exr_pixel_type_t type, const Scalar* pixels) {
    const size_t channels = layout.channels.size();
    for (int32_t y = 0; y < layout.height; ++y) {
      exr_chunk_info_t chunk;
      require(exr_write_scanline_chunk_info(context_, kPart, y, &chunk));
      require(y == 0 ? exr_encoding_initialize(context_, kPart, &chunk, &line_)
                     : exr_encoding_update(context_, kPart, &chunk, &line_));
      const size_t row = static_cast<size_t>(layout.height - 1 - y);
      const Scalar* const first = pixels + row * static_cast<size_t>(layout.width) * channels;
      for (int16_t c = 0; c < line_.channel_count; ++c) {
        exr_coding_channel_info_t& channel = line_.channels[c];
        set_user_layout<Scalar>(layout, type, channel);
        channel.encode_from_ptr =
            reinterpret_cast<const uint8_t*>(first + place_of(layout, channel));
      }
      if (y == 0) require(exr_encoding_choose_default_routines(context_, kPart, &line_));
      require(exr_encoding_run(context_, kPart, &line_));
    }
  }

  /// The whole file, once all lines are written.
  std::string take() {
    exr_encoding_destroy(context_, &line_);
    require(exr_finish(&context_));
    return std::move(bytes_);
  }

 private:
  static constexpr int kPart = 0;
  static constexpr size_t kShortName = 31;

  static int64_t write(exr_const_context_t, void* file, const void* from, uint64_t count,
                       uint64_t position, exr_stream_error_func_ptr_t) {
    std::string& bytes = *static_cast<std::string*>(file);
    try {
      if (position + count > bytes.size()) bytes.resize(position + count);
    } catch (const std::bad_alloc&) {
      return -1;
    }
    std::memcpy(bytes.data() + position, from, count);
    return static_cast<int64_t>(count);
  }

  void write_header(const ExrLayout& layout) {
    int part = kPart;
    require(exr_add_part(context_, nullptr, EXR_STORAGE_SCANLINE, &part));
    const auto is_long = [](const std::string& name) { return name.size() > kShortName; };
    if (std::any_of(layout.channels.begin(), layout.channels.end(), is_long) ||
        std::any_of(layout.attributes.begin(), layout.attributes.end(),
                    [&](const auto& attribute) { return is_long(attribute.first); })) {
      require(exr_set_longname_support(context_, 1));
    }
    require(exr_initialize_required_attr_simple(context_, part, layout.width, layout.height,
                                                EXR_COMPRESSION_RLE));
    for (const auto& [name, text] : layout.attributes) {
      const exr_attribute_t* found = nullptr;
      if (name.empty() ||
          exr_get_attribute_by_name(context_, part, name.c_str(), &found) == EXR_ERR_SUCCESS) {
        throw std::invalid_argument("the EXR attribute '" + name + "' is reserved by the format");
      }
      require(exr_attr_set_string(context_, part, name.c_str(), text.c_str()));
    }
    const auto type = layout.type == ExrPixelType::kHalf ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    for (const std::string& channel : layout.channels) {
      require(exr_add_channel(context_, part, channel.c_str(), type, EXR_PERCEPTUALLY_LOGARITHMIC,
                              1, 1));
    }
    require(exr_write_header(context_));
  }

  std::string bytes_;
  exr_context_t context_ = nullptr;
  exr_encode_pipeline_t line_{};
};

std::string encode(const ExrLayout& layout, const float* pixels) {
  MemoryFile file(layout);
  if (layout.type == ExrPixelType::kHalf) {
    const size_t count = static_cast<size_t>(layout.width) * static_cast<size_t>(layout.height) *
                         layout.channels.size();
    const std::vector<half> halves(pixels, pixels + count);
    file.write_lines(layout, EXR_PIXEL_HALF, halves.data());
  } else {
    file.write_lines(layout, EXR_PIXEL_FLOAT, pixels);
  }
  return file.take();
}

/// Reads the pixels of an EXR file in memory on the calling thread, as MemoryFile writes them.
class PixelReader {
 public:
  /// `table`: offset of the table of the chunks' offsets.
  PixelReader(const std::string& bytes, size_t table) : bytes_(bytes), table_(table) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
    settings.user_data = this;
    settings.read_fn = &read;
    settings.size_fn = &size;
    require(exr_start_read(&context_, "memory", &settings));
  }
  ~PixelReader() {
    exr_decoding_destroy(context_, &chunk_);
    exr_finish(&context_);
  }
  PixelReader(const PixelReader&) = delete;
  PixelReader& operator=(const PixelReader&) = delete;

  /// `pixels`: channels of a pixel one after another, the file's first line first.
  void read_lines(const ExrLayout& layout, int32_t first_line, float* pixels) {
    exr_chunk_info_t chunk;
    for (int32_t y = 0; y < layout.height; y += chunk.height) {
      require(exr_read_scanline_chunk_info(context_, kPart, first_line + y, &chunk));
      if (chunk.height < 1 || chunk.height > layout.height - y || chunk.width != layout.width)
        throw std::runtime_error("it has lines of another size");
      read_chunk(layout, chunk, {0, y}, pixels);
    }
  }

  /// The same for the largest level of a tiled file.
  void read_tiles(const ExrLayout& layout, const glm::ivec2& tile, float* pixels) {
    exr_chunk_info_t chunk;
    for (int32_t y = 0; y < layout.height; y += tile.y) {
      for (int32_t x = 0; x < layout.width; x += tile.x) {
        require(exr_read_tile_chunk_info(context_, kPart, x / tile.x, y / tile.y, 0, 0, &chunk));
        if (chunk.width < 1 || chunk.width > layout.width - x || chunk.height < 1 ||
            chunk.height > layout.height - y)
          throw std::runtime_error("it has tiles of another size");
        read_chunk(layout, chunk, {x, y}, pixels);
      }
    }
  }

 private:
  static constexpr int kPart = 0;

  static int64_t read(exr_const_context_t, void* reader, void* to, uint64_t count,
                      uint64_t position, exr_stream_error_func_ptr_t) {
    const std::string& bytes = static_cast<const PixelReader*>(reader)->bytes_;
    if (position > bytes.size()) return -1;
    const uint64_t there = std::min<uint64_t>(count, bytes.size() - position);
    std::memcpy(to, bytes.data() + position, there);
    return static_cast<int64_t>(there);
  }
  static int64_t size(exr_const_context_t, void* reader) {
    return static_cast<int64_t>(static_cast<const PixelReader*>(reader)->bytes_.size());
  }

  /// OpenEXR searches for chunks whose places are damaged: their pixels may be, too.
  void require_place(int32_t chunk) const {
    uint64_t place = 0;
    const size_t at = table_ + sizeof place * static_cast<size_t>(chunk);
    if (at + sizeof place <= bytes_.size()) std::memcpy(&place, &bytes_[at], sizeof place);
    if (place < at || place >= bytes_.size()) {
      throw std::runtime_error("the place of a line is damaged");
    }
  }

  void read_chunk(const ExrLayout& layout, const exr_chunk_info_t& chunk, const glm::ivec2& at,
                  float* pixels) {
    require_place(chunk.idx);
    const bool is_first = chunk_.context == nullptr;
    require(is_first ? exr_decoding_initialize(context_, kPart, &chunk, &chunk_)
                     : exr_decoding_update(context_, kPart, &chunk, &chunk_));
    const ptrdiff_t pixel = ptrdiff_t{at.y} * layout.width + at.x;
    float* const first = pixels + pixel * static_cast<ptrdiff_t>(layout.channels.size());
    for (int16_t c = 0; c < chunk_.channel_count; ++c) {
      exr_coding_channel_info_t& channel = chunk_.channels[c];
      set_user_layout<float>(layout, EXR_PIXEL_FLOAT, channel);
      channel.decode_to_ptr = reinterpret_cast<uint8_t*>(first + place_of(layout, channel));
    }
    if (is_first) require(exr_decoding_choose_default_routines(context_, kPart, &chunk_));
    require(exr_decoding_run(context_, kPart, &chunk_));
  }

  const std::string& bytes_;
  size_t table_;
  exr_context_t context_ = nullptr;
  exr_decode_pipeline_t chunk_{};
};

/// Best compression ratio of all supported methods (zlib's): pixel bytes per file byte.
constexpr uint64_t kBestRatio = 1100;

/// OpenEXR counts channels in 16 bits.
constexpr size_t kMostChannels = 1024;

/// A position in a file's header. @throws std::runtime_error beyond the end of the file.
struct HeaderCursor {
  std::string_view bytes;
  size_t at = 0;

  size_t rest() const { return bytes.size() - at; }
  std::string_view text() {
    const size_t end = bytes.find('\0', at);
    if (end == std::string_view::npos) throw std::runtime_error("the file is truncated");
    const std::string_view text = bytes.substr(at, end - at);
    at = end + 1;
    return text;
  }
  std::string_view take(size_t count) {
    if (count > rest()) throw std::runtime_error("the file is truncated");
    at += count;
    return bytes.substr(at - count, count);
  }
};

/// Length of a channel list: OpenEXR reads it up to its empty name.
size_t channel_list_length(std::string_view value) {
  constexpr size_t kChannelBytes = 16;
  HeaderCursor cursor{value};
  while (!cursor.text().empty()) cursor.take(kChannelBytes);
  return cursor.at;
}

/// Number of bytes that OpenEXR reads of an attribute that an image needs; -1 for other types.
int64_t length_of_needed(std::string_view type, std::string_view value) {
  static const std::map<std::string_view, int64_t> kLengths{{"box2i", 16},   {"compression", 1},
                                                            {"float", 4},    {"lineOrder", 1},
                                                            {"tiledesc", 9}, {"v2f", 8}};
  if (type == "chlist") return static_cast<int64_t>(channel_list_length(value));
  if (type == "string") return static_cast<int64_t>(value.size());
  const auto found = kLengths.find(type);
  return found == kLengths.end() ? -1 : found->second;
}

/// Prepares the header for OpenEXR, which trusts it: it allocates the sizes that attributes
/// declare, and ignores them for types of known size, after which it reads the wrong bytes. Checks
/// the sizes, and renames the types of attributes that are not needed, so that OpenEXR skips them.
void secure_attributes(std::string& bytes) {
  HeaderCursor cursor{bytes, 2 * sizeof(int32_t)};
  while (!cursor.text().empty()) {
    const size_t type_at = cursor.at;
    const std::string_view type = cursor.text();
    int32_t size = 0;
    std::memcpy(&size, cursor.take(sizeof size).data(), sizeof size);
    if (size < 0) throw std::runtime_error("an attribute has a negative size");
    const std::string_view value = cursor.take(static_cast<size_t>(size));
    const int64_t length = length_of_needed(type, value);
    if (length >= 0 && length != size) throw std::runtime_error("an attribute has a wrong size");
    if (length < 0 && !type.empty()) bytes[type_at] = '?';
  }
}

struct CheckedHeader {
  Imf::Header header;
  /// Where the table of the chunks' places begins.
  size_t table = 0;
};

/// Secures the header and compares the declared size with the file's length and kLargestExr.
CheckedHeader checked_header(const std::string& path, std::string& bytes) {
  MemoryReader stream(path, bytes);
  int32_t start[2];
  stream.read(reinterpret_cast<char*>(start), sizeof start);
  if (start[0] != Imf::MAGIC) throw std::runtime_error("it is not an EXR file");
  if (Imf::isMultiPart(start[1]) || Imf::isNonImage(start[1])) {
    throw std::runtime_error("files with several parts or deep pixels are not supported");
  }
  secure_attributes(bytes);
  Imf::Header header;
  header.readFrom(stream, start[1]);
  const Imath::Box2i window = header.dataWindow();
  const int64_t width = int64_t{window.max.x} - window.min.x + 1;
  const int64_t height = int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > kLargestExr || height > kLargestExr) {
    throw std::runtime_error("it has " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels; the maximum is " + std::to_string(kLargestExr) + " x " +
                             std::to_string(kLargestExr));
  }
  if (header.hasTileDescription() &&
      std::max(header.tileDescription().xSize, header.tileDescription().ySize) >
          static_cast<uint32_t>(kLargestExr)) {
    throw std::runtime_error("its tiles are larger than the maximum image size");
  }
  uint64_t pixel_bytes = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    pixel_bytes += channel.channel().type == Imf::HALF ? 2 : 4;
  }
  const auto pixels = static_cast<uint64_t>(width * height);
  if (pixel_bytes == 0 || pixels * pixel_bytes > kBestRatio * bytes.size()) {
    throw std::runtime_error(std::to_string(bytes.size()) + " bytes cannot hold its " +
                             std::to_string(width) + " x " + std::to_string(height) + " pixels");
  }
  return {header, stream.tellg()};
}

ExrImage decode(const std::string& path, std::string& bytes) {
  const auto [header, table] = checked_header(path, bytes);
  const Imath::Box2i window = header.dataWindow();

  ExrImage image;
  ExrLayout& layout = image.layout;
  layout.width = window.max.x - window.min.x + 1;
  layout.height = window.max.y - window.min.y + 1;
  bool all_half = true;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) {
      throw std::runtime_error(std::string("the channel ") + channel.name() +
                               " is subsampled, which is not supported");
    }
    all_half = all_half && channel.channel().type == Imf::HALF;
    layout.channels.emplace_back(channel.name());
  }
  if (layout.channels.size() > kMostChannels) {
    throw std::runtime_error("it has " + std::to_string(layout.channels.size()) +
                             " channels; the maximum is " + std::to_string(kMostChannels));
  }
  layout.type = all_half ? ExrPixelType::kHalf : ExrPixelType::kFloat;
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
    // The format's own.
    if (text == nullptr || attribute.name() == std::string_view("type")) continue;
    layout.attributes[attribute.name()] = text->value();
  }

  image.pixels.resize(static_cast<size_t>(layout.width) * static_cast<size_t>(layout.height) *
                      layout.channels.size());
  PixelReader reader(bytes, table);
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tile = header.tileDescription();
    reader.read_tiles(layout, {tile.xSize, tile.ySize}, image.pixels.data());
  } else {
    reader.read_lines(layout, window.min.y, image.pixels.data());
  }
  const ptrdiff_t row = static_cast<ptrdiff_t>(layout.channels.size()) * layout.width;
  for (int32_t y = 0; y < layout.height / 2; ++y) {
    const auto line = image.pixels.begin() + y * row;
    std::swap_ranges(line, line + row, image.pixels.end() - (y + 1) * row);
  }
  return image;
}

}  // namespace

void write_exr(const std::string& path, const ExrLayout& layout, const float* pixels) {
  check_layout(layout);
  atomic_write(path, encode(layout, pixels));
}

ExrImage read_exr(const std::string& path) {
  std::string bytes = read_file(path);
  try {
    return decode(path, bytes);
  } catch (const std::exception& error) {
    throw std::runtime_error("cannot read '" + path + "' as an EXR image: " + error.what());
  }
}

}  // namespace snowbough::image
