// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/step_fields.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "engine/support/named.h"
#include "models/range_text.h"

namespace prospect {
namespace {

constexpr unsigned kShown = kSteps | kPage, kTimed = kTiming | kPage,
                   kOfCorrections = kShown | kCorrected;

template <class Member>
constexpr bool kIsWord = false;
template <class Enum>
constexpr bool kIsWord<std::optional<Enum>> = std::is_enum_v<Enum>;

// How a member is told and entered, by its type.

template <class Member>
constexpr FieldType type_of() {
  if (kIsWord<Member>) return FieldType::kWord;
  if (std::is_same_v<Member, std::string>) return FieldType::kText;
  if (std::is_same_v<Member, bool>) return FieldType::kFlag;
  return std::is_same_v<Member, int> ? FieldType::kInteger : FieldType::kNumber;
}

template <class Member>
StepValue value_of(const Member& member) {
  if constexpr (kIsWord<Member>) {
    return name_of(member);
  } else if constexpr (std::is_same_v<Member, std::optional<double>>) {
    return member ? StepValue(*member) : StepValue();
  } else {
    return member;
  }
}

/// Whole numbers and flags: one that is too large is the largest, one that is not finite 0.
template <class Member>
bool enter(Member& member, const std::string& text) {
  if constexpr (std::is_same_v<Member, std::string>) {
    member = text;
  } else if constexpr (kIsWord<Member>) {
    member = named<typename Member::value_type>(text);
    return member || text.empty();
  } else {
    double number = 0.0;
    if (!parse_number(text, number)) return false;
    if constexpr (std::is_integral_v<Member>) {
      constexpr double kLeast = std::numeric_limits<int>::lowest(),
                       kMost = std::numeric_limits<int>::max();
      number = std::isfinite(number) ? std::clamp(number, kLeast, kMost) : 0.0;
    }
    member = static_cast<Member>(number);
  }
  return true;
}

/// Of a word; but for a first one that says that there is nothing to say.
template <class Member>
std::vector<std::string_view> words_of() {
  std::vector<std::string_view> words;
  if constexpr (kIsWord<Member>) words = names_of<typename Member::value_type>();
  if (std::is_same_v<Member, std::optional<GuardReason>> ||
      std::is_same_v<Member, std::optional<TargetChange>>) {
    words.erase(words.begin());
  }
  return words;
}

/// at(step): where the member is; null: the step lacks it. Of a step that is entered it makes what
/// the member is a part of.
template <class At>
constexpr StepField field(std::string_view name, std::string_view unit, unsigned tables,
                          int log_place, std::string_view sentence, At) {
  using Member = std::remove_pointer_t<decltype(At{}(std::declval<StepRecord&>()))>;
  return {name,
          unit,
          type_of<Member>(),
          FieldPer::kStep,
          tables,
          log_place,
          sentence,
          [](const StepRecord& step, std::string_view) {
            const auto* member = At{}(step);
            return member ? value_of(*member) : StepValue();
          },
          [](StepRecord& step, std::string_view, const std::string& text) {
            auto* member = At{}(step);
            return !member || enter(*member, text);
          },
          words_of<Member>};
}

/// One that follows from others.
constexpr StepField derived_field(std::string_view name, FieldType type, FieldPer per,
                                  std::string_view sentence,
                                  StepValue (*of)(const StepRecord&, std::string_view)) {
  const auto enter = [](StepRecord&, std::string_view, const std::string&) { return true; };
  return {name, "", type, per, kSteps, 0, sentence, of, enter, words_of<std::string>};
}

template <class Weights>
auto* weight_named(Weights& weights, std::string_view name) {
  const auto found = std::find_if(weights.begin(), weights.end(),
                                  [&](const TermWeight& w) { return w.name == name; });
  return found == weights.end() ? nullptr : &*found;
}

/// A member of each cost's weight.
template <double TermWeight::*member>
constexpr StepField weight_field(std::string_view name, std::string_view sentence) {
  StepField field = derived_field(name, FieldType::kNumber, FieldPer::kWeight, sentence,
                                  [](const StepRecord& step, std::string_view of) {
                                    const TermWeight* w = weight_named(step.weights, of);
                                    return w ? StepValue(w->*member) : StepValue();
                                  });
  field.tables = kShown;
  field.enter = [](StepRecord& step, std::string_view of, const std::string& text) {
    TermWeight* w = weight_named(step.weights, of);
    if (!w) w = &step.weights.emplace_back(TermWeight{std::string(of)});
    return enter(w->*member, text);
  };
  return field;
}

/// A member of the target; none: the step has no target. One that is entered gets it.
template <class Step, class Member>
auto of_target(Step& s, Member member) -> decltype(member(*s.target)) {
  if constexpr (!std::is_const_v<Step>) {
    if (!s.target) s.target.emplace();
  }
  return s.target ? member(*s.target) : nullptr;
}
template <class Step>
auto of_goal(Step& s, int axis) -> decltype(&(*s.goal)[axis]) {
  if constexpr (!std::is_const_v<Step>) {
    if (!s.goal) s.goal = Eigen::Vector2d::Zero();
  }
  return s.goal ? &(*s.goal)[axis] : nullptr;
}
/// A member of where the map's frame is; none: nobody corrects it.
template <class Step, class Member>
auto of_map_frame(Step& s, Member member) -> decltype(member(*s.map_frame)) {
  if constexpr (!std::is_const_v<Step>) {
    if (!s.map_frame) s.map_frame.emplace();
  }
  return s.map_frame ? member(*s.map_frame) : nullptr;
}
/// A member of the explanation; none: there is no plan.
template <class Step, class Member>
auto of_explanation(Step& s, Member member) -> decltype(&(s.explanation.*member)) {
  return s.explanation.terms.empty() ? nullptr : &(s.explanation.*member);
}

/// The best candidates that were not executed: name, cost, and whether the certificate refused it.
StepValue rejected(const StepRecord& s, std::string_view) {
  std::string list;
  for (const CandidateRecord& c : s.candidates) {
    if (c.verdict.kind == Verdict::Kind::kExecuted) continue;
    if (!list.empty()) list += "; ";
    char cost[32];
    std::snprintf(cost, sizeof cost, " %.4g", c.explanation.cost);
    list +=
        c.name + cost + (c.verdict.kind == Verdict::Kind::kNotTried ? " not tried" : " refused");
  }
  return list;
}

StepValue raw_value(const StepRecord& s, std::string_view name) {
  for (const TermValue& t : s.explanation.terms) {
    if (t.name == name) return t.raw;
  }
  return {};
}

constexpr std::string_view
    kTruePose = "true pose; the frames agree at the start; yaw is not wrapped",
    kEstimatedPose = "pose that the robot believes",
    kFirstCommand = "the first command of the plan, in the body frame",
    kOfTheSolve = "evaluations of this step's solve",
    kAge =
        "how much older than the plan the belief is of which it has its "
        "landmarks, frontiers and cost-to-go, distances to obstacles: "
        "0 but where there was no time for newer ones, or frontiers "
        "were prepared",
    kGoalPose = "where to, empty if it leads nowhere or, of the yaw, if any will do",
    kTargetPlace = "where the frontiers want the robot, empty without a target",
    kMapOrigin =
        "where the frame of the poses lies in that of the map; this and what "
        "follows of corrections only where there may be "
        "[some](models.md#frames)",
    kCorrection =
        "by how far the robot and its heading moved in the map since the "
        "step before",
    kTargetSeen = "the frontier cell that is seen from there";

constexpr StepField kStepFields[] = {
    field("step", "", kSteps | kTiming, 1, "planning step from 0", [](auto& s) { return &s.step; }),
    field("time", "s", kShown, 2, "the robot's clock since the start",
          [](auto& s) { return &s.time; }),
    field("true_x", "m", kShown, 17, kTruePose, [](auto& s) { return &s.true_pose.position.x(); }),
    field("true_y", "m", kShown, 18, kTruePose, [](auto& s) { return &s.true_pose.position.y(); }),
    field("true_z", "m", 0, 19, kTruePose, [](auto& s) { return &s.true_pose.position.z(); }),
    field("true_yaw", "rad", kShown, 20, kTruePose, [](auto& s) { return &s.true_pose.yaw; }),
    field("estimated_x", "m", kShown, 13, kEstimatedPose,
          [](auto& s) { return &s.estimated_pose.position.x(); }),
    field("estimated_y", "m", kShown, 14, kEstimatedPose,
          [](auto& s) { return &s.estimated_pose.position.y(); }),
    field("estimated_z", "m", 0, 15, kEstimatedPose,
          [](auto& s) { return &s.estimated_pose.position.z(); }),
    field("estimated_yaw", "rad", kShown, 16, kEstimatedPose,
          [](auto& s) { return &s.estimated_pose.yaw; }),
    field("command_v", "m/s", kShown, 10, kFirstCommand,
          [](auto& s) { return &s.command.linear.x(); }),
    field("command_vy", "m/s", kShown, 11, kFirstCommand,
          [](auto& s) { return &s.command.linear.y(); }),
    field("command_omega", "rad/s", kShown, 12, kFirstCommand,
          [](auto& s) { return &s.command.yaw_rate; }),
    field("plan_kind", "", kShown, 8,
          "what the plan is made of; a seed is not polished, as in an approach",
          [](auto& s) { return &s.plan_kind; }),
    field("seed", "", kShown, 9, "the candidate that the plan grew from",
          [](auto& s) { return &s.seed; }),
    field("cost", "", kSteps, 0, "the objective",
          [](auto& s) { return of_explanation(s, &Explanation::cost); }),
    field("violation", "", kSteps, 0, "the largest violation of a constraint",
          [](auto& s) { return of_explanation(s, &Explanation::violation); }),
    derived_field(
        "term", FieldType::kNumber, FieldPer::kTerm,
        "each term raw: a cost's unweighted value, a constraint's smallest row (negative: "
        "violated). The terms of the first step that has a plan",
        raw_value),
    field("predicted_features", "", kShown, 23,
          "features expected to be visible at the end of the part of the plan that is driven",
          [](auto& s) { return &s.predicted_features; }),
    field("tracked_features", "", kShown, 24, "features tracked in the newest image",
          [](auto& s) { return &s.tracked_features; }),
    field("localization", "", kShown, 21, "how well the robot knows where it is",
          [](auto& s) { return &s.localization; }),
    field("localization_error", "m", kShown, 22, "distance between true and estimated position",
          [](auto& s) { return &s.localization_error; }),
    field("coverage", "", kShown, 25,
          "share of the reachable area that has been seen, `nan` where nothing is reachable",
          [](auto& s) { return &s.coverage; }),
    field("area", "m²", kShown, 26, "area of what has been seen of it",
          [](auto& s) { return &s.area; }),
    field("path_length", "m", kShown, 27, "length driven so far",
          [](auto& s) { return &s.path_length; }),
    field("collisions", "", kShown, 28, "contacts so far", [](auto& s) { return &s.collisions; }),
    field("clearance", "m", kShown, 29,
          "smallest distance from the robot to an obstacle along the plan",
          [](auto& s) { return &s.clearance; }),
    field("cost_evaluations", "", kShown, 32, kOfTheSolve,
          [](auto& s) { return &s.cost_evaluations; }),
    field("gradient_evaluations", "", kShown, 33, kOfTheSolve,
          [](auto& s) { return &s.gradient_evaluations; }),
    field("stop_reason", "", kShown, 34, "why the solver stopped",
          [](auto& s) { return &s.stop_reason; }),
    field("quality", "", kShown, 35, "how good its result is", [](auto& s) { return &s.quality; }),
    field("certified", "", kShown, 36, "1 if the plan was proved safe to drive",
          [](auto& s) { return &s.certified; }),
    field("active_frontiers", "", kShown, 30, "frontiers that still attract",
          [](auto& s) { return &s.active_frontiers; }),
    field(
        "frontiers", "", kSteps, 70,
        "of a step that asked [which is next](frontiers.md#order-what-comes-next): the target and "
        "three after it; then how many of the others are `later`, `farther`, of `low yield`, "
        "promise too `little`, have `no path`",
        [](auto& s) { return &s.frontiers; }),
    field("guard_stops", "", kShown, 38, "commands that the guard replaced since the step before",
          [](auto& s) { return &s.guard_stops; }),
    field("guard_reason", "", kShown, 39,
          "why the guard replaced the last of them, empty if there are none",
          [](auto& s) { return &s.guard_reason; }),
    field("task", "", kShown, 7, "what it was told to do", [](auto& s) { return &s.task; }),
    field("goal_x", "m", kShown, 49, kGoalPose, [](auto& s) { return of_goal(s, 0); }),
    field("goal_y", "m", kShown, 50, kGoalPose, [](auto& s) { return of_goal(s, 1); }),
    field("goal_yaw", "rad", kShown, 51, kGoalPose, [](auto& s) { return &s.goal_yaw; }),
    field("mode", "", kShown, 3, "what the robot [does](behaviour.md)",
          [](auto& s) { return &s.mode; }),
    field("cause", "", kShown, 4, "why it began to do that", [](auto& s) { return &s.cause; }),
    field("mode_since", "s", kShown, 5, "when it began to", [](auto& s) { return &s.mode_since; }),
    field("caution", "", kShown, 6, "which distances it keeps",
          [](auto& s) { return &s.safety_level; }),
    field(
        "target_change", "", kShown, 31,
        "why the target is [another](frontiers.md#order-what-comes-next), empty if it is the same",
        [](auto& s) { return &s.target_change; }),
    field("target_x", "m", kShown, 52, kTargetPlace,
          [](auto& s) { return of_target(s, [](auto& t) { return &t.viewpoint.x(); }); }),
    field("target_y", "m", kShown, 53, kTargetPlace,
          [](auto& s) { return of_target(s, [](auto& t) { return &t.viewpoint.y(); }); }),
    field("looks_x", "m", kShown, 54, kTargetSeen,
          [](auto& s) { return of_target(s, [](auto& t) { return &t.looks_at.x(); }); }),
    field("looks_y", "m", kShown, 55, kTargetSeen,
          [](auto& s) { return of_target(s, [](auto& t) { return &t.looks_at.y(); }); }),
    field("target_length", "m", kShown, 56, "length of that frontier",
          [](auto& s) { return of_target(s, [](auto& t) { return &t.length; }); }),
    field("target_area", "m²", kShown, 57, "area that an observation is expected to show",
          [](auto& s) { return of_target(s, [](auto& t) { return &t.area; }); }),
    field("way_left", "m", kShown, 58, "path to the viewpoint",
          [](auto& s) { return of_target(s, [](auto& t) { return &t.path_left; }); }),
    field("seeds_scored", "", kShown, 40, "how many starts were compared",
          [](auto& s) { return &s.seeds_scored; }),
    field("features_weight", "", kShown, 41, "`weight_visible_features`, w_l in effect",
          [](auto& s) { return &s.features_weight; }),
    derived_field(
        "rejected", FieldType::kText, FieldPer::kStep,
        "the best candidates that were not executed, best first: name, cost, and `refused` (by "
        "the certificate) or `not tried`",
        rejected),
    weight_field<&TermWeight::asked>("weight_asked",
                                     "of each cost: the weight as asked for (`planner.weights`, "
                                     "`planner.terms`); negative: a reward"),
    weight_field<&TermWeight::in_effect>(
        "weight",
        "the weight in effect in this step. `cost` is the sum of `weight_NAME` times "
        "`term_NAME`. Those of features and exploration are scaled by the [mode](behaviour.md), "
        "that of the features is "
        "[bounded](formulation.md#7-the-problem-enginetermsproblem_specificationh)"),
    field("map_x", "m", kOfCorrections, 62, kMapOrigin,
          [](auto& s) { return of_map_frame(s, [](auto& m) { return &m.origin.position.x(); }); }),
    field("map_y", "m", kOfCorrections, 63, kMapOrigin,
          [](auto& s) { return of_map_frame(s, [](auto& m) { return &m.origin.position.y(); }); }),
    field("map_yaw", "rad", kOfCorrections, 64, kMapOrigin,
          [](auto& s) { return of_map_frame(s, [](auto& m) { return &m.origin.yaw; }); }),
    field("corrections", "", kOfCorrections, 65, "of the map, so far",
          [](auto& s) { return of_map_frame(s, [](auto& m) { return &m.taken; }); }),
    field("corrections_refused", "", kOfCorrections, 66, "likewise, that were not taken",
          [](auto& s) { return of_map_frame(s, [](auto& m) { return &m.refused; }); }),
    field("corrected_by", "m", kOfCorrections, 67, kCorrection,
          [](auto& s) { return of_map_frame(s, [](auto& m) { return &m.distance; }); }),
    field("corrected_turn", "rad", kOfCorrections, 68, kCorrection,
          [](auto& s) { return of_map_frame(s, [](auto& m) { return &m.turn; }); }),
    field("certificate", "", kShown, 37, "how the plan was proved safe, or why not",
          [](auto& s) { return &s.certificate; }),
    field("why", "", kShown, 0, "what it does and why, in a sentence with the numbers of this step",
          [](auto& s) { return &s.why; }),
    field("corrected_why", "", kOfCorrections, 69, "who corrected it",
          [](auto& s) { return of_map_frame(s, [](auto& m) { return &m.why; }); }),
    field("plan_ms", "ms", kTimed, 42, "wall-clock time of the whole planning step",
          [](auto& s) { return &s.wall.plan; }),
    field("frontiers_ms", "ms", kTimed, 43, "time for frontiers and cost-to-go",
          [](auto& s) { return &s.wall.frontier_planner; }),
    field("clearance_ms", "ms", kTimed, 44, "time for the clearance field",
          [](auto& s) { return &s.wall.clearance; }),
    field("views_ms", "ms", kTimed, 45, "time for the choice of landmarks",
          [](auto& s) { return &s.wall.views; }),
    field("seeds_ms", "ms", kTimed, 46, "time for making and comparing starts",
          [](auto& s) { return &s.wall.seeds; }),
    field("polish_ms", "ms", kTimed, 47, "time for the optimisation",
          [](auto& s) { return &s.wall.polish; }),
    field("certify_ms", "ms", kTimed, 48, "time for the certificate",
          [](auto& s) { return &s.wall.certify; }),
    field("landmarks_age", "s", kTimed, 59, kAge, [](auto& s) { return &s.age.landmarks; }),
    field("frontiers_age", "s", kTimed, 60, kAge, [](auto& s) { return &s.age.global_plan; }),
    field("clearance_age", "s", kTimed, 61, kAge, [](auto& s) { return &s.age.clearance; }),
};

/// "a, b, c", each between two marks.
std::string list_of(const std::vector<std::string_view>& words, std::string_view mark) {
  std::string list;
  for (const std::string_view word : words) {
    list += list.empty() ? "" : ", ";
    list.append(mark).append(word).append(mark);
  }
  return list;
}

}  // namespace

std::string text_of(const StepValue& value) {
  struct Text {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(bool flag) const { return flag ? "1" : "0"; }
    std::string operator()(int number) const { return std::to_string(number); }
    std::string operator()(double number) const { return exact_text(number); }
    std::string operator()(const std::string& text) const { return text; }
  };
  return std::visit(Text(), value);
}

double number_of(const StepValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? 1.0 : 0.0;
  if (const int* number = std::get_if<int>(&value)) return *number;
  const double* number = std::get_if<double>(&value);
  return number ? *number : std::numeric_limits<double>::quiet_NaN();
}

std::span<const StepField> step_fields() { return kStepFields; }

std::pair<const StepField*, std::string> field_of_column(const std::string& column) {
  const StepField* found = nullptr;
  for (const StepField& field : step_fields()) {
    if (field.per == FieldPer::kStep) {
      if (field.name == column) return {&field, ""};
    } else if (column.starts_with(std::string(field.name) + '_') &&
               (!found || field.name.size() > found->name.size())) {
      found = &field;
    }
  }
  return {found, found ? column.substr(found->name.size() + 1) : ""};
}

void enter_field(const StepField& field, const std::string& name, const std::string& text,
                 const std::string& where, StepRecord& step) {
  if (field.enter(step, name, text)) return;
  fail(where,
       std::string(field.name) + (name.empty() ? "" : "." + name) + " is '" + text +
           "'; expected " +
           (field.type == FieldType::kWord ? "one of " + list_of(field.words(), "") : "a number"));
}

std::string step_field_table() {
  std::string table = "| column | unit | what |\n|---|---|---|\n";
  std::vector<const StepField*> row;
  const auto end_row = [&] {
    if (row.empty()) return;
    std::string columns, units;
    for (const StepField* f : row) {
      columns += columns.empty() ? '`' : ' ';
      columns += f->name;
      if (f->per != FieldPer::kStep) columns += "_NAME";
      if (!units.ends_with(f->unit)) units += (units.empty() ? "" : ", ") + std::string(f->unit);
    }
    table.append("| ").append(columns).append("` | ").append(units).append(" | ");
    table += row.front()->sentence;
    if (row.front()->type == FieldType::kWord) table += ": " + list_of(row.front()->words(), "`");
    table += " |\n";
    row.clear();
  };
  for (const StepField& field : step_fields()) {
    if (!field.in(kSteps) && !field.in(kTiming)) continue;
    if (!row.empty() && row.front()->sentence != field.sentence) end_row();
    row.push_back(&field);
  }
  end_row();
  return table;
}

}  // namespace prospect
