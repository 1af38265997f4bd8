// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/planner.h"
#include "models/knobs.h"

namespace prospect {
namespace {

void describe_weights(Knobs& knobs, PlannerParameters& p) {
  const auto weight = [&](const char* name, double& value, const char* sentence) {
    knobs.number(name, value, {0.0, 1e6}, "1", sentence);
  };
  weight("w_u", p.weights.control_effort, "deviation from the desired input");
  weight("w_du", p.weights.input_rate, "change of input");
  weight("w_o", p.weights.obstacles, "closeness to obstacles");
  weight("w_l", p.weights.visible_features, "too few visible features");
  weight("w_e", p.weights.exploration_gain, "exploration gain");
  weight("w_T", p.weights.cost_to_go, "cost-to-go");
  weight("w_h", p.weights.heading_alignment, "heading alignment");
  weight("w_c", p.w_c, "chance penalty on visible features; counts only if w_l > 0");
}

void describe_visibility(Knobs& knobs, PlannerParameters& p) {
  describe(knobs, p.features);
  knobs.boolean("feature_prior", p.feature_prior, "count features expected in unknown space");
  knobs.number("visibility_lattice", p.visibility_lattice, {0.05, 2.0}, "m",
               "spacing of the occlusion tables");
  knobs.number("unknown_attenuation", p.unknown_attenuation, {0.0, 100.0}, "1/m",
               "of rays to targets through unknown space");
  knobs.number("feature_attenuation", p.feature_attenuation, {0.0, 100.0}, "1/m",
               "of rays to features through unknown space");
  knobs.boolean("feature_occlusion", p.feature_occlusion,
                "walls hide features; false: for ablations");
  knobs.boolean("feature_covariance", p.feature_covariance,
                "landmarks and motion are uncertain; false: for ablations");
  describe(knobs, p.visibility);
  knobs.group("odometry", [&] { describe(knobs, p.visibility.odometry); });
}

}  // namespace

void describe(Knobs& knobs, PlannerParameters& p) {
  knobs.integer("N", p.N, {1, 1000}, "1", "stages of the horizon");
  knobs.number("dt", p.dt, {0.01, 5.0}, "s", "duration of a stage");
  knobs.integer("M", p.M, {1, 1000}, "1", "knots (move blocking), at most N");
  knobs.require(p.M <= p.N, "M", "more knots than stages; expected at most N");
  knobs.number("committed", p.committed, {0.01, 60.0}, "s",
               "certified and executed before the next plan");
  knobs.require(p.committed >= p.dt, "committed", "less than a stage; expected at least dt");
  knobs.require(p.committed <= p.N * p.dt, "committed",
                "longer than the horizon; expected at most N dt");
  knobs.number("deadline", p.deadline, {0.0, 60.0}, "s",
               "wall-clock limit of a planning step; 0: none, runs are reproducible");
  knobs.integer("polished", p.polished, {0, 100}, "1", "seeds handed to the solver");
  knobs.integer("polish_evaluations", p.polish_evaluations, {1, 1000000}, "1",
                "evaluations of each");
  knobs.integer("threads", p.threads, {1, 256}, "1",
                "that share a planning step; the same plans for any number");
  knobs.group("weights", [&] { describe_weights(knobs, p); });
  knobs.number("desired_speed", p.desired_speed, {0.0, 1.0}, "1", "share of the largest speed");
  knobs.number("d_safe", p.d_safe, {0.0, 5.0}, "m", "hard clearance");
  knobs.number("d_des", p.d_des, {0.01, 5.0}, "m",
               "clearance beyond which closeness costs nothing");
  knobs.require(p.d_des > p.d_safe, "d_des", "d_des <= d_safe; expected more");
  knobs.number("certificate_margin", p.certificate_margin, {0.001, 1.0}, "m",
               "by which the certified body is grown");
  knobs.number(
      "drift_margin", p.drift_margin, {0.0, 1.0}, "m",
      "kept besides, at most, from surfaces that may have drifted since they were in view");
  knobs.number("drift_limit", p.drift_limit, {0.0, 1.0}, "m",
               "drift since it was in view beyond which space counts as unknown; 0: none does");
  knobs.number("lost_margin", p.lost_margin, {0.0, 1.0}, "m",
               "kept from obstacles while localization is lost; 0: no more than else");
  knobs.choice("unknown", p.unknown, {"free", "blocked", "braking"},
               "what unknown space means to motion");
  knobs.choice("unseen_floor", p.unseen_floor, {"assumed", "blocked"},
               "what floor that no ray has met means to motion");
  knobs.integer("max_landmarks", p.max_landmarks, {0, 100000}, "1", "landmarks considered");
  knobs.integer("max_targets", p.max_targets, {0, 300}, "1", "exploration targets considered");
  knobs.boolean("target_frontier_only", p.target_frontier_only,
                "count gain only at the frontier that the cost-to-go leads to");
  knobs.number("goal_unknown_price", p.goal_unknown_price, {1.0, 1000.0}, "1",
               "what a metre through unknown space counts as on the path to a goal");
  knobs.number("return_unknown_price", p.return_unknown_price, {1.0, 1000.0}, "1",
               "the same on the path back to the start");
  knobs.group("visibility", [&] { describe_visibility(knobs, p); });
  knobs.group("recovery", [&] { describe(knobs, p.behaviour); });
  knobs.group("frontiers", [&] { describe(knobs, p.frontier_planner); });
}

}  // namespace prospect
