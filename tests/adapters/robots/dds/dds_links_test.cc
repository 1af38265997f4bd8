// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace prospect::dds_links_test {
namespace {

using ::testing::HasSubstr;

const Link* of_topic(const std::vector<Link>& links, const std::string& topic) {
  const auto found = std::find_if(links.begin(), links.end(),
                                  [&](const Link& link) { return link.topic == topic; });
  return found == links.end() ? nullptr : &*found;
}

TEST(DdsLinks, EachTopicThatIsReadOrCommandedHasAContract) {
  DdsOptions o;
  o.emergency_stop = "/stop";
  o.acknowledge = "/acknowledge";
  o.scan = "/scan";
  o.pose.topic = "/pose";
  o.imu = "/imu/data";
  o.command.plain = "/cmd_vel_plain";
  o.command.relay = "/to_relay";
  o.emergency_stop_contract = {.publishers = 2, .max_age = 0.7};
  const std::vector<Link> links = dds_links(o);
  for (const std::string& topic :
       {o.stereo.left, o.stereo.right, o.stereo.left_info, o.stereo.right_info, o.depth.image,
        o.depth.info, o.scan, o.odometry, o.emergency_stop, o.acknowledge, o.tf, o.tf_static,
        o.command.stamped, o.command.plain, o.command.relay, o.pose.topic, o.imu}) {
    EXPECT_TRUE(of_topic(links, topic)) << topic;
  }
  EXPECT_FALSE(of_topic(links, o.output.map));
  EXPECT_EQ(of_topic(links, "/stop")->least, 2);
  EXPECT_EQ(of_topic(links, "/stop")->heartbeat, 0.7);
  for (const Link& link : links) {
    if (link.most != 1) continue;
    EXPECT_TRUE(link.doubled && latches(*link.doubled)) << link.signal;
  }
  o.emergency_stop_contract.latched = true;
  EXPECT_FALSE(of_topic(dds_links(o), "/stop")->heartbeat);
}

TEST(DdsLinks, AnEmergencyStopThatIsNotSetUpIsSaid) {
  EXPECT_THAT(link_table(dds_links({})), HasSubstr("| emergency stop | none | 1 or more |"));
}

TEST(DdsLinks, TheReferencePageHoldsTheTable) {
  std::ifstream file(PROSPECT_SOURCE_DIR "/docs/reference/dds.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_THAT(page.str(), HasSubstr("<!-- prospect list links -->\n" + link_table(dds_links({})) +
                                    "<!-- end -->"))
      << "docs/reference/dds.md: put the output of `prospect list links` between the marks";
}

}  // namespace
}  // namespace prospect::dds_links_test
