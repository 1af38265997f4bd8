// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/loop_judge.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "engine/support/quantile.h"
#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kTolerance = 1e-4;  // of the graph while loops are judged

Vector6d innovation(const GraphEdge& loop, const GraphEstimate& estimate) {
  const auto& poses = estimate.poses;
  return log_se3(loop.T.inverse() * (poses[static_cast<std::size_t>(loop.a)].inverse() *
                                     poses[static_cast<std::size_t>(loop.b)]));
}

/// Innovations of some loops and their covariance, all given the loops that were used.
class JointInnovations {
 public:
  JointInnovations(Eigen::VectorXd r, Eigen::MatrixXd C, std::vector<Matrix6d> noise)
      : r_(std::move(r)), C_(std::move(C)), noise_(std::move(noise)) {}

  int size() const { return static_cast<int>(noise_.size()); }
  Vector6d r(int l) const { return r_.segment<6>(6 * l); }
  Matrix6d P(int l) const { return C_.block<6, 6>(6 * l, 6 * l) + noise_[index(l)]; }
  /// Those of l if c were used: r_l - K r_c and C_ll - K C_cl, K = C_lc P_c^-1.
  std::pair<Vector6d, Matrix6d> given(int l, int c) const {
    const Matrix6d C_cl = C_.block<6, 6>(6 * c, 6 * l);
    const Matrix6d K = Eigen::LLT<Matrix6d>(P(c)).solve(C_cl).transpose();
    return {r(l) - K * r(c), P(l) - K * C_cl};
  }
  void use(int c) {
    const Eigen::LLT<Matrix6d> P_c(P(c));
    const Eigen::Matrix<double, Eigen::Dynamic, 6> column = C_.middleCols<6>(6 * c);
    const Vector6d r_c = r(c);
    r_ -= column * P_c.solve(r_c);
    const Eigen::Matrix<double, 6, Eigen::Dynamic> row = column.transpose();
    C_ -= column * P_c.solve(row);
  }

 private:
  static std::size_t index(int l) { return static_cast<std::size_t>(l); }
  Eigen::VectorXd r_;
  Eigen::MatrixXd C_;
  std::vector<Matrix6d> noise_;
};

}  // namespace

LoopJudge::LoopJudge(std::vector<GraphEdge> odometry, std::vector<GraphEdge> loops,
                     std::vector<LoopState> states, double scale, GraphEstimate start,
                     const Matrix6d& spread, const LoopJudgeOptions& options)
    : options_(options),
      odometry_(std::move(odometry)),
      loops_(std::move(loops)),
      states_(std::move(states)),
      scale_(scale),
      estimate_(std::move(start)),
      spread_(spread) {
  states_.resize(loops_.size(), LoopState::kOpen);
  for (const GraphEdge& loop : loops_) {
    noise_.push_back((loop.root.transpose() * loop.root).inverse());
  }
}

bool LoopJudge::run(GraphBudget& budget) {
  do {
    if (!solve_graph(edges_in_use(), options_.drift_sigma, kTolerance, budget, estimate_)) continue;
    if (take_back_if_strained()) continue;
    if (!change_loops()) return true;
  } while (!budget.over());
  return false;
}

std::vector<LoopState> LoopJudge::states() const {
  std::vector<LoopState> result = states_;
  for (const std::size_t k : together_) result[k] = LoopState::kOpen;
  return result;
}

std::vector<const GraphEdge*> LoopJudge::edges_in_use() const {
  std::vector<const GraphEdge*> edges;
  for (const GraphEdge& edge : odometry_) edges.push_back(&edge);
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    if (states_[k] == LoopState::kUsed) edges.push_back(&loops_[k]);
  }
  return edges;
}

double LoopJudge::worst_strain() const {
  double worst = 0.0;
  for (const GraphEdge* edge : edges_in_use()) {
    worst = std::max(worst, whitened_error(*edge, estimate_).squaredNorm() / (scale_ * scale_));
  }
  return worst;
}

bool LoopJudge::take_back_if_strained() {
  if (together_.empty()) return false;
  careful_ = worst_strain() > options_.strain;
  if (careful_) {
    for (const std::size_t k : together_) states_[k] = LoopState::kOpen;
    estimate_ = before_;
  }
  together_.clear();
  return careful_;
}

bool LoopJudge::change_loops() {
  const LinearGraph graph(edges_in_use(), options_.drift_sigma, estimate_);
  if (!graph.ok()) return false;
  Standard standard;
  std::vector<Candidate> open = candidates(graph, standard);
  // Best first.
  std::stable_sort(open.begin(), open.end(), [](const Candidate& a, const Candidate& b) {
    return a.evidence.score > b.evidence.score;
  });
  const auto likely = std::find_if(open.begin(), open.end(), [&](const Candidate& c) {
    return c.evidence.score < standard.accept;
  });
  std::vector<std::size_t> sure;
  for (auto c = open.begin(); c != likely; ++c) {
    if (is_sure(c->evidence, standard)) sure.push_back(c->loop);
  }
  // Few that are sure among many that are likely would come in few at a time.
  const auto few = std::min<std::ptrdiff_t>(likely - open.begin(), options_.together);
  if (!careful_ && !sure.empty() && std::ssize(sure) >= few) {
    before_ = estimate_;
    together_ = sure;
    for (const std::size_t k : sure) states_[k] = LoopState::kUsed;
    return true;
  }
  careful_ = false;
  return use_agreeing(graph, open, standard) || give_up_contradicting(graph);
}

