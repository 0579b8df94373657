#include "tree/obj/text.h"

#include <cstdint>
#include <cstring>

namespace snowbough::tree {
namespace {

/// Length of a UTF-8 character by its first byte; 0 for an invalid one.
size_t length_of(uint8_t first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return 2;
  if (first >= 0xe0 && first < 0xf0) return 3;
  return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

uint8_t byte(char c) {
  return static_cast<uint8_t>(c);
}

/// The Unicode Standard 15.0, table 3-7: no surrogates and no overlong forms.
bool is_utf8(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    const uint8_t first = byte(text[at]);
    const size_t length = length_of(first);
    if (length == 0 || at + length > text.size()) return false;
    for (size_t k = 1; k < length; ++k) {
      if ((byte(text[at + k]) & 0xc0) != 0x80) return false;
    }
    const uint8_t second = length > 2 ? byte(text[at + 1]) : 0;
    if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
        (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
      return false;
    }
    at += length;
  }
  return true;
}

}  // namespace

std::string to_utf8(std::string_view text) {
  if (is_utf8(text)) return std::string(text);
  std::string wide;
  for (const char c : text) {
    if (byte(c) < 0x80) {
      wide += c;
    } else {
      wide += static_cast<char>(0xc0 | byte(c) >> 6);
      wide += static_cast<char>(0x80 | (byte(c) & 0x3f));
    }
  }
  return wide;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (size_t i = 0; i < lower.size(); ++i) {
    if (lower[i] >= 'A' && lower[i] <= 'Z') {
      lower[i] = static_cast<char>(lower[i] + ('a' - 'A'));
    } else if (i > 0 && byte(lower[i - 1]) == 0xc3 && byte(lower[i]) >= 0x80 &&
               byte(lower[i]) <= 0x9e && byte(lower[i]) != 0x97) {
      // From capital A with grave accent on, except the multiplication sign.
      lower[i] = static_cast<char>(byte(lower[i]) + 0x20);
    }
  }
  return lower;
}

void end_lines_by_newline(char* begin, char* end) {
  while (begin != end) {
    auto* at = static_cast<char*>(std::memchr(begin, '\r', static_cast<size_t>(end - begin)));
    if (at == nullptr || at + 1 == end) return;
    if (at[1] != '\n') *at = '\n';
    begin = at + 1;
  }
}

}  // namespace snowbough::tree
