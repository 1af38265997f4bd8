// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/master_uri.h"

#include <gtest/gtest.h>

#include "adapters/formats/files/input_error.h"

namespace prospect::master_uri_test {
namespace {

TEST(MasterUri, IsHostAndPort) {
  GazeboAddress address;
  address.timeout = 7.0;
  for (const char* uri : {"http://robot.local:11346", "http://robot.local:11346/"}) {
    const GazeboAddress read = with_master_uri(address, uri);
    EXPECT_EQ(read.host, "robot.local");
    EXPECT_EQ(read.port, 11346);
    EXPECT_EQ(read.timeout, 7.0);
  }
}

TEST(MasterUri, WhatIsNoneIsRefused) {
  for (const char* uri :
       {"", "127.0.0.1:11345", "https://127.0.0.1:11345", "http://", "http://:11345",
        "http://127.0.0.1", "http://127.0.0.1:", "http://127.0.0.1:one", "http://127.0.0.1:0",
        "http://127.0.0.1:65536", "http://127.0.0.1:11345x"}) {
    EXPECT_THROW(with_master_uri({}, uri), InputError) << uri;
  }
}

}  // namespace
}  // namespace prospect::master_uri_test
