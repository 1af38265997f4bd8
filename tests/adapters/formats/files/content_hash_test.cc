// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/content_hash.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <set>
#include <string>

#include "adapters/formats/files/input_error.h"

namespace prospect::content_hash_test {
namespace {

TEST(ContentHash, IsTheSameOnEveryMachine) {
  const char bytes[] = {'f', 'o', 'o', 'b', 'a', 'r'};
  // FNV-1a of "foobar", as its authors publish it, and then the mixing.
  std::uint64_t x = 0x85944171f73967e8ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  x ^= x >> 31;
  EXPECT_EQ(ContentHash().add(bytes, sizeof bytes).value(), x);
  EXPECT_EQ(hash_text(0x12abu), "00000000000012ab");
}

TEST(ContentHash, TellsContentsApart) {
  std::set<std::uint64_t> all;
  all.insert(ContentHash().add("ab").add("c").value());
  all.insert(ContentHash().add("a").add("bc").value());
  all.insert(ContentHash().add("abc").value());
  all.insert(ContentHash().add("abc").add("").value());
  all.insert(ContentHash().add(0.0).value());
  all.insert(ContentHash().add(-0.0).value());
  all.insert(ContentHash().add(std::uint64_t{1}).value());
  EXPECT_EQ(all.size(), 7U);
}

TEST(ContentHash, OfAFileIsThatOfItsBytes) {
  const std::string path = ::testing::TempDir() + "content_hash_test.bin";
  std::string bytes(100000, 'x');
  bytes += '\0';
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_EQ(file_hash(path), ContentHash().add(bytes.data(), bytes.size()).value());
  EXPECT_THROW(file_hash(path + ".none"), InputError);
}

}  // namespace
}  // namespace prospect::content_hash_test
