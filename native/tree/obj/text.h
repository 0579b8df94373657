#pragma once

#include <string>
#include <string_view>

namespace snowbough::tree {

/// Names as UTF-8, which is what they are shown and compared as. Text that is no UTF-8 is taken for
/// Latin-1: older exporters wrote names in the code page of their Windows.
std::string to_utf8(std::string_view text);

/// In small letters: those of ASCII and, in UTF-8, of Latin-1.
std::string lower_case(std::string_view text);

/// Ends lines by `\n` that end by a mere `\r`, as old Macs' do. One at the very end stays: a `\n`
/// may follow.
void end_lines_by_newline(char* begin, char* end);

}  // namespace snowbough::tree
