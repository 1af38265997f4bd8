// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/page/binary_text.h"

#include <gtest/gtest.h>

namespace prospect::binary_text_test {
namespace {

TEST(BinaryText, Base64AsInRfc4648) {
  // The examples of section 10; a letter is a varint of one byte.
  const auto encode = [](const std::string& letters) {
    BinaryText text;
    for (const char c : letters) text.add_varint(static_cast<std::uint64_t>(c));
    return text.base64();
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

TEST(BinaryText, VarintsFloatsAndBytesByHand) {
  BinaryText text;
  text.add_varint(300);  // 0xAC 0x02
  text.add_varint(127);  // 0x7F
  EXPECT_EQ(text.base64(), "rAJ/");
  BinaryText signs;
  for (const int value : {0, -1, 1, -2, 64, -65}) signs.add_signed_varint(value);
  BinaryText as_unsigned;
  for (const unsigned value : {0U, 1U, 2U, 3U, 128U, 129U}) as_unsigned.add_varint(value);
  EXPECT_EQ(signs.base64(), as_unsigned.base64());
  BinaryText number;
  number.add_float(1.0);  // 00 00 80 3F
  EXPECT_EQ(number.base64(), "AACAPw==");
  BinaryText bytes;
  bytes.add_bytes({0xAC, 0x02, 0x7F});
  EXPECT_EQ(bytes.base64(), "rAJ/");
}

}  // namespace
}  // namespace prospect::binary_text_test
