#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace snowbough::image {

/// What differs between systems in writing and reading a file. A descriptor below 0, a count below
/// 0 and false mean that errno says why not. Paths are UTF-8.

int create_file(const std::string& path);
int open_file(const std::string& path);
/// How long it is, or 0 where that is not known.
uint64_t file_size(int descriptor);
/// May read or write less than asked for.
int64_t read_some(int descriptor, char* bytes, size_t count);
int64_t write_some(int descriptor, std::string_view bytes);
int64_t write_some_at(int descriptor, uint64_t offset, std::string_view bytes);
/// Waits until the bytes are on the disk.
bool flush_file(int descriptor);
bool close_file(int descriptor);
/// In one step for everybody who reads `to`, also where it is there already.
bool rename_over(const std::string& from, const std::string& to);
void remove_file(const std::string& path);
int process_number();

}  // namespace snowbough::image