std::vector<LoopJudge::Candidate> LoopJudge::candidates(const LinearGraph& graph,
                                                        Standard& standard) {
  std::vector<Candidate> open;
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    if (states_[k] == LoopState::kOpen) {
      open.push_back({k, graph.change(loops_[k].a, loops_[k].b), {}});
    }
  }
  std::vector<Matrix6d> P;
  for (const Candidate& c : open) P.push_back(noise_[c.loop]);
  std::mt19937_64 generator(options_.seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd z(graph.size());
  for (int i = 0; i < options_.samples && !open.empty(); ++i) {
    for (double& value : z) value = normal(generator);
    const Eigen::VectorXd x = graph.sample(z);
    for (std::size_t c = 0; c < open.size(); ++c) {
      const Vector6d d = graph.value(open[c].change, x);
      P[c] += d * d.transpose() / options_.samples;
    }
  }
  std::vector<LoopTest> tests;
  for (std::size_t c = 0; c < open.size(); ++c) {
    tests.emplace_back(innovation(loops_[open[c].loop], estimate_), P[c], spread_);
  }
  if (scale_ == 0.0) find_scale(tests);
  std::vector<double> scores;
  for (std::size_t c = 0; c < open.size(); ++c) {
    open[c].evidence = tests[c].evidence(scale_, options_.nu);
    scores.push_back(open[c].evidence.score);
  }
  const auto used = std::count(states_.begin(), states_.end(), LoopState::kUsed);
  const double share = share_of_right(scores, static_cast<int>(used));
  standard.accept =
      std::log(options_.odds) - std::log(std::clamp(share / (1.0 - share), 1.0, 20.0));
  standard.wrong =
      std::log((1.0 - share) * static_cast<double>(std::max<std::size_t>(1, open.size())));
  return open;
}

void LoopJudge::find_scale(const std::vector<LoopTest>& tests) {
  const auto right = [&](double s) {
    double sum = 0.0;
    for (const LoopTest& test : tests) {
      sum += 1.0 / (1.0 + options_.odds * std::exp(-test.evidence(s, options_.nu).score));
    }
    return sum;
  };
  const double by_chance = static_cast<double>(tests.size()) / options_.odds;
  scale_ = 1.0;
  double found = right(scale_);
  for (double s = 0.5; s > 0.003; s *= 0.5) {
    const double more = right(s);
    if (more <= 1.2 * found + 2.0 + by_chance) continue;
    scale_ = s;
    found = more;
  }
}

bool LoopJudge::is_sure(const LoopEvidence& evidence, const Standard& standard) const {
  return evidence.score >= standard.accept &&
         evidence.chance + standard.wrong < std::log(options_.sure);
}

bool LoopJudge::use_agreeing(const LinearGraph& graph, const std::vector<Candidate>& open,
                             const Standard& standard) {
  std::vector<Candidate> chosen;
  for (const Candidate& c : open) {
    if (std::ssize(chosen) < options_.together && c.evidence.score > 0.0) chosen.push_back(c);
  }
  const int m = static_cast<int>(chosen.size());
  Eigen::VectorXd r(6 * m);
  Eigen::MatrixXd C(6 * m, 6 * m);
  std::vector<Matrix6d> noise;
  for (int c = 0; c < m; ++c) {
    const Candidate& of = chosen[static_cast<std::size_t>(c)];
    r.segment<6>(6 * c) = innovation(loops_[of.loop], estimate_);
    noise.push_back(noise_[of.loop]);
    const auto response = graph.response(of.change);
    for (int l = 0; l < m; ++l) {
      C.block<6, 6>(6 * l, 6 * c) =
          graph.covariance(chosen[static_cast<std::size_t>(l)].change, response);
    }
  }
  JointInnovations joint(std::move(r), std::move(C), std::move(noise));
  const auto evidence = [&](const Vector6d& r_l, const Matrix6d& P_l) {
    return LoopTest(r_l, P_l, spread_).evidence(scale_, options_.nu);
  };
  int best = -1;
  double most = 0.0;
  for (int c = 0; c < m; ++c) {
    const LoopEvidence own = evidence(joint.r(c), joint.P(c));
    if (own.score < standard.accept) continue;
    double support = own.score, agreeing = 1.0;
    for (int l = 0; l < m; ++l) {
      if (l == c) continue;
      const auto [r_l, P_l] = joint.given(l, c);
      const double score = evidence(r_l, P_l).score;
      support += std::max(0.0, score);
      agreeing += score >= standard.accept ? 1.0 : 0.0;
    }
    // Wrong loops that agree come together, as many groups as there are.
    if (own.chance + standard.wrong - std::log(agreeing) > std::log(options_.lone)) continue;
    if (support > most) most = support, best = c;
  }
  if (best < 0) return false;
  while (best >= 0) {
    LoopState& state = states_[chosen[static_cast<std::size_t>(best)].loop];
    state = LoopState::kUsed;
    joint.use(best);
    best = -1;
    most = 0.0;
    for (int l = 0; l < m; ++l) {
      if (states_[chosen[static_cast<std::size_t>(l)].loop] == LoopState::kUsed) continue;
      const LoopEvidence own = evidence(joint.r(l), joint.P(l));
      if (is_sure(own, standard) && own.score > most) most = own.score, best = l;
    }
  }
  return true;
}

