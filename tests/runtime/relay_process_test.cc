// SPDX-License-Identifier: Apache-2.0
#include "runtime/relay_process.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <optional>
#include <utility>
#include <vector>

namespace prospect::relay_process_test {
namespace {

struct Number {
  double value = 0.0;
};

void wait_for(int descriptor) {
  pollfd waits{descriptor, POLLIN, 0};
  ::poll(&waits, 1, 5000);
}

/// The next number, within 5 s.
LinkRead read_one(const RelayProcess& process, Number& number) {
  process.wait(5.0);
  return receive_on(process.link(), number);
}

/// Answers with twice each number until its owner is gone.
void doubles(int link) {
  for (;;) {
    wait_for(link);
    Number number;
    const LinkRead read = receive_on(link, number);
    if (read == LinkRead::kEnded) return;
    if (read == LinkRead::kMessage) send_on(link, Number{2.0 * number.value});
  }
}

TEST(RelayProcess, PassesMessagesWhole) {
  RelayProcess process("test", {}, doubles);
  Number number;
  EXPECT_EQ(receive_on(process.link(), number), LinkRead::kNothing);
  for (const double value : {1.0, -2.5}) {
    ASSERT_TRUE(send_on(process.link(), Number{value}));
    ASSERT_EQ(read_one(process, number), LinkRead::kMessage);
    EXPECT_EQ(number.value, 2.0 * value);
  }
}

TEST(RelayProcess, DoesNotHeedCtrlC) {
  RelayProcess process("test", {}, doubles);
  Number number;
  ASSERT_TRUE(send_on(process.link(), Number{1.0}));
  ASSERT_EQ(read_one(process, number), LinkRead::kMessage);
  for (const int signal : {SIGINT, SIGHUP, SIGTERM}) ::kill(process.process(), signal);
  ASSERT_TRUE(send_on(process.link(), Number{3.0}));
  EXPECT_EQ(read_one(process, number), LinkRead::kMessage);
}

TEST(RelayProcess, ItsEndIsSeen) {
  Number number;
  const RelayProcess over("test", {}, [](int) {});
  EXPECT_EQ(read_one(over, number), LinkRead::kEnded);
  RelayProcess killed("test", {}, doubles);
  killed.kill();
  EXPECT_EQ(read_one(killed, number), LinkRead::kEnded);
}

TEST(RelayProcess, AnotherMessageIsTakenForAnEnd) {
  const RelayProcess process("test", {}, [](int link) { send_on(link, 'x'); });
  Number number;
  EXPECT_EQ(read_one(process, number), LinkRead::kEnded);
}

TEST(RelayProcess, HoldsOpenWhatItIsToldToAlone) {
  std::array<int, 2> kept{}, other{};
  ASSERT_EQ(::pipe(kept.data()), 0);
  ASSERT_EQ(::pipe(other.data()), 0);
  std::optional<RelayProcess> process(std::in_place, "test", std::vector{kept[1]}, [&](int link) {
    doubles(link);
    // After its owner.
    [[maybe_unused]] const auto n = ::write(kept[1], "x", 1);
  });
  ::close(kept[1]);
  ::close(other[1]);
  char byte = 0;
  wait_for(other[0]);
  EXPECT_EQ(::read(other[0], &byte, 1), 0) << "nobody can write to it any more";
  process.reset();
  EXPECT_EQ(::read(kept[0], &byte, 1), 1);
  EXPECT_EQ(byte, 'x');
  ::close(kept[0]);
  ::close(other[0]);
}

}  // namespace
}  // namespace prospect::relay_process_test
