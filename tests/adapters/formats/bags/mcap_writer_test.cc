// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/bags/mcap_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/files/input_error.h"
#include "tests/adapters/ros_bag_writer.h"

namespace prospect::mcap_writer_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string content(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

class McapWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "mcap_writer_" + std::to_string(getpid()) + ".mcap";
    fs::remove(path_);
  }
  void TearDown() override { fs::remove(path_); }

  /// Message i of a text, in CDR.
  static std::string message(int i) {
    return test::CdrWriter().text("message " + std::to_string(i)).str();
  }
  /// So many messages on two channels in turn, some to a chunk.
  void write(int messages, bool close = true) {
    McapWriterOptions options;
    options.chunk_size = 400;
    McapWriter writer(path_, options);
    writer.metadata("run", {{"seed", "7"}, {"command", "explore"}});
    const std::uint16_t a = writer.add_channel("/a", "std_msgs/msg/String", "string data\n");
    const std::uint16_t b = writer.add_channel("/b", "std_msgs/msg/String", "string data\n");
    writer.add_channel("/silent", "std_msgs/msg/String", "string data\n");
    for (int i = 0; i < messages; ++i) {
      EXPECT_TRUE(
          writer.message(i % 2 == 0 ? a : b, 1000 + static_cast<std::uint64_t>(i), message(i)));
    }
    if (close) writer.close();
    EXPECT_EQ(writer.error(), "");
    EXPECT_EQ(writer.bytes_written(), fs::file_size(path_));
  }
  std::string path_;
};

std::uint64_t number(const std::string& bytes, std::size_t at, int size) {
  std::uint64_t value = 0;
  for (int i = size - 1; i >= 0; --i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  }
  return value;
}

TEST_F(McapWriterTest, IsReadBack) {
  write(50);
  const BagFile bag = BagFile::open(path_);
  EXPECT_THAT(bag.notes(), testing::IsEmpty());
  ASSERT_EQ(bag.topics().size(), 2U) << "a channel without messages is none";
  int i = 0;
  const BagTopic *a = bag.find("/a"), *b = bag.find("/b");
  ASSERT_NE(a, nullptr);
  ASSERT_NE(b, nullptr);
  EXPECT_EQ(a->type, "std_msgs/msg/String");
  EXPECT_EQ(a->messages.size() + b->messages.size(), 50U);
  for (; i < 50; ++i) {
    const BagTopic& topic = i % 2 == 0 ? *a : *b;
    const BagTopic::Message& m = topic.messages[static_cast<std::size_t>(i / 2)];
    EXPECT_EQ(m.time, 1000 + i);
    EXPECT_EQ(bag.read(m), message(i));
  }
}

TEST_F(McapWriterTest, ChecksumsAndOffsetsAreRight) {
  write(50);
  const std::string bytes = content(path_);
  const std::string magic = bytes.substr(0, 8);
  ASSERT_EQ(bytes.substr(bytes.size() - 8), magic);
  // Footer: opcode, length, start of the summary, of its offsets, checksum.
  const std::size_t footer = bytes.size() - 8 - 29;
  ASSERT_EQ(bytes[footer], 2);
  const std::uint64_t summary = number(bytes, footer + 9, 8);
  const auto crc = [&](std::size_t from, std::size_t to) {
    return crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data() + from), to - from);
  };
  EXPECT_EQ(number(bytes, footer + 25, 4), crc(summary, footer + 25));
  // Data end: before the summary.
  const std::size_t data_end = summary - 13;
  ASSERT_EQ(bytes[data_end], 15);
  EXPECT_EQ(number(bytes, data_end + 9, 4), crc(0, data_end));
  // Records of the summary, by opcode; offsets lead to where they say.
  std::map<int, int> counts;
  for (std::size_t at = summary; at < footer; at += 9 + number(bytes, at + 1, 8)) {
    ++counts[bytes[at]];
    if (bytes[at] == 8) {
      EXPECT_EQ(bytes[number(bytes, at + 9 + 16, 8)], 6) << "a chunk";
    }
    if (bytes[at] == 13) {
      EXPECT_EQ(bytes[number(bytes, at + 9, 8)], 12) << "metadata";
    }
    if (bytes[at] == 14) {
      EXPECT_EQ(bytes[number(bytes, at + 10, 8)], bytes[at + 9]) << "a group of such records";
    }
    if (bytes[at] == 11) {
      EXPECT_EQ(number(bytes, at + 9, 8), 50U) << "messages";
    }
  }
  EXPECT_EQ(counts[3], 2);
  EXPECT_EQ(counts[4], 2);
  EXPECT_EQ(counts[11], 1);
  EXPECT_GT(counts[8], 5);
  EXPECT_EQ(counts[13], 1);
  EXPECT_EQ(counts[14], 5);
}

// What a kill leaves: the file up to any byte.
TEST_F(McapWriterTest, WhateverIsCutOffAllWholeChunksAreRead) {
  write(24, false);
  const std::string bytes = content(path_);
  std::size_t most = 0, before = 0;
  for (std::size_t size = 8; size <= bytes.size(); size += 7) {
    std::ofstream(path_, std::ios::binary) << bytes.substr(0, size);
    std::size_t read = 0;
    try {
      const BagFile bag = BagFile::open(path_);
      for (const BagTopic& topic : bag.topics()) read += topic.messages.size();
      ASSERT_EQ(bag.notes().size(), 1U);
      EXPECT_THAT(bag.notes()[0], HasSubstr("ends early"));
      EXPECT_EQ(bag.read(bag.find("/a")->messages[0]), message(0));
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("no message"));
    }
    EXPECT_GE(read, before) << "of " << size << " bytes";
    before = read;
    most = std::max(most, read);
  }
  EXPECT_GE(most, 16U) << "all but the chunk that was being filled";
}

TEST_F(McapWriterTest, OneFlippedBitIsSeen) {
  write(24);
  std::string bytes = content(path_);
  std::size_t chunk = 8;
  while (bytes[chunk] != 6) chunk += 9 + number(bytes, chunk + 1, 8);
  bytes[chunk + 80] ^= 1;
  std::ofstream(path_, std::ios::binary) << bytes;
  EXPECT_THROW(BagFile::open(path_), InputError);
}

TEST_F(McapWriterTest, AFullDiskIsRememberedAndNothingFollows) {
  McapWriter full("/dev/full");
  EXPECT_EQ(full.error(), "No space left on device");
  const std::uint16_t channel = full.add_channel("/a", "std_msgs/msg/String", "");
  EXPECT_FALSE(full.message(channel, 0, message(0)));
  full.close();
  const McapWriter nowhere("/nowhere/at.mcap");
  EXPECT_EQ(nowhere.error(), "No such file or directory");
}

}  // namespace
}  // namespace prospect::mcap_writer_test