std::vector<Vector6d> LoopJudge::errors_of_used(const LinearGraph& graph) const {
  // At the least squares, where the solver has not come quite: the way that is left is far shorter
  // than the loops' deviations, but not than those of their errors.
  std::vector<Vector6d> w(graph.edges());
  for (std::size_t e = 0; e < w.size(); ++e) w[e] = -graph.error(e);
  const Eigen::VectorXd step = graph.least_squares(w, -estimate_.beta / options_.drift_sigma);
  std::vector<Vector6d> errors;
  for (std::size_t e = odometry_.size(); e < w.size(); ++e) {
    errors.push_back(graph.error(e) + graph.whitened_change(e, step));
  }
  return errors;
}

std::vector<double> LoopJudge::strains_of_used(const LinearGraph& graph,
                                               const std::vector<Vector6d>& errors) const {
  std::vector<Matrix6d> S(errors.size(), Matrix6d::Zero());
  std::mt19937_64 generator(options_.seed + 1);
  std::normal_distribution<double> normal;
  std::vector<Vector6d> w(graph.edges());
  for (int i = 0; i < options_.samples; ++i) {
    for (Vector6d& v : w) {
      for (double& value : v) value = normal(generator);
    }
    Vector6d w_beta;
    for (double& value : w_beta) value = normal(generator);
    const Eigen::VectorXd x = graph.least_squares(w, w_beta);
    for (std::size_t k = 0; k < errors.size(); ++k) {
      const std::size_t e = odometry_.size() + k;
      const Vector6d d = w[e] - graph.whitened_change(e, x);
      S[k] += d * d.transpose() / options_.samples;
    }
  }
  // The inverse of a covariance from n samples of six numbers is n / (n - 7) times too large.
  const double too_large = options_.samples / std::max(1.0, options_.samples - 7.0);
  std::vector<double> strains;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const Eigen::LLT<Matrix6d> root(S[k]);
    strains.push_back(errors[k].dot(root.solve(errors[k])) / (too_large * scale_ * scale_));
  }
  return strains;
}

bool LoopJudge::give_up_contradicting(const LinearGraph& graph) {
  std::vector<std::size_t> used;
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    if (states_[k] == LoopState::kUsed) used.push_back(k);
  }
  if (used.empty()) return false;
  const std::vector<Vector6d> errors = errors_of_used(graph);
  const std::vector<double> strains = strains_of_used(graph, errors);
  const double dimensions = estimate_.planar ? 3.0 : 6.0;
  const double limit =
      options_.limit * dimensions * std::max(1.0, quantile(strains, 0.5) / dimensions);
  std::vector<std::pair<double, std::size_t>> against;
  double worst = 0.0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (strains[i] < 0.4 * limit) continue;
    // Without this loop: of a whitened error r with covariance S = I - J H^-1 J^T the innovation is
    // S^-1 r, with covariance S^-1.
    const GraphEdge& loop = loops_[used[i]];
    const LinearGraph::Change change = graph.change(loop.a, loop.b);
    const Matrix6d& J = graph.by_b(odometry_.size() + i);
    const Matrix6d S =
        Matrix6d::Identity() - J * graph.covariance(change, graph.response(change)) * J.transpose();
    const Matrix6d S_inverse = S.inverse(), unwhiten = loop.root.inverse();
    const LoopTest test(unwhiten * (S_inverse * errors[i]),
                        unwhiten * S_inverse * unwhiten.transpose(), spread_);
    const LoopEvidence evidence = test.evidence(scale_, options_.nu);
    if (evidence.score >= 0.0 && evidence.chi2 < limit) continue;
    against.emplace_back(evidence.chi2, used[i]);
    worst = std::max(worst, evidence.chi2);
  }
  for (const auto& [chi2, k] : against) {
    if (chi2 >= 0.5 * worst) states_[k] = LoopState::kGivenUp;
  }
  return !against.empty();
}

}  // namespace prospect
