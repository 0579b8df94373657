#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace snowbough::base {

/// File names are UTF-8 text throughout. Windows reads narrow text in a code page with few letters,
/// so names are converted by these two functions.
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

/// The path for opening a file. Windows accepts more than 260 characters only with the prefix
/// `\\?\`, and then neither dots nor forward slashes as separators.
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
