// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/report.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "engine/support/named.h"
#include "tests/adapters/synthetic_run.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::report_test {
namespace {

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

nlohmann::json data(const std::string& html) {
  const std::string open = "<script type=\"application/json\" id=\"run\">";
  const std::size_t begin = html.find(open) + open.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

/// Reads what the page reads, written independently of it.
class Reader {
 public:
  explicit Reader(const std::string& base64) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : base64) {
      if (c == '=') break;
      bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
      held += 6;
      if (held >= 8) {
        held -= 8;
        bytes_.push_back(static_cast<std::uint8_t>(bits >> held));
      }
    }
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint8_t byte = bytes_.at(at_++);
      value |= static_cast<std::uint64_t>(byte & 127) << shift;
      if (byte < 128) return value;
    }
  }
  float number() {
    std::uint32_t bits = 0;
    for (int i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(bytes_.at(at_++)) << 8 * i;
    return std::bit_cast<float>(bits);
  }
  std::int64_t signed_varint() {
    const std::uint64_t value = varint();
    return value % 2 == 0 ? static_cast<std::int64_t>(value / 2)
                          : -static_cast<std::int64_t>(value / 2) - 1;
  }
  std::uint8_t byte() { return bytes_.at(at_++); }
  bool done() const { return at_ == bytes_.size(); }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

TEST(Report, NeedsNothingBesideIt) {
  const std::string html = render_report(synthetic_run(10));
  EXPECT_EQ(count(html, "default-src 'none'"), 1);
  for (const char* loading :
       {"<link", "<img", "<iframe", " src=", "@import", "url(", "fetch(", "XMLHttpRequest(\"",
        "sourceMappingURL", "{{title", "{{run", "{{lib", "{{style", "{{script"}) {
    EXPECT_EQ(html.find(loading), std::string::npos) << loading;
  }
  EXPECT_EQ(count(html, "dygraphs/blob/v"), 1) << "the library's licence stays with it";
}

TEST(Report, FrontiersStandInTheirOrderWithTheirReason) {
  const RunRecord run = synthetic_run(60);
  const nlohmann::json standings = data(render_report(run)).at("standings");
  Reader steps(standings.at("steps")), values(standings.at("values"));
  int asked = 0;
  for (const StepRecord& step : run.steps) {
    ASSERT_EQ(steps.varint(), step.standings.size()) << step.step;
    asked += step.standings.empty() ? 0 : 1;
    for (const FrontierRecord& f : step.standings) {
      EXPECT_EQ(standings.at("whys").at(steps.varint()), name(f.why));
      for (const double value : {f.place.x(), f.place.y(), f.area, f.unknown, f.time}) {
        EXPECT_EQ(values.number(), static_cast<float>(value));
      }
    }
  }
  EXPECT_EQ(asked, 8);
  EXPECT_TRUE(steps.done() && values.done());
}

TEST(Report, AMissionOfSixHundredStepsIsSmall) {
  NOT_UNDER_SANITIZERS("costs, sizes and times are those of the release build");
  const RunRecord run = synthetic_run(600);
  const std::string html = render_report(run);
  EXPECT_LT(html.size(), 2600000U) << "6 MB for 1400 steps";
  EXPECT_EQ(html, render_report(run));
}

TEST(Report, TextCannotBreakOutOfItsPlace) {
  RunRecord run = synthetic_run(3);
  const std::string hostile =
      "</script><script>alert(1)</script><!-- <script> {{script}} & \" \xff \xe2\x80\xa8";
  run.summary.world = hostile;
  run.configuration = hostile;
  run.steps[1].certificate = hostile;
  run.steps[1].explanation.terms[0].name = hostile;
  run.steps[1].why = hostile;
  run.steps[1].candidates[0].verdict = {Verdict::Kind::kRefused, hostile};
  const std::string html = render_report(run);
  EXPECT_EQ(count(html, "</script"), 3);
  EXPECT_EQ(count(html, "alert(1)"), 8) << "title, heading and six strings of the data";
  EXPECT_EQ(count(html, "<script>alert"), 0);
  EXPECT_EQ(count(html, "<title>&lt;/script&gt;&lt;script&gt;alert(1)"), 1);
  const std::string kept =
      "</script><script>alert(1)</script><!-- <script> {{script}} & \" \xEF\xBF\xBD \xe2\x80\xa8";
  const nlohmann::json json = data(html);
  EXPECT_EQ(json["summary"]["world"], kept);
  EXPECT_EQ(json["configuration"], kept);
}

TEST(Report, NumbersThatAreNoneAreMarkedAsSuch) {
  RunRecord run = synthetic_run(4);
  run.summary.time_to_99_s = std::nan("");
  run.summary.drift_percent = HUGE_VAL;
  run.steps[2].coverage = std::nan("");
  run.steps[2].estimated_pose.position.x() = HUGE_VAL;
  run.steps[2].frontier_cells.emplace_back(NAN, 1.0F);
  run.steps[2].frontier_cells.emplace_back(1e30F, 1.0F);
  run.steps[2].landmarks.push_back({NAN, 0.0F, 0.5F});
  run.steps[2].landmarks.push_back({1.0F, 0.0F, NAN});
  const nlohmann::json json = data(render_report(run));
  EXPECT_TRUE(json["summary"]["time_to_99_s"].is_null());
  EXPECT_TRUE(json["summary"]["drift_percent"].is_null());
  Reader coverage(json["columns"]["coverage"]);
  EXPECT_EQ(coverage.number(), static_cast<float>(run.steps[0].coverage));
  coverage.number();
  EXPECT_TRUE(std::isnan(coverage.number()));
  EXPECT_LT(json["extent"]["width"], 300);
}

TEST(Report, OfAMissionWithoutSteps) {
  const std::string html = render_report(RunRecord{});
  const nlohmann::json json = data(html);
  EXPECT_EQ(json["steps"], 0);
  EXPECT_EQ(json["extent"]["width"], 0);
}

TEST(Report, HoldsTheRun) {
  RunRecord run = synthetic_run(90);
  for (StepRecord& s : run.steps) {  // negative cells too
    for (auto& [cell, state] : s.map_changes) cell.i -= 100, cell.j -= 50;
    for (Eigen::Vector2f& p : s.frontier_cells) p -= Eigen::Vector2f(10.0F, 5.0F);
  }
  run.steps[40].map_changes.emplace_back(Cell{-90, -30}, CellState::kFree);
  run.steps[40].map_changes.emplace_back(Cell{-90, -30}, CellState::kOccupied);
  run.steps[50].map_changes.emplace_back(Cell{-90, -30}, CellState::kUnknown);
  for (StepRecord& s : run.steps) s.weights = {{"cost_to_go", 1.5, 0.25 * s.step}};
  ASSERT_GT(run.steps[60].active_frontiers, 0);
  run.steps[60].frontier_cells.clear();  // not kept: the page shows those of the step before
  const nlohmann::json json = data(render_report(run));
  const int width = json["extent"]["width"], i0 = json["extent"]["i0"], j0 = json["extent"]["j0"];

  Reader map(json["map"]), frontiers(json["frontiers"]), landmarks(json["landmarks"]["steps"]),
      counts(json["horizon"]["counts"]), poses(json["horizon"]["poses"]);
  std::vector<std::pair<float, float>> positions;
  for (Reader reader(json["landmarks"]["positions"]); !reader.done();) {
    const float x = reader.number();
    positions.emplace_back(x, reader.number());
  }
  using Known = std::map<std::pair<int, int>, int>;
  Known expected, shown;
  std::set<std::uint64_t> frontier, cells;
  for (const StepRecord& s : run.steps) {
    for (const auto& [cell, state] : s.map_changes) {
      expected[{cell.i, cell.j}] = static_cast<int>(state);
    }
    std::uint64_t at = 0;
    for (std::uint64_t runs = map.varint(); runs > 0; --runs) {
      at += map.varint();
      const std::uint64_t code = map.varint();
      for (std::uint64_t end = at + code / 4; at < end; ++at) {
        shown[{i0 + static_cast<int>(at) % width, j0 + static_cast<int>(at) / width}] =
            static_cast<int>(code % 4);
      }
    }
    ASSERT_EQ(shown, expected) << "after step " << s.step;

    at = 0;
    for (std::uint64_t toggles = frontiers.varint(); toggles > 0; --toggles) {
      at += frontiers.varint();
      if (frontier.erase(at) == 0) frontier.insert(at);
    }
    if (s.step != 60) cells.clear();
    for (const Eigen::Vector2f& p : s.frontier_cells) {
      const int i = static_cast<int>(std::lround(p.x() / 0.1F - 0.5F));
      const int j = static_cast<int>(std::lround(p.y() / 0.1F - 0.5F));
      cells.insert(static_cast<std::uint64_t>((j - j0) * width + i - i0));
    }
    ASSERT_EQ(frontier, cells) << "at step " << s.step;

    const std::uint64_t n = landmarks.varint();
    ASSERT_EQ(n, s.landmarks.size());
    std::vector<bool> found(s.landmarks.size());
    std::uint64_t index = 0;
    for (std::uint64_t i = 0; i < n; ++i) {
      index += landmarks.varint();
      const auto [x, y] = positions.at(index);
      const double visibility = static_cast<double>(landmarks.varint()) / 127.0;
      bool matched = false;
      for (std::size_t l = 0; l < s.landmarks.size() && !matched; ++l) {
        const LandmarkView& v = s.landmarks[l];
        matched = !found[l] && std::abs(v.x - x) < 0.0051F && std::abs(v.y - y) < 0.0051F &&
                  std::abs(v.visibility - visibility) < 0.5 / 127.0 + 1e-6;
        if (matched) found[l] = true;
      }
      EXPECT_TRUE(matched) << "landmark " << i << " of step " << s.step;
    }

    ASSERT_EQ(counts.varint(), s.horizon.size());
    for (const Pose& p : s.horizon) {
      EXPECT_EQ(poses.number(), static_cast<float>(p.position.x()));
      EXPECT_EQ(poses.number(), static_cast<float>(p.position.y()));
      EXPECT_EQ(poses.number(), static_cast<float>(p.yaw));
    }
  }
  EXPECT_TRUE(map.done() && frontiers.done() && landmarks.done() && counts.done() && poses.done());

  // Cost terms weighted, the constraint left out.
  ASSERT_EQ(json["terms"].size(), 6U);
  EXPECT_EQ(json["terms"][3]["name"], "cost_to_go");
  Reader cost_to_go(json["terms"][3]["weighted"]), tracked(json["columns"]["tracked_features"]);
  Reader kind(json["words"]["plan_kind"]["steps"]);
  Reader asked(json["terms"][3]["weight_asked"]), weights(json["terms"][3]["weight"]);
  for (const StepRecord& s : run.steps) {
    EXPECT_EQ(asked.number(), static_cast<float>(1.5));
    EXPECT_EQ(weights.number(), static_cast<float>(0.25 * s.step));
    EXPECT_EQ(cost_to_go.number(), static_cast<float>(s.explanation.terms[3].weighted));
    EXPECT_EQ(tracked.number(), static_cast<float>(s.tracked_features));
    EXPECT_EQ(json["words"]["plan_kind"]["words"][kind.varint()], name_of(s.plan_kind));
  }
}

TEST(Report, HoldsWhatTheRobotDidAndWhy) {
  RunRecord run = synthetic_run(120);
  run.steps[50].target.reset();
  run.steps[60].candidates[1].path[3].x() = NAN;  // what follows is not drawn
  run.steps[60].candidates[2].explanation.terms.erase(
      run.steps[60].candidates[2].explanation.terms.begin() + 1);
  run.steps[61].candidates.clear();
  const nlohmann::json json = data(render_report(run));

  const auto& c = json["candidates"];
  ASSERT_EQ(c["terms"].size(), 6U) << "costs only";
  Reader steps(c["steps"]), values(c["values"]), path_left(json["columns"]["way_left"]),
      scored(json["columns"]["seeds_scored"]);
  std::map<std::string, Reader> words;
  for (const char* name : {"mode", "cause", "caution", "target_change", "why"}) {
    words.emplace(name, Reader(json["words"][name]["steps"]));
  }
  for (const StepRecord& s : run.steps) {
    const std::map<std::string, std::string> said = {{"mode", name_of(s.mode)},
                                                     {"cause", name_of(s.cause)},
                                                     {"caution", name_of(s.safety_level)},
                                                     {"target_change", name_of(s.target_change)},
                                                     {"why", s.why}};
    for (auto& [name, reader] : words) {
      EXPECT_EQ(json["words"][name]["words"][reader.varint()], said.at(name));
    }
    const float way = path_left.number();
    if (s.target) {
      EXPECT_EQ(way, static_cast<float>(s.target->path_left));
    } else {
      EXPECT_TRUE(std::isnan(way));
    }
    EXPECT_EQ(scored.number(), static_cast<float>(s.seeds_scored));
    ASSERT_EQ(steps.varint(), s.candidates.size());
    for (const CandidateRecord& candidate : s.candidates) {
      EXPECT_EQ(c["names"][steps.varint()], candidate.name);
      EXPECT_EQ(c["verdicts"][steps.varint()], to_string(candidate.verdict));
      EXPECT_EQ(steps.varint(), candidate.polished ? 1U : 0U);
      const bool cut = s.step == 60 && &candidate == &s.candidates[1];
      ASSERT_EQ(steps.varint(), cut ? 3U : candidate.path.size());
      std::int64_t x = 0, y = 0;
      for (std::size_t i = 0; i < (cut ? 3U : candidate.path.size()); ++i) {
        x += steps.signed_varint();
        y += steps.signed_varint();
        EXPECT_NEAR(0.01 * static_cast<double>(x), candidate.path[i].x(), 0.0051);
        EXPECT_NEAR(0.01 * static_cast<double>(y), candidate.path[i].y(), 0.0051);
      }
      EXPECT_EQ(values.number(), static_cast<float>(candidate.explanation.cost));
      for (const auto& name : c["terms"]) {
        const float value = values.number();
        float expected = NAN;
        for (const TermValue& t : candidate.explanation.terms) {
          if (t.name == name) expected = static_cast<float>(t.weighted);
        }
        EXPECT_TRUE(value == expected || (std::isnan(value) && std::isnan(expected))) << name;
      }
    }
  }
  EXPECT_TRUE(steps.done() && values.done() && path_left.done());

  // Every mode that there is has its colour.
  for (const auto& mode : json["words"]["mode"]["words"]) {
    EXPECT_TRUE(json["palette"]["modes"].contains(mode.get<std::string>())) << mode;
  }
  // The cost-to-go, at the steps that have one (its pixels: field_picture_test.cc).
  ASSERT_EQ(json["cost_to_go"].size(), 12U);
  const auto& field = json["cost_to_go"][3];
  EXPECT_EQ(field["step"], 30);
  EXPECT_EQ(field["width"], 240);
  EXPECT_EQ(field["size"], 0.1);
  Reader png(field["png"]);
  for (const int magic : {0x89, 0x50, 0x4E, 0x47}) EXPECT_EQ(png.byte(), magic);
}

TEST(Report, HoldsWhatTheRobotWasTold) {
  RunRecord run = synthetic_run(6);
  run.zones.bound = Polygon{{0, 0}, {24, 0}, {24, 16}, {0, 16}};
  run.zones.keep_out = {{{1.111, 2}, {3, 2}, {3, 4}}};
  run.zones.slow = {{{{5, 5}, {6, 5}, {6, 6}}, 0.25}};
  for (StepRecord& s : run.steps) s.task = TaskKind::kExplore;
  run.steps[4].task = TaskKind::kGoTo;
  run.steps[4].goal = Eigen::Vector2d(7.5, 8.0);
  const nlohmann::json json = data(render_report(run));
  EXPECT_EQ(json["zones"]["bound"].size(), 4u);
  EXPECT_TRUE(json["zones"]["area"].is_null());
  EXPECT_EQ(json["zones"]["keep_out"][0][0][0], 1.11);
  EXPECT_EQ(json["zones"]["slow"][0]["max_speed"], 0.25);
  Reader x(json["columns"]["goal_x"]), yaw(json["columns"]["goal_yaw"]);
  for (int k = 0; k < 6; ++k) {
    const float goal = x.number();
    EXPECT_EQ(std::isnan(goal), k != 4);
    if (k == 4) {
      EXPECT_EQ(goal, 7.5F);
    }
    EXPECT_TRUE(std::isnan(yaw.number()));
  }
  EXPECT_EQ(json["words"]["task"]["words"], nlohmann::json({"explore", "go to"}));
}

}  // namespace
}  // namespace prospect::report_test
