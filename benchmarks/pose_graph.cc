// SPDX-License-Identifier: Apache-2.0
// pose_graph FILE.g2o [--truth FILE.g2o] [--json]: a pose graph whose loops may be wrong, judged
// and solved (perception/graph). Which edges are odometry: adapters/formats/datasets/g2o_file.h.
//
// A loop is right if its ends are at most 10 m apart in the truth. ate_m: root of the mean squared
// distance to the truth after the best rigid motion. seconds: of the processor, from the graph as
// read to the poses, on one thread. --right-loops: only the loops that are right, all of them used,
// none judged: what judging could reach. --wrong KIND --count N --seed S --keep SHARE: the file's
// right loops, or a share of them drawn by the seed, and N wrong ones made from the truth
// (wrong_loops.h), in an order drawn by the seed.

#include "perception/graph/pose_graph.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/g2o_file.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/trajectory_error.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "benchmarks/wrong_loops.h"
#include "engine/support/stopwatch.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Poses = std::map<int, Isometry3d>;

struct Request {
  std::string file, truth, out, wrong;
  bool json = false, right_loops = false;
  int count = 300, seed = 1;
  double keep = 1.0;
};

bool is_right(const G2oGraph::Edge& loop, const Poses& truth) {
  const Isometry3d T = truth.at(loop.from).inverse() * truth.at(loop.to);
  return T.translation().norm() <= 10.0;
}

Poses read_truth(const std::string& path, const G2oGraph& graph, const G2oOrder& order) {
  Poses truth = poses_of(read_g2o(path));
  const auto check = [&](int id) {
    if (truth.contains(id)) return;
    fail(path, "no vertex " + std::to_string(id) + "; expected all those of " + graph.path);
  };
  check(order.first);
  for (const G2oOrder::Step& step : order.odometry) check(step.id);
  return truth;
}

std::vector<G2oGraph::Edge> chosen_loops(const Request& request, const G2oGraph& graph,
                                         const G2oOrder& order, const Poses& truth) {
  std::vector<G2oGraph::Edge> loops;
  std::mt19937_64 generator(static_cast<std::uint64_t>(request.seed));
  std::uniform_real_distribution<double> uniform;
  std::vector<Eigen::Matrix<double, 6, 6>> informations;
  bool planar = true;
  for (const std::size_t e : order.loops) {
    const G2oGraph::Edge& loop = graph.edges[e];
    informations.push_back(loop.measured.information);
    planar = planar && loop.measured.T.translation().z() == 0.0;
    const bool right = truth.empty() || is_right(loop, truth);
    if ((request.right_loops || !request.wrong.empty()) && !right) continue;
    if (!request.wrong.empty() && uniform(generator) >= request.keep) continue;
    loops.push_back(loop);
  }
  if (request.wrong.empty()) return loops;
  for (const WrongLoop& loop :
       wrong_loops(truth, planar, request.wrong, request.count,
                   static_cast<std::uint64_t>(request.seed), informations)) {
    loops.push_back({loop.from, loop.to, loop.measured, "made"});
  }
  std::shuffle(loops.begin(), loops.end(), generator);
  return loops;
}

void take(GraphInput input, const std::string& where) {
  if (input != GraphInput::kTaken) fail(where, std::string(reason(input)));
}

double error_of(const std::vector<int>& ids, const Poses& poses, const Poses& truth) {
  std::vector<PosePair> pairs;
  for (const int id : ids) pairs.push_back({0.0, poses.at(id), truth.at(id)});
  return absolute_error(pairs, Alignment::kBestFit).rmse;
}

void write_poses(const std::string& path, const std::vector<int>& ids, const PoseGraph& graph) {
  std::ofstream out(path);
  out.precision(12);
  for (const int id : ids) {
    const Isometry3d T = *graph.pose(id);
    const Eigen::Quaterniond q(T.linear());
    out << "VERTEX_SE3:QUAT " << id << ' ' << T.translation().transpose() << ' ' << q.x() << ' '
        << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
  }
  if (!out.flush()) fail(path, "cannot be written; expected a file in a folder that is there");
}

