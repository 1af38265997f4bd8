// SPDX-License-Identifier: Apache-2.0
#include "docs/examples/create2/create2_protocol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/examples/fake_create2.h"

namespace prospect::create2_protocol_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Create2Protocol, VelocitiesAreWheelSpeedsInMillimetresASecond) {
  struct Case {
    double speed, yaw_rate;
    int right, left;  // [mm/s]
  };
  for (const Case& c :
       {Case{0.2, 0.0, 200, 200}, Case{-0.1, 0.0, -100, -100}, Case{0.0, 1.0, 118, -118},
        Case{0.2, 1.0, 318, 83}, Case{0.5, 1.0, 500, 310},  // the arc stays: 0.6175 to 0.3825
        Case{9.0, 0.0, 500, 500}, Case{std::nan(""), 1.0, 0, 0}, Case{0.2, HUGE_VAL, 0, 0}}) {
    const Bytes bytes = create2_drive({{c.speed, 0.0, 0.0}, c.yaw_rate});
    ASSERT_EQ(bytes.size(), 5u);
    EXPECT_EQ(bytes[0], 145);
    EXPECT_NEAR(static_cast<std::int16_t>(bytes[1] * 256 + bytes[2]), c.right, 1) << c.speed;
    EXPECT_NEAR(static_cast<std::int16_t>(bytes[3] * 256 + bytes[4]), c.left, 1) << c.speed;
  }
}

Create2Sensors some() {
  Create2Sensors s;
  s.mode = 2;
  s.charge = 1234, s.capacity = 2600;
  s.left_count = -2, s.right_count = 32767;
  return s;
}

TEST(Create2Protocol, PacketsAreFoundWhereverTheyAreCut) {
  const Bytes one = test::create2_packet(some());
  Bytes all = {19, 30, 7, 1, 2, 3};  // the end of one that began before
  for (int k = 0; k < 3; ++k) all.insert(all.end(), one.begin(), one.end());
  for (std::size_t cut = 1; cut < all.size(); cut += 7) {
    Create2Stream stream;
    std::vector<Create2Sensors> found;
    for (std::size_t at = 0; at < all.size(); at += cut) {
      const std::size_t size = std::min(cut, all.size() - at);
      for (const Create2Sensors& s : stream.add({all.data() + at, size})) found.push_back(s);
    }
    ASSERT_EQ(found.size(), 3u) << cut;
    for (const Create2Sensors& s : found) EXPECT_EQ(s, some());
    EXPECT_EQ(stream.dropped(), 6u);
  }
}

TEST(Create2Protocol, NoWrongByteGetsThroughAndTheNextPacketIsFound) {
  const Bytes one = test::create2_packet(some());
  for (std::size_t wrong = 0; wrong < one.size(); ++wrong) {
    for (const int change : {1, 0x80, 0xFF}) {
      Bytes bytes = one;
      bytes[wrong] = static_cast<std::uint8_t>(bytes[wrong] ^ change);
      bytes.insert(bytes.end(), one.begin(), one.end());
      Create2Stream stream;
      const std::vector<Create2Sensors> found = stream.add(bytes);
      ASSERT_EQ(found.size(), 1u) << wrong;
      EXPECT_EQ(found[0], some());
    }
  }
}

TEST(Create2Protocol, CountsGoTheShortWayRound) {
  EXPECT_EQ(counts_between(100, 130), 30);
  EXPECT_EQ(counts_between(130, 100), -30);
  EXPECT_EQ(counts_between(32760, -32766), 10);
  EXPECT_EQ(counts_between(-32766, 32760), -10);
}

TEST(Create2Protocol, TableOfFaults) {
  EXPECT_TRUE(faults_of(some()).empty());
  struct Case {
    void (*change)(Create2Sensors&);
    const char* fault;
  };
  for (const Case& c : {Case{[](Create2Sensors& s) { s.bump_left = true; }, "bumper"},
                        Case{[](Create2Sensors& s) { s.bump_right = true; }, "bumper"},
                        Case{[](Create2Sensors& s) { s.cliff = true; }, "cliff"},
                        Case{[](Create2Sensors& s) { s.drop_left = true; }, "wheel hangs"},
                        Case{[](Create2Sensors& s) { s.overcurrent_right = true; }, "current"},
                        Case{[](Create2Sensors& s) { s.charging_state = 5; }, "charged"},
                        Case{[](Create2Sensors& s) { s.charger = true; }, "charger"},
                        Case{[](Create2Sensors& s) { s.charge = 259; }, "below 10 %"},
                        Case{[](Create2Sensors& s) { s.mode = 1; }, "safe mode"}}) {
    Create2Sensors sensors = some();
    c.change(sensors);
    // As it comes over the line.
    Create2Stream stream;
    const auto read = stream.add(test::create2_packet(sensors));
    ASSERT_EQ(read.size(), 1u);
    const std::vector<std::string> faults = faults_of(read[0]);
    ASSERT_EQ(faults.size(), 1u) << c.fault;
    EXPECT_NE(faults[0].find(c.fault), std::string::npos) << faults[0];
  }
}

}  // namespace
}  // namespace prospect::create2_protocol_test
