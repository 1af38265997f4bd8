// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/lzf.h"

#include <gtest/gtest.h>

#include <string>

namespace prospect::lzf_test {
namespace {

// Blocks by the format's description.
const std::string kPlain(
    "\x02"
    "abc",
    4);
const std::string kRepeated(
    "\x02"
    "abc"
    "\x80\x02",
    6);  // 6 bytes again from 3 before
const std::string kLong(
    "\x00"
    "x"
    "\xe0\x05\x00",
    5);  // 14 bytes again from 1 before

TEST(Lzf, TakesBytesAsTheyAreAndAgain) {
  EXPECT_EQ(lzf_decompressed(kPlain, 3), "abc");
  EXPECT_EQ(lzf_decompressed(kRepeated, 9), "abcabcabc");
  EXPECT_EQ(lzf_decompressed(kLong, 15), std::string(15, 'x'));
}

TEST(Lzf, WhatIsNoBlockOfThatSizeGivesNothing) {
  EXPECT_EQ(lzf_decompressed("", 3), "");
  EXPECT_EQ(lzf_decompressed(kPlain, 2), "");
  EXPECT_EQ(lzf_decompressed(kPlain, 4), "");
  EXPECT_EQ(lzf_decompressed(kRepeated, 8), "");
  EXPECT_EQ(lzf_decompressed(kPlain.substr(0, 3), 3), "");
  EXPECT_EQ(lzf_decompressed(kRepeated.substr(0, 5), 9), "");
  EXPECT_EQ(lzf_decompressed(kLong.substr(0, 3), 15), "");
  EXPECT_EQ(lzf_decompressed(std::string("\x00x\x20\x05", 4), 4), "");  // before the beginning
  EXPECT_EQ(lzf_decompressed(kLong, std::size_t{1} << 31), "");         // no memory for it
}

}  // namespace
}  // namespace prospect::lzf_test
