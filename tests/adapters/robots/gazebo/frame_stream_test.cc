// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/frame_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect::frame_stream_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A stream, and the other end of its connection as a bare descriptor.
struct Connection {
  explicit Connection(std::size_t limit = 1000) : stream(ends(limit)) {}
  ~Connection() { hang_up(); }
  FrameStream ends(std::size_t limit) {
    std::array<int, 2> pair{};
    ::socketpair(AF_UNIX, SOCK_STREAM, 0, pair.data());
    other = pair[1];
    return {pair[0], limit};
  }
  void write(std::string_view bytes) const {
    ASSERT_EQ(::write(other, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  void hang_up() {
    if (other >= 0) ::close(other);
    other = -1;
  }
  std::vector<std::string> receive() {
    std::vector<std::string> frames;
    stream.receive([&](std::string_view frame) { frames.emplace_back(frame); });
    return frames;
  }

  int other = -1;
  FrameStream stream;
};

TEST(FrameStream, WritesALengthInHexadecimalAndTheBytes) {
  Connection c;
  c.stream.send("0123456789abcdef!");
  std::array<char, 100> read{};
  const ssize_t size = ::read(c.other, read.data(), read.size());
  EXPECT_EQ(std::string(read.data(), static_cast<std::size_t>(size)), "      110123456789abcdef!");
}

TEST(FrameStream, HandsOnWholeFramesOnly) {
  Connection c;
  c.write("       2ab00000001c       0       3de");
  EXPECT_THAT(c.receive(), ElementsAre("ab", "c", ""));
  EXPECT_THAT(c.receive(), IsEmpty());
  c.write("f    ");
  EXPECT_THAT(c.receive(), ElementsAre("def"));
  c.write("   1x");
  EXPECT_THAT(c.receive(), ElementsAre("x"));
  EXPECT_EQ(c.stream.closed(), "");
}

TEST(FrameStream, ClosesAtWhatIsNoFrame) {
  for (const auto& [bytes, why] : {std::pair{"     3e9", "1001 bytes; at most 1000"},
                                   {"ffffffff", "at most 1000"},
                                   {"GET / HT", "without a length"},
                                   {"        ", "without a length"},
                                   {"      -1", "without a length"},
                                   {"    1  2", "without a length"}}) {
    Connection c;
    c.write(bytes);
    EXPECT_THAT(c.receive(), IsEmpty());
    EXPECT_THAT(c.stream.closed(), HasSubstr(why)) << bytes;
    EXPECT_EQ(c.stream.descriptor(), -1);
    c.stream.send("ignored");
  }
}

TEST(FrameStream, SaysHowTheOtherSideEnded) {
  Connection whole;
  whole.write("       1a");
  whole.hang_up();
  EXPECT_THAT(whole.receive(), ElementsAre("a"));
  EXPECT_THAT(whole.receive(), IsEmpty());
  EXPECT_EQ(whole.stream.closed(), "the other side closed it");
  Connection torn;
  torn.write("       9a");
  torn.hang_up();
  EXPECT_THAT(torn.receive(), IsEmpty());
  EXPECT_THAT(torn.receive(), IsEmpty());
  EXPECT_EQ(torn.stream.closed(), "the other side closed it within a frame");
}

TEST(FrameStream, QueuesNoMoreThanItsBoundForWhoDoesNotRead) {
  Connection c;
  const std::string frame(100000, 'x');
  int sent = 0;
  for (; sent < 100 && c.stream.closed().empty(); ++sent) c.stream.send(frame);
  EXPECT_GE(sent, static_cast<int>(FrameStream::kMostQueued / frame.size()));
  EXPECT_LT(sent, 100);
  EXPECT_EQ(c.stream.closed(), "the other side does not read");
}

TEST(FrameStream, NamesTheAddressAtWhichNobodyListens) {
  try {
    FrameStream::connect("127.0.0.1", 1, 1.0, 1000);
    FAIL() << "it connected";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("127.0.0.1:1: "));
    EXPECT_THAT(error.what(), HasSubstr("expected a Gazebo that runs"));
  }
}

}  // namespace
}  // namespace prospect::frame_stream_test
