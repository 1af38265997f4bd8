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
  EXPECT_EQ(printable("\xE2\033[m"), std::string("\xE2") + "?[m");
  EXPECT_EQ(printable(std::string_view("\0", 1)), "?");
}

TEST(PrintableText, PiecesMayBreakCharacters) {
  const std::string text = "m² → \xC2\x9B 𝄞";
  PrintableText by_bytes;
  std::string out;
  for (const char c : text) out += by_bytes.of(std::string_view(&c, 1));
  EXPECT_EQ(out, printable(text));
}

}  // namespace
}  // namespace prospect::printable_text_test
