// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/access.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace prospect::access_test {
namespace {

TEST(Access, TokensAreLongAndDiffer) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) {
    const std::string token = make_token();
    EXPECT_EQ(token.size(), 32U);
    EXPECT_EQ(token_fault(token), "");
    tokens.insert(token);
  }
  EXPECT_EQ(tokens.size(), 100U);
}

TEST(Access, AChosenTokenIsLongAndNeedsNoEscapes) {
  EXPECT_EQ(token_fault("0123456789abcdef"), "");
  EXPECT_EQ(token_fault("A-token_of-16-or-more"), "");
  for (const std::string& bad :
       {std::string(), std::string("short"), std::string(129, 'a'),
        std::string("0123456789abcdef&"), std::string("0123456789 abcdef")}) {
    EXPECT_NE(token_fault(bad), "") << bad;
  }
}

TEST(Access, OnlyTheWholeTokenIsTheToken) {
  EXPECT_TRUE(same_token("abcdef", "abcdef"));
  for (const char* wrong : {"", "abcde", "abcdefg", "abcdeF", "bbcdef", "abcdefabcdef"}) {
    EXPECT_FALSE(same_token(wrong, "abcdef")) << wrong;
  }
}

TEST(Access, TheTokenStandsInTheQuery) {
  EXPECT_EQ(query_value("/?token=abc", "token"), "abc");
  EXPECT_EQ(query_value("/live?a=1&token=abc&b=2", "token"), "abc");
  EXPECT_EQ(query_value("/?mytoken=abc", "token"), "");
  EXPECT_EQ(query_value("/?token=", "token"), "");
  EXPECT_EQ(query_value("/token=abc", "token"), "");
  EXPECT_EQ(query_value("", "token"), "");
}

TEST(Access, ANameThatAStrangerCanPointHereIsRefused) {
  for (const char* own :
       {"127.0.0.1", "127.0.0.1:8080", "[::1]:8080", "192.168.1.7:80", "localhost",
        "LOCALHOST:8080", "rover", "Rover:8080", "rover.local:8080"}) {
    EXPECT_TRUE(is_own_host(own, "rover")) << own;
  }
  for (const char* foreign :
       {"", "evil.example", "evil.example:8080", "127.0.0.1.evil.example", "localhost.evil.example",
        "rover.evil.example", "[::1", "1.2.3", ":8080"}) {
    EXPECT_FALSE(is_own_host(foreign, "rover")) << foreign;
  }
  EXPECT_FALSE(is_own_host("", ""));
}

TEST(Access, AnOriginIsThePageOfThisServerOrAStrangers) {
  EXPECT_TRUE(is_same_origin("http://127.0.0.1:8080", "127.0.0.1:8080"));
  EXPECT_FALSE(is_same_origin("http://127.0.0.1:8081", "127.0.0.1:8080"));
  EXPECT_FALSE(is_same_origin("https://127.0.0.1:8080", "127.0.0.1:8080"));
  EXPECT_FALSE(is_same_origin("null", "127.0.0.1:8080"));
}

}  // namespace
}  // namespace prospect::access_test
