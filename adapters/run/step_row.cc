#include "adapters/run/step_row.h"

#include <algorithm>
#include <cstdio>

#include "adapters/files/csv.h"
#include "models/range_text.h"

namespace prospect {
namespace {

using csv::field;

/// The best candidates that were not executed: name, cost, and whether the certificate refused it.
std::string rejected(const StepRecord& s) {
  std::string list;
  for (const CandidateRecord& c : s.candidates) {
    if (c.verdict == "executed") continue;
    if (!list.empty()) list += "; ";
    char cost[32];
    std::snprintf(cost, sizeof cost, " %.4g", c.explanation.cost);
    list += c.name + cost + (c.verdict == "not tried" ? " not tried" : " refused");
  }
  return list;
}

/// The columns from `task` on.
std::string reasons(const StepRecord& s) {
  std::string row = ',' + field(s.task);
  row += s.goal ? ',' + exact_text(s.goal->x()) + ',' + exact_text(s.goal->y()) : ",,";
  row += ',' + (s.goal_yaw ? exact_text(*s.goal_yaw) : "");
  row += ',' + field(s.mode) + ',' + field(s.cause) + ',' + exact_text(s.mode_since) + ',' +
         field(s.caution) + ',' + field(s.target_change);
  if (s.target) {
    const TargetRecord& t = *s.target;
    for (const double value : {t.viewpoint.x(), t.viewpoint.y(), t.looks_at.x(), t.looks_at.y(),
                               t.length, t.area, t.way_left}) {
      row += ',' + exact_text(value);
    }
  } else {
    row += ",,,,,,,";
  }
  return row + ',' + std::to_string(s.seeds_scored) + ',' + exact_text(s.features_weight) + ',' +
         field(rejected(s));
}

/// They are last: they alone hold commas, so whoever splits a row at commas reads all columns
/// before.
std::string sentences(const StepRecord& s) {
  return ',' + field(s.certificate) + ',' + field(s.why);
}

/// What each cost was asked to weigh, and what it weighed.
std::string weights(const StepRecord& s, const std::vector<std::string>& names) {
  std::string row;
  for (const std::string& name : names) {
    const auto weight = std::find_if(s.weights.begin(), s.weights.end(),
                                     [&](const TermWeight& w) { return w.name == name; });
    row += weight == s.weights.end()
               ? ",,"
               : ',' + exact_text(weight->asked) + ',' + exact_text(weight->in_effect);
  }
  return row;
}

}  // namespace

StepColumns step_columns(const std::vector<StepRecord>& steps) {
  StepColumns columns;
  for (const StepRecord& step : steps) {
    for (const TermValue& term : step.explanation.terms) columns.terms.push_back(term.name);
    for (const TermWeight& weight : step.weights) columns.weights.push_back(weight.name);
    if (!columns.empty()) break;
  }
  return columns;
}

std::string step_header(const StepColumns& columns) {
  std::string row =
      "step,time,true_x,true_y,true_yaw,estimated_x,estimated_y,estimated_yaw,"
      "command_v,command_vy,command_omega,plan_kind,seed,cost,violation";
  for (const std::string& t : columns.terms) row += ',' + field("term_" + t);
  row +=
      ",predicted_features,tracked_features,localization,localization_error,coverage,area,"
      "path_length,collisions,clearance,cost_evaluations,gradient_evaluations,stop_reason,"
      "quality,certified,active_frontiers,guard_stops,guard_reason,task,goal_x,goal_y,goal_yaw,"
      "mode,cause,mode_since,caution,target_change,target_x,target_y,looks_x,looks_y,"
      "target_length,target_area,way_left,seeds_scored,features_weight,rejected";
  for (const std::string& name : columns.weights) {
    row += ',' + field("weight_asked_" + name) + ',' + field("weight_" + name);
  }
  return row + ",certificate,why\n";
}

std::string step_row(const StepRecord& s, const StepColumns& columns) {
  std::string row = std::to_string(s.step) + ',' + exact_text(s.time);
  for (const Pose* p : {&s.true_pose, &s.estimated_pose}) {
    row += ',' + exact_text(p->position.x()) + ',' + exact_text(p->position.y()) + ',' +
           exact_text(p->yaw);
  }
  row += ',' + exact_text(s.command.linear.x()) + ',' + exact_text(s.command.linear.y()) + ',' +
         exact_text(s.command.yaw_rate) + ',' + field(s.plan_kind) + ',' + field(s.seed);
  const bool explained = !s.explanation.terms.empty();
  row += ',' + (explained ? exact_text(s.explanation.cost) : "") + ',' +
         (explained ? exact_text(s.explanation.violation) : "");
  for (const std::string& name : columns.terms) {
    row += ',';
    for (const TermValue& t : s.explanation.terms) {
      if (t.name != name) continue;
      row += exact_text(t.raw);
      break;
    }
  }
  return row + ',' + exact_text(s.predicted_features) + ',' + std::to_string(s.tracked_features) +
         ',' + field(s.localization) + ',' + exact_text(s.localization_error) + ',' +
         exact_text(s.coverage) + ',' + exact_text(s.area) + ',' + exact_text(s.path_length) + ',' +
         std::to_string(s.collisions) + ',' + exact_text(s.clearance) + ',' +
         std::to_string(s.cost_evaluations) + ',' + std::to_string(s.gradient_evaluations) + ',' +
         field(s.stop_reason) + ',' + field(s.quality) + ',' + (s.certified ? "1" : "0") + ',' +
         std::to_string(s.active_frontiers) + ',' + std::to_string(s.guard_stops) + ',' +
         s.guard_reason + reasons(s) + weights(s, columns.weights) + sentences(s) + '\n';
}

std::string timing_header() {
  return "step,plan_ms,frontiers_ms,clearance_ms,views_ms,seeds_ms,polish_ms,certify_ms\n";
}

std::string timing_row(const StepRecord& s) {
  std::string row = std::to_string(s.step);
  for (const double ms : {s.wall.plan, s.wall.frontier_planner, s.wall.clearance, s.wall.views,
                          s.wall.seeds, s.wall.polish, s.wall.certify}) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, ",%.3f", ms);
    row += buffer;
  }
  return row + '\n';
}

}  // namespace prospect
