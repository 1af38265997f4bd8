// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/live_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/views/live/live_page.h"
#include "tests/adapters/synthetic_run.h"
#include "tests/adapters/web_client.h"

namespace prospect::live_server_test {
namespace {

using nlohmann::json;
using test::WebClient;
using testing::HasSubstr;
using testing::StartsWith;

constexpr char kToken[] = "0123456789abcdef";
const std::string kPage(kPageProtocol);

class LiveServerTest : public ::testing::Test {
 protected:
  LiveServer& serve(LiveOptions options = {}) {
    if (options.token.empty()) options.token = kToken;
    LiveMission mission;
    mission.start.summary.world = "a <world>";
    server_ = std::make_unique<LiveServer>(options, mission, feed_, requests_);
    return *server_;
  }
  int port() const { return server_->port(); }
  WebClient viewer(const std::string& target = "/live") {
    WebClient client(port());
    EXPECT_THAT(client.upgrade(target, kPage), StartsWith("HTTP/1.1 101 "));
    return client;
  }
  /// The next message with that "op"; null if none comes.
  static json next(WebClient& client, const std::string& op) {
    while (const auto frame = client.frame()) {
      if (frame->opcode != 1) continue;
      json message = json::parse(frame->bytes);
      if (message["op"] == op) return message;
    }
    return nullptr;
  }
  static bool within_a_second(const std::function<bool()>& so) {
    for (int i = 0; i < 200 && !so(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return so();
  }

  LiveFeed feed_;
  DriveRequests requests_;
  std::unique_ptr<LiveServer> server_;
};

TEST_F(LiveServerTest, ServesThePageAndNothingElse) {
  serve();
  const std::string page = WebClient(port()).get("/?token=abc");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(page, HasSubstr("a &lt;world&gt;"));
  EXPECT_THAT(page, HasSubstr("X-Frame-Options: DENY"));
  EXPECT_THAT(page, HasSubstr("Cache-Control: no-store"));
  EXPECT_THAT(page, testing::Not(HasSubstr(kToken)));
  EXPECT_THAT(WebClient(port()).get("/etc/passwd"), StartsWith("HTTP/1.1 404 "));
  EXPECT_THAT(WebClient(port()).get("/../x"), StartsWith("HTTP/1.1 404 "));
  WebClient post(port());
  post.send("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
  EXPECT_THAT(post.all(), StartsWith("HTTP/1.1 405 "));
}

TEST_F(LiveServerTest, AForeignHostIsRefused) {
  serve();
  EXPECT_THAT(WebClient(port()).get("/", "evil.example"), StartsWith("HTTP/1.1 403 "));
  WebClient client(port());
  EXPECT_THAT(client.upgrade("/live?token=" + std::string(kToken), kPage, "evil.example"),
              StartsWith("HTTP/1.1 403 "));
}

TEST_F(LiveServerTest, AForeignOriginNeedsTheToken) {
  serve();
  const std::string origin = "Origin: https://elsewhere.example\r\n";
  const std::string token = "/live?token=" + std::string(kToken);
  EXPECT_THAT(WebClient(port()).upgrade("/live", kPage, "127.0.0.1", origin),
              StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(WebClient(port()).upgrade(token, kPage, "127.0.0.1", origin),
              StartsWith("HTTP/1.1 101 "));
  EXPECT_THAT(
      WebClient(port()).upgrade("/live", kPage, "127.0.0.1", "Origin: http://127.0.0.1\r\n"),
      StartsWith("HTTP/1.1 101 "));
}

TEST_F(LiveServerTest, TheTokenMakesTheDifferenceBetweenWatchingAndCommanding) {
  serve();
  EXPECT_THAT(WebClient(port()).upgrade("/live?token=0123456789abcdeF", kPage),
              StartsWith("HTTP/1.1 403 "));
  WebClient watcher = viewer();
  EXPECT_EQ(next(watcher, "welcome")["may_command"], false);
  watcher.say(R"({"op":"command","name":"hold"})");
  EXPECT_THAT(next(watcher, "answer")["refused"].get<std::string>(), HasSubstr("token"));
  EXPECT_TRUE(requests_.told_to_drive());
  WebClient commander = viewer("/live?token=" + std::string(kToken));
  EXPECT_EQ(next(commander, "welcome")["may_command"], true);
  commander.say(R"({"op":"command","name":"hold"})");
  EXPECT_EQ(next(commander, "answer")["refused"], "");
  EXPECT_FALSE(requests_.told_to_drive());
  json status = next(watcher, "status");  // the first may be of before
  while (!status.is_null() && status["told_to_drive"] == true) status = next(watcher, "status");
  EXPECT_FALSE(status.is_null());
}

TEST_F(LiveServerTest, WhatTheRobotTellsReachesItsViewers) {
  serve();
  WebClient client = viewer();
  EXPECT_FALSE(next(client, "welcome").is_null());
  const RunRecord run = synthetic_run(3);
  for (const StepRecord& step : run.steps) feed_.on_record(step, {});
  EXPECT_EQ(next(client, "steps")["part"]["steps"], 3);
  Belief belief;
  belief.pose.position.x() = 1.25;
  feed_.on_belief(belief);
  EXPECT_EQ(next(client, "pose")["x"], 1.25);
  // Pictures are wanted as soon as somebody watches.
  const CameraPicture shown{std::make_shared<const Image>(64, 48, 100), {}};
  EXPECT_TRUE(within_a_second([&] {
    feed_.on_picture(shown);
    return feed_.wants_pictures();
  }));
  EXPECT_FALSE(next(client, "picture")["picture"]["jpeg"].get<std::string>().empty());
  Summary summary;
  summary.end = MissionEnd::kExplored;
  feed_.end(summary);
  server_.reset();
  EXPECT_EQ(next(client, "end")["reason"], "explored") << "what is left goes out at the end";
}

TEST_F(LiveServerTest, AViewerThatReadsNothingCostsTheOthersNothingAndIsGivenUp) {
  LiveOptions options;
  options.idle_timeout = 1.0;
  serve(options);
  WebClient sleeper = viewer(), reader = viewer();
  const RunRecord run = synthetic_run(1);
  StepRecord big = run.steps[0];
  big.why.assign(500000, 'x');
  const auto begun = std::chrono::steady_clock::now();
  std::chrono::duration<double> longest{};
  for (int k = 0; k < 40; ++k) {
    big.step = k;
    const auto before = std::chrono::steady_clock::now();
    feed_.on_record(big, {});
    longest =
        std::max<std::chrono::duration<double>>(longest, std::chrono::steady_clock::now() - before);
    EXPECT_FALSE(next(reader, "steps").is_null()) << k;
  }
  // 20 MB for somebody who reads none of it.
  EXPECT_LT(longest.count(), 0.2) << "the robot's thread";
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count(), 60.0);
  bool alone = false;
  for (int k = 0; k < 100 && !alone; ++k) {
    requests_.tell(
        {1, DetourState::kOnTheWay, std::to_string(k)});  // so that there is a status to be told
    const json status = next(reader, "status");
    if (status.is_null()) break;
    alone = status["viewers"] == 1;
  }
  EXPECT_TRUE(alone) << "the sleeper is given up";
}

TEST_F(LiveServerTest, MalformedBytesEndTheirOwnConnectionAlone) {
  serve();
  WebClient good = viewer();
  const std::vector<std::string> frames = {
      std::string("\x81\x03"
                  "abc",
                  5),                                                       // not masked
      std::string("\xf1\x80\0\0\0\0", 6),                                   // reserved bits
      std::string("\x83\x80\0\0\0\0", 6),                                   // a reserved opcode
      std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14),  // 2^63 bytes
      std::string("\x09\x80\0\0\0\0", 6),          // a control frame in parts
      std::string("\x81\x82\0\0\0\0\xff\xfe", 8),  // no UTF-8
      std::string("\x80\x80\0\0\0\0", 6)};         // goes on with nothing
  for (const std::string& frame : frames) {
    WebClient bad = viewer();
    bad.send(frame);
    EXPECT_TRUE(bad.is_closed_within(3000)) << testing::PrintToString(frame);
  }
  WebClient wordy = viewer("/live?token=" + std::string(kToken));
  wordy.say(std::string(70000, ' '));
  EXPECT_TRUE(wordy.is_closed_within(3000)) << "a message that is too long";
  for (const std::string request :
       {"\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "\x16\x03\x01\x02\x01\x01\xfc\x03\x03",
        "GET / HTTP/1.1\r\nHost: a\r\nHost\r\n\r\n"}) {
    WebClient bad(port());
    bad.send(request);
    EXPECT_THAT(bad.all(), testing::Not(StartsWith("HTTP/1.1 200"))) << request;
  }
  WebClient endless(port());
  endless.send("GET / HTTP/1.1\r\nX: " + std::string(20000, 'x'));
  EXPECT_TRUE(endless.is_closed_within(3000)) << "a header that does not end";
  EXPECT_THAT(WebClient(port()).upgrade("/live", "chat"), StartsWith("HTTP/1.1 400 "));
  good.say(R"({"op":"command","name":"hold"})");
  EXPECT_FALSE(next(good, "answer").is_null());
}

TEST_F(LiveServerTest, HalfOpenConnectionsAreGivenUp) {
  LiveOptions options;
  options.request_timeout = 0.3;
  options.idle_timeout = 0.6;
  serve(options);
  WebClient silent(port()), half(port());
  half.send("GET / HTTP/1.1\r\nHost: loc");
  EXPECT_TRUE(silent.is_closed_within(3000));
  EXPECT_TRUE(half.is_closed_within(3000));
  // One that answers no ping.
  WebClient mute = viewer();
  EXPECT_TRUE(mute.is_closed_within(4000));
}

TEST_F(LiveServerTest, ManyViewersAreServedAndTooManyTurnedAway) {
  LiveOptions options;
  options.viewers = 8;
  serve(options);
  std::vector<WebClient> viewers;
  for (int k = 0; k < 8; ++k) viewers.push_back(viewer());
  EXPECT_THAT(WebClient(port()).upgrade("/live", kPage), StartsWith("HTTP/1.1 503 "));
  feed_.on_record(synthetic_run(1).steps[0], {});
  for (WebClient& client : viewers) EXPECT_FALSE(next(client, "steps").is_null());
  viewers.pop_back();
  EXPECT_TRUE(within_a_second([&] {
    return WebClient(port()).upgrade("/live", kPage).starts_with("HTTP/1.1 101 ");
  })) << "a place that is free again";
  // Connections that ask for nothing do not keep viewers out for good.
  std::vector<std::unique_ptr<WebClient>> idle;
  for (int k = 0; k < 60; ++k) idle.push_back(std::make_unique<WebClient>(port()));
  idle.clear();
  EXPECT_TRUE(
      within_a_second([&] { return WebClient(port()).get("/").starts_with("HTTP/1.1 200 "); }));
}

TEST_F(LiveServerTest, WatchersDoNotKeepOutWhoMayCommand) {
  LiveOptions options;
  options.viewers = 3;
  options.commanders = 2;
  serve(options);
  const std::string token = "/live?token=" + std::string(kToken);
  std::vector<WebClient> watchers;
  for (int k = 0; k < 3; ++k) watchers.push_back(viewer());
  EXPECT_THAT(WebClient(port()).upgrade("/live", kPage), StartsWith("HTTP/1.1 503 "));
  WebClient first = viewer(token), second = viewer(token), third = viewer(token);
  EXPECT_TRUE(first.is_closed_within(3000)) << "the oldest gives way";
  for (WebClient* client : {&second, &third}) {
    client->say(R"({"op":"command","name":"hold"})");
    EXPECT_EQ(next(*client, "answer")["refused"], "");
  }
  EXPECT_FALSE(next(watchers[0], "welcome").is_null()) << "who watches goes on watching";
}

TEST_F(LiveServerTest, HalfOpenConnectionsKeepNobodyOut) {
  serve();
  const std::string token = "/live?token=" + std::string(kToken);
  std::vector<WebClient> half;
  for (int k = 0; k < 150; ++k) {
    half.emplace_back(port());
    half.back().send("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX");
    if (k % 50 != 49) continue;
    EXPECT_THAT(WebClient(port()).get("/"), StartsWith("HTTP/1.1 200 ")) << k;
    WebClient commander(port());
    EXPECT_THAT(commander.upgrade(token, kPage), StartsWith("HTTP/1.1 101 ")) << k;
  }
  EXPECT_TRUE(half.front().is_closed_within(3000)) << "their number is bounded";
}

TEST_F(LiveServerTest, WhatCannotBeUsedIsRefusedInOneLine) {
  const auto said = [this](LiveOptions options) -> std::string {
    if (options.token.empty()) options.token = kToken;
    try {
      LiveServer(options, LiveMission{}, feed_, requests_);
    } catch (const InputError& error) {
      return error.lines().size() == 1 ? error.lines()[0] : "several lines";
    }
    return "";
  };
  serve();
  EXPECT_THAT(said({.port = port()}), testing::AllOf(StartsWith("--live "), HasSubstr("in use"),
                                                     HasSubstr("expected a free port")));
  EXPECT_THAT(said({.host = "nowhere"}),
              testing::AllOf(StartsWith("--live-host"), HasSubstr("expected")));
  EXPECT_THAT(said({.host = "192.0.2.1"}), StartsWith("--live-host"));
  EXPECT_THAT(said({.token = "short"}),
              testing::AllOf(StartsWith("--live-token"), HasSubstr("16")));
  EXPECT_EQ(said({.host = "localhost"}), "");
}

TEST_F(LiveServerTest, ItsAddressHoldsTheToken) {
  serve();
  EXPECT_EQ(server_->url(), "http://127.0.0.1:" + std::to_string(port()) + "/?token=" + kToken);
  server_.reset();
  serve({.host = "0.0.0.0"});
  EXPECT_THAT(server_->url(), StartsWith("http://127.0.0.1:"));
}

}  // namespace
}  // namespace prospect::live_server_test
