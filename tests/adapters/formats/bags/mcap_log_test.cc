// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/bags/mcap_log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "tests/adapters/ros_bag_writer.h"

namespace prospect::mcap_log_test {
namespace {

namespace fs = std::filesystem;

const std::vector<McapLog::Channel> kChannels = {{"/a", "std_msgs/msg/String", "string data\n"},
                                                 {"/b", "std_msgs/msg/String", "string data\n"}};

std::string path(const std::string& name) {
  return testing::TempDir() + "mcap_log_" + std::to_string(getpid()) + name;
}

TEST(McapLog, ThreadsWriteToOneFile) {
  const std::string file = path(".mcap");
  std::vector<McapLog::Count> counts;
  {
    McapLog log(file, kChannels);
    const auto write = [&](std::size_t channel) {
      for (int i = 0; i < 500; ++i) {
        EXPECT_TRUE(log.put(channel, 1 + i, test::CdrWriter().text(std::to_string(i)).str()));
      }
    };
    std::thread a([&] { write(0); }), b([&] { write(1); });
    a.join();
    b.join();
    log.finish();
    EXPECT_EQ(log.error(), "");
    counts = log.counts();
    EXPECT_FALSE(log.put(0, 1, "late"));
  }
  EXPECT_EQ(dropped_text(counts), "");
  const BagFile bag = BagFile::open(file);
  ASSERT_EQ(bag.topics().size(), 2U);
  for (const BagTopic& topic : bag.topics()) {
    ASSERT_EQ(topic.messages.size(), 500U);
    for (std::size_t i = 1; i < 500; ++i) {
      EXPECT_LT(topic.messages[i - 1].time, topic.messages[i].time);
    }
  }
  fs::remove(file);
}

// A pipe that nobody reads: a disk that hangs.
TEST(McapLog, ADiskThatHangsDropsAndDoesNotBlock) {
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  const std::string file = path(".pipe");
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  const int reader = open(file.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  McapLogOptions options;
  options.capacity = 100'000;
  options.longest_chunk = 0.01;
  options.file.chunk_size = 1000;
  McapLog log(file, kChannels, options);
  const std::string noise(5000, 'x');
  const auto start = std::chrono::steady_clock::now();
  int dropped = 0;
  std::string bytes = noise;
  for (int i = 0; i < 2000; ++i) {
    for (char& c : bytes) c = static_cast<char>(c * 1664525 + i + 1013904223);  // does not compress
    dropped += log.put(0, i, bytes) ? 0 : 1;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_GT(dropped, 1000);
  EXPECT_LT(took.count(), 5.0);
  EXPECT_EQ(log.counts()[0].put, 2000U);
  EXPECT_EQ(log.counts()[0].dropped, static_cast<std::uint64_t>(dropped));
  EXPECT_EQ(dropped_text(log.counts()),
            std::to_string(dropped) + " of 2000 messages were dropped: " + std::to_string(dropped) +
                " of /a");
  close(reader);  // the writer's next write fails
  log.finish();
  EXPECT_EQ(log.error(), "Broken pipe");
  std::signal(SIGPIPE, before);
  fs::remove(file);
}

TEST(McapLog, AFullDiskIsSaidAndEverythingAfterItCounted) {
  McapLogOptions options;
  options.wait = true;
  McapLog log("/dev/full", kChannels, options);
  EXPECT_EQ(log.error(), "No space left on device");
  EXPECT_FALSE(log.put(1, 0, "x")) << "and nobody waits for room";
  EXPECT_EQ(dropped_text(log.counts()), "1 of 1 messages were dropped: 1 of /b");
}

TEST(McapLog, WhoMayWaitLosesNothing) {
  const std::string file = path("_wait.mcap");
  McapLogOptions options;
  options.wait = true;
  options.capacity = 1000;
  McapLog log(file, kChannels, options);
  for (int i = 0; i < 300; ++i) EXPECT_TRUE(log.put(0, i, std::string(900, 'x')));
  log.finish();
  EXPECT_EQ(BagFile::open(file).topics()[0].messages.size(), 300U);
  fs::remove(file);
}

}  // namespace
}  // namespace prospect::mcap_log_test
