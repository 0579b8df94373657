#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace snowbough::image {

/// System calls on files, which differ between systems. On failure they return a value below 0, or
/// false, and set errno. Paths are UTF-8.

int create_file(const std::string& path);
int open_file(const std::string& path);
/// Size in bytes; 0 = unknown.
uint64_t file_size(int descriptor);
/// May read or write less than asked for.
int64_t read_some(int descriptor, char* bytes, size_t count);
int64_t write_some(int descriptor, std::string_view bytes);
/// Waits until the bytes are on the disk.
bool flush_file(int descriptor);
bool close_file(int descriptor);
/// Atomic for readers of `to`, even if `to` exists.
bool rename_over(const std::string& from, const std::string& to);
void remove_file(const std::string& path);
int process_number();

}  // namespace snowbough::image
