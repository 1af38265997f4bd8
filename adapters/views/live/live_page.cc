// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/live_page.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "adapters/missions/run/summary.h"
#include "adapters/views/live/live_assets.h"
#include "adapters/views/page/html_page.h"
#include "adapters/views/page/landmark_picture.h"
#include "adapters/views/report/report.h"
#include "runtime/latency_histogram.h"

namespace prospect {
namespace {

using Json = nlohmann::ordered_json;

Json time_json(double seconds) { return std::isfinite(seconds) ? Json(seconds) : Json(); }

Json event_json(const Event& event) {
  return {
      {"number", event.number}, {"time", event.last_stamp}, {"severity", to_string(event.severity)},
      {"source", event.source}, {"cause", event.cause},     {"text", event.text},
      {"count", event.count}};
}

Json drive_json(const LiveDriver& driver) {
  const DriverStatus& s = driver.status;
  const HealthReport& h = driver.health;
  Json sources = Json::array(), threads = Json::array(), latencies = Json::array(),
       checks = Json::array();
  for (const SourceHealth& source : h.sources) {
    sources.push_back({{"name", source.name},
                       {"age", time_json(source.age)},
                       {"limit", source.limit},
                       {"received", source.received},
                       {"dropped", source.dropped}});
  }
  for (const ThreadReport& thread : h.threads) {
    threads.push_back({{"name", thread.name}, {"state", to_string(thread.state)}});
  }
  for (const NamedLatency& latency : h.latencies) {
    latencies.push_back({{"name", latency.name},
                         {"p50", latency.histogram.quantile(0.5)},
                         {"p99", latency.histogram.quantile(0.99)},
                         {"max", latency.histogram.maximum()}});
  }
  for (const CheckResult& check : h.preflight) {
    checks.push_back(
        {{"check", check.check}, {"verdict", to_string(check.verdict)}, {"why", check.why}});
  }
  return {{"now", h.stamp},
          {"mode", to_string(s.mode.mode)},
          {"cause", to_string(s.mode.cause)},
          {"why", s.why},
          {"response", to_string(h.speed.response)},
          {"share", h.speed.share},
          {"reason", to_string(s.reason)},
          {"detail", s.detail},
          {"late_plans", s.late_plans},
          {"guard_stops", s.guard_stops},
          {"level", to_string(level(h))},
          {"sources", std::move(sources)},
          {"threads", std::move(threads)},
          {"latencies", std::move(latencies)},
          {"checks", std::move(checks)}};
}

}  // namespace

std::string live_page(const RunRecord& start) {
  ReportPage page;
  page.title = start.summary.world;
  page.kicker = "Live";
  page.connect = "'self' ws: wss:";
  page.style = live_assets::style();
  page.controls = live_assets::controls();
  page.run = report_start(start);
  page.script = live_assets::script();
  return render_page(page);
}

std::string welcome_message(const Welcome& welcome) {
  return json_text(
      {{"op", "welcome"}, {"may_command", welcome.may_command}, {"real_time", welcome.real_time}});
}

std::string steps_message(const std::vector<std::shared_ptr<const StepRecord>>& steps,
                          double resolution) {
  return R"({"op":"steps","part":)" + report_steps(steps, resolution) + '}';
}

std::string pose_message(const LivePose& pose) {
  return json_text({{"op", "pose"},
                    {"stamp", time_json(pose.stamp)},
                    {"x", time_json(pose.pose.position.x())},
                    {"y", time_json(pose.pose.position.y())},
                    {"yaw", time_json(pose.pose.yaw)},
                    {"speed", time_json(pose.twist.linear.head<2>().norm())},
                    {"localization", to_string(pose.localization)}});
}

std::string picture_message(const CameraPicture& picture) {
  Json json =
      pictures_json({landmark_picture(0, *picture.image, picture.sightings, kLivePictureWidth)});
  return json_text({{"op", "picture"}, {"picture", std::move(json[0])}});
}

std::string end_message(const Summary& summary) {
  return json_text({{"op", "end"},
                    {"reason", to_string(summary.end)},
                    {"outcome", to_string(outcome(summary))},
                    {"detail", summary.detail}});
}

std::string status_message(const LiveStatus& status) {
  Json json = {{"op", "status"},
               {"drive", status.driver ? drive_json(*status.driver) : Json()},
               {"told_to_drive", status.told_to_drive},
               {"stopped", status.stopped},
               {"told", status.told},
               {"began", status.began ? time_json(*status.began) : Json()},
               {"viewers", status.counts.viewers},
               {"dropped", status.counts.dropped},
               {"missed", status.missed},
               {"events", Json::array()}};
  for (const Event& event : status.events) json["events"].push_back(event_json(event));
  return json_text(json);
}

}  // namespace prospect