int main_program(int argc, char** argv) {
  Request request;
  ProgramOptions program("A pose graph whose loops may be wrong, judged and solved");
  program.add("file", request.file, "Graph, in the format of g2o", {.required = true});
  program.add("--truth", request.truth, "True poses, in the format of g2o");
  program.add("--json", request.json, "Print one line for machines");
  program.add("--out", request.out, "Write the poses, in the format of g2o");
  program.add("--right-loops", request.right_loops, "Only the right loops, none judged");
  program.add("--wrong", request.wrong, "Wrong loops to make in place of the file's",
              {.one_of = wrong_loop_kinds()});
  program.add("--count", request.count, "Wrong loops to make", {.least = 0, .most = 1e6});
  program.add("--seed", request.seed, "Of what is drawn", {.least = 0});
  program.add("--keep", request.keep, "Share of the right loops", {.least = 0.0, .most = 1.0});
  if (const auto end = program.parse(argc, argv)) return *end;
  if (request.truth.empty() && (request.right_loops || !request.wrong.empty())) {
    fail("--truth", "not given; expected a file, to tell right loops from wrong ones");
  }
  const G2oGraph file = read_g2o(request.file);
  const G2oOrder order = order_of(file);
  const Poses truth = request.truth.empty() ? Poses() : read_truth(request.truth, file, order);
  const std::vector<G2oGraph::Edge> loops = chosen_loops(request, file, order, truth);

  ProcessorStopwatch clock;
  PoseGraph graph({.judge = {}, .trust_loops = request.right_loops});
  const auto first = file.vertices.find(order.first);
  take(graph.begin(order.first,
                   first == file.vertices.end() ? Isometry3d::Identity() : first->second),
       request.file);
  for (const G2oOrder::Step& step : order.odometry) {
    take(graph.add_keyframe(step.id, step.from, step.measured), request.file);
  }
  std::vector<int> ids = {order.first};
  for (const G2oOrder::Step& step : order.odometry) ids.push_back(step.id);
  Poses odometry, poses;
  for (const int id : ids) odometry[id] = *graph.pose(id);
  for (const G2oGraph::Edge& loop : loops) {
    take(graph.add_loop(loop.from, loop.to, loop.measured), loop.where);
  }
  graph.optimise();
  const double seconds = 1e-3 * clock.lap();
  for (const int id : ids) poses[id] = *graph.pose(id);

  int right = 0, right_used = 0, wrong_used = 0, used = 0;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const bool in_use = graph.loops()[k] == LoopState::kUsed;
    used += in_use;
    if (truth.empty()) continue;
    const bool is = is_right(loops[k], truth);
    right += is;
    right_used += in_use && is;
    wrong_used += in_use && !is;
  }
  if (!request.out.empty()) write_poses(request.out, ids, graph);
  const bool known = !truth.empty();
  const double ate = known ? error_of(ids, poses, truth) : std::nan("");
  const double before = known ? error_of(ids, odometry, truth) : std::nan("");
  const int wrong = static_cast<int>(loops.size()) - right;
  if (request.json) {
    std::printf("{\"keyframes\": %zu, \"loops\": %zu, \"used\": %d, \"seconds\": %.3f, ",
                ids.size(), loops.size(), used, seconds);
    std::printf(known ? "\"ate_m\": %.4f, \"odometry_ate_m\": %.4f, \"right\": %d, "
                        "\"right_used\": %d, \"wrong\": %d, \"wrong_used\": %d}\n"
                      : "\"ate_m\": null, \"odometry_ate_m\": null, \"right\": null, "
                        "\"right_used\": null, \"wrong\": null, \"wrong_used\": null}\n",
                ate, before, right, right_used, wrong, wrong_used);
    return 0;
  }
  std::printf("%zu keyframes, %d of %zu loops used, %.2f s\n", ids.size(), used, loops.size(),
              seconds);
  if (known) {
    std::printf("%d of %d right loops, %d of %d wrong ones; error %.2f m, of the odometry %.2f m\n",
                right_used, right, wrong_used, wrong, ate, before);
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("pose_graph", prospect::main_program, argc, argv);
}
