#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace snowbough::base {

/// Files are named by UTF-8 text throughout. On Windows the system takes other text, with narrow
/// names in a code page that holds few letters, so names go through these two.
inline std::filesystem::path as_path(std::string_view text) {
#ifdef _WIN32
  return std::u8string(text.begin(), text.end());
#else
  return text;
#endif
}

inline std::string as_text(const std::filesystem::path& path) {
#ifdef _WIN32
  const std::u8string text = path.generic_u8string();
  return {text.begin(), text.end()};
#else
  return path.string();
#endif
}

/// The path under which a file is opened: Windows takes more than 260 characters only behind a
/// prefix of its own, and then no path with dots or forward slashes in it.
inline std::filesystem::path openable(const std::filesystem::path& path) {
#ifdef _WIN32
  constexpr size_t kShort = 240;
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::absolute(path, error).lexically_normal();
  std::wstring text = whole.native();
  if (error || text.size() < kShort || text.starts_with(L"\\\\?\\")) return path;
  for (wchar_t& letter : text) {
    if (letter == L'/') letter = L'\\';
  }
  return text.starts_with(L"\\\\") ? L"\\\\?\\UNC" + text.substr(1) : L"\\\\?\\" + text;
#else
  return path;
#endif
}

}  // namespace snowbough::base
