#include "image/png.h"

#include <zlib.h>

#include <stdexcept>
#include <string_view>
#include <vector>

namespace snowbough::image {
namespace {

void append_big_endian(std::string& bytes, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<char>((value >> shift) & 0xff));
  }
}

void append_chunk(std::string& file, const char* type, std::string_view data) {
  append_big_endian(file, static_cast<uint32_t>(data.size()));
  const size_t begin = file.size();
  file.append(type, 4);
  file.append(data);
  const auto* checked = reinterpret_cast<const Bytef*>(file.data() + begin);
  append_big_endian(
      file, static_cast<uint32_t>(crc32(0, checked, static_cast<uInt>(file.size() - begin))));
}

/// Rows from the top, each with the filter type "up": differences to the row above compress well.
template <typename Sample>
std::string filtered_rows(int32_t width, int32_t height, int32_t channels, const Sample* samples) {
  const size_t row_samples = static_cast<size_t>(width) * static_cast<size_t>(channels);
  const size_t row_bytes = row_samples * sizeof(Sample);
  std::string rows;
  rows.reserve((row_bytes + 1) * static_cast<size_t>(height));
  std::vector<uint8_t> above(row_bytes, 0);
  std::vector<uint8_t> current(row_bytes);
  for (int32_t row = height - 1; row >= 0; --row) {
    const Sample* source = samples + static_cast<size_t>(row) * row_samples;
    for (size_t i = 0; i < row_samples; ++i) {
      for (size_t byte = 0; byte < sizeof(Sample); ++byte) {
        const size_t shift = 8 * (sizeof(Sample) - 1 - byte);
        current[i * sizeof(Sample) + byte] = static_cast<uint8_t>(source[i] >> shift);
      }
    }
    rows.push_back(2);
    for (size_t i = 0; i < row_bytes; ++i) {
      rows.push_back(static_cast<char>(static_cast<uint8_t>(current[i] - above[i])));
    }
    above.swap(current);
  }
  return rows;
}

std::string deflate_all(const std::string& data) {
  uLongf size = compressBound(data.size());
  std::string packed(size, '\0');
  const int result = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(data.data()), data.size(), 6);
  if (result != Z_OK) throw std::runtime_error("zlib could not pack a PNG image");
  packed.resize(size);
  return packed;
}

template <typename Sample>
std::string encode(int32_t width, int32_t height, int32_t channels, const Sample* samples) {
  if (width < 1 || height < 1 || channels < 1 || channels > 4) {
    throw std::invalid_argument("a PNG image needs a width, a height and 1 to 4 channels");
  }
  constexpr char kColourType[] = {0, 4, 2, 6};
  std::string header;
  append_big_endian(header, static_cast<uint32_t>(width));
  append_big_endian(header, static_cast<uint32_t>(height));
  header.push_back(static_cast<char>(8 * sizeof(Sample)));
  header.push_back(kColourType[channels - 1]);
  header.append(3, '\0');

  std::string file("\x89PNG\r\n\x1a\n", 8);
  append_chunk(file, "IHDR", header);
  const std::string packed = deflate_all(filtered_rows(width, height, channels, samples));
  // A chunk's length has 31 bits: large images use several chunks.
  constexpr size_t kChunk = size_t{1} << 30;
  for (size_t begin = 0; begin < packed.size(); begin += kChunk) {
    append_chunk(file, "IDAT", std::string_view(packed).substr(begin, kChunk));
  }
  append_chunk(file, "IEND", {});
  return file;
}

}  // namespace

std::string encode_png(int32_t width, int32_t height, int32_t channels, const uint8_t* samples) {
  return encode(width, height, channels, samples);
}

std::string encode_png(int32_t width, int32_t height, int32_t channels, const uint16_t* samples) {
  return encode(width, height, channels, samples);
}

}  // namespace snowbough::image
