// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/printable_text.h"

#include <gtest/gtest.h>

#include <string>

namespace prospect::printable_text_test {
namespace {

TEST(PrintableText, NoControlCharacterReachesATerminal) {
  EXPECT_EQ(printable("a\tb\n"), "a\tb\n");
  EXPECT_EQ(printable("m² → ▉ 𝄞"), "m² → ▉ 𝄞");
  EXPECT_EQ(printable("\033[2J\033]0;x\a\r\b\x7f.dae"), "?[2J?]0;x????.dae");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "?31m");  // CSI in UTF-8
  EXPECT_EQ(printable("\x9B"
                      "31m"),
            "?31m");  // and as a byte
  EXPECT_EQ(printable("\xE2\033[m"), "??[m");
  EXPECT_EQ(printable(std::string_view("\0", 1)), "?");
}

// A name that reads from right to left looks like another one.
TEST(PrintableText, NothingTurnsOrBreaksALine) {
  EXPECT_EQ(printable("exe.\u202Efdp"), "exe.?fdp");
  for (const char* turns :
       {"\u200E", "\u200F", "\u061C", "\u2028", "\u2029", "\u202A", "\u2066", "\u2069"}) {
    EXPECT_EQ(printable(turns), "?");
  }
  for (const char* stays : {"\u200D", "\u2010", "\u2027", "\u202F", "\u2065", "\u206A", "\u061B"}) {
    EXPECT_EQ(printable(stays), stays);
  }
}

TEST(PrintableText, WhatIsNoUtf8IsNotPrinted) {
  // CSI, and a line feed, written longer than they are; half of a pair; beyond the last character.
  for (const char* bytes :
       {"\xE0\x82\x9B", "\xE0\x80\x8A", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xF0\x80\x82\x9B"}) {
    EXPECT_EQ(printable(bytes), "?");
  }
  EXPECT_EQ(printable("\xF4\x8F\xBF\xBF"), "\xF4\x8F\xBF\xBF");
  EXPECT_EQ(printable("a\xE2\x82"), "a??");
  EXPECT_EQ(printable("\xC2"), "?");
  EXPECT_EQ(printable("\xF5\xFF\xC0\x80"), "????");
}

TEST(PrintableText, PiecesMayBreakCharacters) {
  const std::string text = "m² → \xC2\x9B 𝄞 \xE2\x80\xAE \xE2 a";
  PrintableText by_bytes;
  std::string out;
  for (const char c : text) out += by_bytes.of(std::string_view(&c, 1));
  EXPECT_EQ(out, printable(text));
}

}  // namespace
}  // namespace prospect::printable_text_test
