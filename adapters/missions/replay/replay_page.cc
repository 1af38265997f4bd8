// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/replay/replay_page.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "adapters/missions/replay/replay_assets.h"
#include "adapters/views/page/html_page.h"
#include "adapters/views/page/page_assets.h"
#include "engine/support/named.h"

namespace prospect {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value, double to) { return std::round(value / to) * to; }

Json plan_json(const StepRecord& s) {
  Json path = Json::array();
  for (const Pose& pose : s.horizon) {
    path.push_back(rounded(pose.position.x(), 1e-3));
    path.push_back(rounded(pose.position.y(), 1e-3));
  }
  Json terms = Json::object();
  for (const TermValue& term : s.explanation.terms) terms[term.name] = term.weighted;
  Json json = {{"path", path},
               {"terms", terms},
               {"ms", rounded(s.wall.plan, 1e-2)},
               {"features", s.predicted_features},
               {"kind", name_of(s.plan_kind)},
               {"mode", name_of(s.mode)},
               {"seed", s.seed},
               {"evaluations", s.cost_evaluations + s.gradient_evaluations}};
  if (!s.explanation.terms.empty()) json["cost"] = s.explanation.cost;
  return json;
}

}  // namespace

std::string replay_page(const Replay& replay, const std::string& title, const std::string& recorded,
                        const std::string& other, const std::string& changed) {
  Json steps = Json::array();
  // The map of steps that are not reported counts for the first one that is.
  std::size_t next = 0;
  Json map = Json::array();
  const auto add_map = [&](const StepRecord& step) {
    for (const auto& [cell, state] : step.map_changes) {
      map.push_back(cell.i);
      map.push_back(cell.j);
      map.push_back(static_cast<int>(state));
    }
  };
  for (const StepRecord& step : replay.record.steps) {
    add_map(step);
    if (next >= replay.steps.size() || replay.steps[next].recorded.step != step.step) continue;
    const ReplayedStep& both = replay.steps[next++];
    const Pose& at = both.recorded.estimated_pose;
    Json frontiers = Json::array();
    for (const Eigen::Vector2f& cell : both.recorded.frontier_cells) {
      frontiers.push_back(rounded(cell.x(), 1e-2));
      frontiers.push_back(rounded(cell.y(), 1e-2));
    }
    steps.push_back(
        {{"step", step.step},
         {"t", step.time},
         {"pose", {rounded(at.position.x(), 1e-3), rounded(at.position.y(), 1e-3), at.yaw}},
         {"tracked", both.recorded.tracked_features},
         {"map", map},
         {"frontiers", frontiers},
         {"a", plan_json(both.recorded)},
         {"b", plan_json(both.other)}});
    map = Json::array();
  }
  const Json data = {{"resolution", replay.record.resolution},
                     {"radius", replay.record.robot_radius},
                     {"recorded", recorded},
                     {"other", other},
                     {"steps", steps}};
  const std::string parted = replay.difference.step < 0
                                 ? ""
                                 : "<p class=\"facts\"><span class=\"end bad\">The mission could "
                                   "not be driven again beyond "
                                   "step " +
                                       std::to_string(replay.difference.step) + ": " +
                                       escape_html(replay.difference.what) + "</span></p>";
  return fill_page(
      replay_assets::replay_html(),
      {{"{{title}}", escape_html(title)},
       {"{{recorded}}", escape_html(recorded)},
       {"{{other}}", escape_html(other)},
       {"{{changed}}", escape_html(changed)},
       {"{{parted}}", parted},
       {"{{library style}}", library_text(page_assets::dygraph_style())},
       {"{{style}}", std::string(page_assets::style()) + std::string(replay_assets::replay_css())},
       {"{{replay}}", json_text(data)},
       {"{{library}}", script_text(page_assets::dygraph_script())},
       {"{{script}}", page_script(replay_assets::replay_js())}});
}

}  // namespace prospect
