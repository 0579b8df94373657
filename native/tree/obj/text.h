#pragma once

#include <string>
#include <string_view>

namespace snowbough::tree {

/// Converts names to UTF-8 for display and comparison. Text that is not UTF-8 is read as Latin-1:
/// older exporters wrote names in the Windows code page.
std::string to_utf8(std::string_view text);

/// Lower case of the letters of ASCII and, in UTF-8, of Latin-1.
std::string lower_case(std::string_view text);

/// Replaces `\r` line ends of old Macs by `\n`. One at the very end stays, since a `\n` may follow.
void end_lines_by_newline(char* begin, char* end);

}  // namespace snowbough::tree
