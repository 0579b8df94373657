#include "image/rle_line.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace snowbough::image {
namespace {

static_assert(std::endian::native == std::endian::little, "words are searched from their low byte");

constexpr size_t kShortestRun = 3;
constexpr size_t kLongestRun = 128;
constexpr size_t kMostLiterals = 127;

uint64_t word_at(const uint8_t* bytes) {
  uint64_t word;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

void take_differences(const uint8_t* line, size_t size, uint8_t* differences) {
  const size_t half = size / 2;
  differences[0] = line[0];
  differences[half] = static_cast<uint8_t>(line[1] - line[size - 2] + 128);
  for (size_t i = 1; i < half; ++i) {
    differences[i] = static_cast<uint8_t>(line[2 * i] - line[2 * i - 2] + 128);
    differences[half + i] = static_cast<uint8_t>(line[2 * i + 1] - line[2 * i - 1] + 128);
  }
}

/// Number of equal bytes from `from` on, at most kLongestRun.
size_t run_length(const uint8_t* from, const uint8_t* end) {
  const size_t most = std::min(static_cast<size_t>(end - from), kLongestRun);
  const uint64_t same = 0x0101010101010101ull * *from;
  size_t length = 1;
  while (length + sizeof same <= most) {
    const uint64_t other = word_at(from + length) ^ same;
    if (other != 0) return length + static_cast<size_t>(std::countr_zero(other)) / 8;
    length += sizeof same;
  }
  while (length < most && from[length] == *from) ++length;
  return length;
}

/// The first byte from `from` on that starts a run of three; `end` if there is none.
const uint8_t* find_run(const uint8_t* from, const uint8_t* end) {
  constexpr uint64_t kOnes = 0x0101010101010101ull;
  constexpr ptrdiff_t kWindow = sizeof(uint64_t) + kShortestRun - 1;
  for (; end - from >= kWindow; from += sizeof(uint64_t)) {
    const uint64_t next = word_at(from + 1);
    const uint64_t differ = (word_at(from) ^ next) | (next ^ word_at(from + 2));
    // The lowest set bit belongs to the first zero byte.
    const uint64_t zeros = (differ - kOnes) & ~differ & (kOnes << 7);
    if (zeros != 0) return from + std::countr_zero(zeros) / 8;
  }
  for (; end - from >= static_cast<ptrdiff_t>(kShortestRun); ++from) {
    if (from[0] == from[1] && from[1] == from[2]) return from;
  }
  return end;
}

}  // namespace

bool RleLinePacker::pack(const uint8_t* line, size_t size) {
  differences_.resize(size);
  // Incompressible data grows by one count per kMostLiterals bytes.
  packed_.resize(size + size / kMostLiterals + 2);
  take_differences(line, size, differences_.data());

  const uint8_t* at = differences_.data();
  const uint8_t* const end = at + size;
  const uint8_t* run = find_run(at, end);
  uint8_t* out = packed_.data();
  while (at < end) {
    if (at == run) {
      const size_t length = run_length(at, end);
      *out++ = static_cast<uint8_t>(length - 1);
      *out++ = *at;
      at += length;
      run = find_run(at, end);
      continue;
    }
    const size_t literals = std::min(static_cast<size_t>(run - at), kMostLiterals);
    *out++ = static_cast<uint8_t>(-static_cast<int>(literals));
    std::memcpy(out, at, literals);
    out += literals;
    at += literals;
  }
  packed_size_ = static_cast<size_t>(out - packed_.data());
  return packed_size_ < size;
}

}  // namespace snowbough::image
