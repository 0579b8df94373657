#include "tree/obj/text.h"

#include <gtest/gtest.h>

namespace snowbough::tree {
namespace {

TEST(Text, Utf8StaysAndOtherBytesAreLatin1) {
  EXPECT_EQ(to_utf8("bark"), "bark");
  EXPECT_EQ(to_utf8("\xc3\xa9"), "\xc3\xa9");
  EXPECT_EQ(to_utf8("\xe6\xa8\xb9"), "\xe6\xa8\xb9");
  EXPECT_EQ(to_utf8("\xe9"), "\xc3\xa9");
  EXPECT_EQ(to_utf8("\xdf!"), "\xc3\x9f!");
}

TEST(Text, WhatOnlyLooksLikeUtf8IsNone) {
  // Cut off, longer than it needs to be, half of a pair, beyond the last character.
  for (const char* bytes :
       {"\xc3", "\xe6\xa8", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    EXPECT_EQ(to_utf8(bytes).size(), 2 * std::string(bytes).size());
  }
}

TEST(Text, SmallLettersOfAsciiAndLatin1) {
  EXPECT_EQ(lower_case("Bark_07 Z"), "bark_07 z");
  EXPECT_EQ(lower_case("\xc3\x89"
                       "CORCE"),
            "\xc3\xa9"
            "corce");
  EXPECT_EQ(lower_case("\xc3\x97"), "\xc3\x97");
  EXPECT_EQ(lower_case("\xc4\x89"), "\xc4\x89");
}

}  // namespace
}  // namespace snowbough::tree
