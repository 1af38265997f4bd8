// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/camera_time_offset.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "perception/odometry/median.h"

namespace prospect {
namespace {

constexpr std::size_t kLeastPoints = 12;
constexpr double kLeastNoise = 0.05;  // [px] of a row error, whatever the residuals say
constexpr double kHuber = 1.5;        // standard deviations
/// [px] by which rows move between frames, as a root mean square: less is what poses err by.
constexpr double kLeastMotion = 0.25;
constexpr double kRegular = 0.02;    // of it, by which regular stamps may be off
constexpr double kLongestGap = 2.5;  // of the usual time between frames
constexpr std::size_t kBlocks = 16, kLeastBlocks = 4;
/// Of the time between frames, by which the curve between them may be off half way.
constexpr double kGuess = 0.03;
constexpr double kMargin = 0.15;  // of a piece's length, by which an estimate may lie outside

/// Student's t over the normal distribution's quantile for 99.73 %, three deviations.
double widening(std::size_t blocks) {
  constexpr std::array<double, kBlocks + 1> kRatio = {0.0,  0.0,  0.0,  0.0,  3.07, 2.21,
                                                      1.84, 1.63, 1.51, 1.43, 1.36, 1.32,
                                                      1.29, 1.26, 1.24, 1.22, 1.20};
  return kRatio[std::min(blocks, kBlocks)];
}

/// A curve through values at whole steps, between the m-th and the one after it, `along` of the
/// way: its value and its slope there by the step (Catmull and Rom 1974; a parabola at the ends).
template <std::size_t n>
std::pair<double, double> curve(const std::array<double, n>& values, std::size_t m, double along) {
  const double b = values[m], c = values[m + 1];
  const double before =
      m > 0 ? 0.5 * (c - values[m - 1]) : c - b - 0.5 * (values[m + 2] - 2.0 * c + b);
  const double after =
      m + 2 < n ? 0.5 * (values[m + 2] - b) : c - b + 0.5 * (c - 2.0 * b + values[m - 1]);
  const double cubic = before + after - 2.0 * (c - b);
  const double square = 3.0 * (c - b) - 2.0 * before - after;
  return {b + along * (before + along * (square + along * cubic)),
          before + along * (2.0 * square + along * 3.0 * cubic)};
}

/// phi of the rectification.
Eigen::Matrix<double, 5, 1> phi(const Eigen::Vector2d& at) {
  Eigen::Matrix<double, 5, 1> values;
  values << 1.0, at.x(), at.y(), at.x() * at.y(), at.y() * at.y();
  return values;
}

}  // namespace

CameraTimeOffset::CameraTimeOffset(const CameraTimeOffsetOptions& options)
    : options_(options), sigma_(std::max(options.prior_sigma, 0.0)) {}

void CameraTimeOffset::Sums::add(const Vector& row, double value, double weight) {
  A += (weight * row) * row.transpose();
  b += weight * value * row;
  squares += weight * value * value;
}

CameraTimeOffset::Sums& CameraTimeOffset::Sums::operator+=(const Sums& other) {
  A += other.A;
  b += other.b;
  squares += other.squares;
  return *this;
}

double CameraTimeOffset::Sums::cost(const Vector& state) const {
  return squares - 2.0 * b.dot(state) + state.dot(A * state);
}

double CameraTimeOffset::middle(std::size_t piece) const {
  return (static_cast<int>(piece % (2 * kReach)) - kReach) * period_;
}

CameraTimeOffset::Sums CameraTimeOffset::prior() const {
  Sums sums;
  const double rows = std::max(options_.prior_rows, 1e-3);
  sums.A.diagonal().setConstant(1.0 / (rows * rows));
  sums.A(0, 0) = 1.0 / (options_.prior_sigma * options_.prior_sigma);
  return sums;
}

std::array<CameraTimeOffset::Sums, CameraTimeOffset::kPieces> CameraTimeOffset::total() const {
  std::array<Sums, kPieces> sums;
  sums.fill(prior());
  for (const Block& block : blocks_) {
    for (std::size_t p = 0; p < kPieces; ++p) sums[p] += block.of[p];
  }
  return sums;
}

void CameraTimeOffset::update(const StereoCamera& camera, const std::vector<Track>& tracks,
                              const Eigen::Isometry3d& T_CW,
                              const Eigen::Matrix<double, 6, 1>& velocity, double stamp) {
  if (!estimated()) return;
  View view{stamp, T_CW, {}};
  std::vector<double> flows, disparities;
  for (const Track& t : tracks) {
    if (!t.inlier) continue;
    const Eigen::Vector3d Y = T_CW * t.position;
    if (!(Y.z() > 0.1)) continue;
    const Eigen::Vector2d p = t.left.cast<double>();
    const Eigen::Vector2d at =
        Eigen::Vector2d(p.x() - camera.left.cx, p.y() - camera.left.cy) / (0.5 * camera.left.width);
    view.rows.push_back({t.id, t.position, at, p.y(),
                         t.in_right ? std::optional<double>(t.row_error) : std::nullopt});
    const Eigen::Vector3d Y_dot = velocity.head<3>() + velocity.tail<3>().cross(Y);
    flows.push_back(std::abs((camera.left.projection_jacobian(Y) * Y_dot).x()));
    disparities.push_back(camera.left.fx * camera.baseline / Y.z());
  }
  std::sort(view.rows.begin(), view.rows.end(),
            [](const Row& a, const Row& b) { return a.id < b.id; });
  if (!flows.empty()) {
    const double keep = std::exp(-1.0 / options_.memory);
    flow_ = keep * flow_ + median(flows) / std::max(median(disparities), 1.0);
    frames_ = keep * frames_ + 1.0;
  }
  if (!views_.empty() && period_ > 0.0 && stamp - views_.back().stamp > kLongestGap * period_) {
    views_.clear();
  }
  views_.push_back(std::move(view));
  constexpr std::size_t kViews = 2 * kReach + 1;
  if (views_.size() > kViews) views_.pop_front();
  if (views_.size() < kViews) return;
  std::vector<double> steps;
  for (std::size_t i = 1; i < kViews; ++i) steps.push_back(views_[i].stamp - views_[i - 1].stamp);
  const double step = median(steps);
  if (!(period_ > 0.0) || step > 2.0 * period_ || 2.0 * step < period_) {
    period_ = step;
    blocks_.clear();
    length_ = 1;
  }
  enter(camera);
  estimate();
}

std::vector<double> CameraTimeOffset::shift_to(const View& other,
                                               const StereoCamera& camera) const {
  const View& here = views_[kReach];
  const auto by_pose = [&](const Row& row) {
    return camera.left.project(other.T_CW * row.position).y() -
           camera.left.project(here.T_CW * row.position).y();
  };
  const auto regressor = [&](const Row& row) {
    Vector r;
    r << by_pose(row), phi(row.at);
    return r;
  };
  std::vector<Vector> regressors;
  Rows both;
  auto there = other.rows.begin();
  for (const Row& row : here.rows) {
    regressors.push_back(regressor(row));
    while (there != other.rows.end() && there->id < row.id) ++there;
    if (there == other.rows.end() || there->id != row.id) continue;
    both.emplace_back(regressors.back(), there->row - row.row);
  }
  if (both.size() < 2 * kLeastPoints) return {};
  Vector state = Vector::Unit(0);  // the poses are right
  std::vector<double> spread(both.size());
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < both.size(); ++i) {
      spread[i] = std::abs(both[i].second - both[i].first.dot(state));
    }
    const double noise = std::max(kLeastNoise, 1.4826 * median(spread));
    // The prior is as weak as a point: phi hardly differs from z in a turn.
    Sums sums;
    sums.A.setIdentity();
    sums.b = Vector::Unit(0);
    for (const auto& [row, value] : both) {
      const double error = std::abs(value - row.dot(state)) / noise;
      sums.add(row, value, std::min(1.0, kHuber / std::max(error, 1e-9)) / (noise * noise));
    }
    state = sums.A.ldlt().solve(sums.b);
  }
  std::vector<double> shifts;
  for (const Vector& row : regressors) shifts.push_back(row.dot(state));
  return shifts;
}

std::optional<std::array<CameraTimeOffset::Rows, CameraTimeOffset::kPieces>>
CameraTimeOffset::linearise(const StereoCamera& camera) const {
  const View& here = views_[kReach];
  std::array<std::vector<double>, 2 * kReach + 1> shifts;
  std::array<double, 2 * kReach + 1> times;
  bool any = true;
  for (std::size_t m = 0; m < shifts.size(); ++m) {
    times[m] = views_[m].stamp - here.stamp;
    shifts[m] =
        m == kReach ? std::vector<double>(here.rows.size(), 0.0) : shift_to(views_[m], camera);
    any = any && !shifts[m].empty();
  }
  std::array<Rows, kPieces> rows;
  if (!any) return std::nullopt;
  // Where along its piece each estimate is so far.
  std::array<double, kPieces> along;
  const std::array<Sums, kPieces> sums = total();
  for (std::size_t p = 0; p < kPieces; ++p) {
    const double tau = sums[p].A.ldlt().solve(sums[p].b)[0];
    along[p] = std::clamp((tau - middle(p)) / period_, -kMargin, 1.0 + kMargin);
  }
  double moved = 0.0;
  for (std::size_t i = 0; i < here.rows.size(); ++i) {
    const Row& row = here.rows[i];
    std::array<std::array<double, 2 * kReach + 1>, 2> at;  // by times, by numbers
    for (std::size_t m = 0; m < times.size(); ++m) {
      at[1][m] = shifts[m][i];
      const double t = (static_cast<int>(m) - kReach) * period_;
      std::size_t k = 1;
      while (k + 1 < times.size() && times[k] < t) ++k;
      const double share = (t - times[k - 1]) / (times[k] - times[k - 1]);
      at[0][m] = shifts[k - 1][i] + share * (shifts[k][i] - shifts[k - 1][i]);
    }
    const double both_ways = 0.5 * (at[1][kReach + 1] - at[1][kReach - 1]);
    moved += both_ways * both_ways;
    if (!row.error) continue;
    for (std::size_t p = 0; p < kPieces; ++p) {
      const auto [shift, slope] = curve(at[p / (2 * kReach)], p % (2 * kReach), along[p]);
      Vector regressor;
      regressor << slope / period_, phi(row.at);
      const double here_tau = middle(p) + along[p] * period_;
      rows[p].emplace_back(regressor, *row.error - shift + here_tau * regressor[0]);
    }
  }
  if (!(moved > kLeastMotion * kLeastMotion * static_cast<double>(here.rows.size()))) {
    rows.fill({});
    return rows;
  }
  if (2 * rows[0].size() < here.rows.size() || rows[0].size() < kLeastPoints) return std::nullopt;
  return rows;
}

CameraTimeOffset::Block& CameraTimeOffset::open_block() {
  if (!blocks_.empty() && blocks_.back().frames + blocks_.back().blind < length_) {
    return blocks_.back();
  }
  if (blocks_.size() == kBlocks) {
    if (2.0 * length_ * kBlocks <= options_.memory) {
      for (std::size_t i = 0; i < kBlocks / 2; ++i) {
        Block& kept = blocks_[i];
        kept = blocks_[2 * i];
        const Block& other = blocks_[2 * i + 1];
        for (std::size_t p = 0; p < kPieces; ++p) kept.of[p] += other.of[p];
        kept.frames += other.frames;
        kept.blind += other.blind;
      }
      blocks_.resize(kBlocks / 2);
      length_ *= 2;
    } else {
      blocks_.pop_front();
    }
  }
  return blocks_.emplace_back();
}

void CameraTimeOffset::enter(const StereoCamera& camera) {
  const std::optional<std::array<Rows, kPieces>> linear = linearise(camera);
  if (!linear) {
    ++open_block().blind;
    return;
  }
  const std::array<Rows, kPieces>& rows = *linear;
  if (rows[0].empty()) return;
  // Frames at regular times are the same by times and by numbers.
  bool regular = true;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const double expected = (static_cast<int>(i) - kReach) * period_;
    regular =
        regular && std::abs(views_[i].stamp - views_[kReach].stamp - expected) < kRegular * period_;
  }
  const std::size_t pieces = regular ? kPieces / 2 : kPieces;
  const std::array<Sums, kPieces> before = total();
  std::array<Vector, kPieces> state;
  std::vector<double> spread(rows[0].size());
  const auto spread_of = [&](std::size_t p) {
    for (std::size_t i = 0; i < spread.size(); ++i) {
      spread[i] = std::abs(rows[p][i].second - rows[p][i].first.dot(state[p]));
    }
    return std::max(kLeastNoise, 1.4826 * median(spread));
  };
  const auto weigh = [&](std::size_t p, double noise, Sums& sums) {
    for (const auto& [row, value] : rows[p]) {
      const double error = std::abs(value - row.dot(state[p])) / noise;
      sums.add(row, value,
               options_.trust * std::min(1.0, kHuber / std::max(error, 1e-9)) / (noise * noise));
    }
  };
  // Once by what was known before, and again by what this frame makes of it. All pieces are held
  // against the noise of the one that fits best, or none would fit worse.
  double least = 0.0;
  for (std::size_t p = 0; p < pieces; ++p) {
    state[p] = before[p].A.ldlt().solve(before[p].b);
    Sums with = before[p];
    weigh(p, spread_of(p), with);
    state[p] = with.A.ldlt().solve(with.b);
    const double noise = spread_of(p);
    if (p == 0 || noise < least) least = noise;
  }
  Block& block = open_block();
  for (std::size_t p = 0; p < pieces; ++p) {
    Sums sums;
    weigh(p, least, sums);
    block.of[p] += sums;
    if (regular) block.of[p + pieces] += sums;
  }
  ++block.frames;
}

void CameraTimeOffset::estimate() {
  known_ = false;
  value_ = 0.0;
  sigma_ = options_.prior_sigma;
  int frames = 0, blind = 0;
  for (const Block& block : blocks_) {
    frames += block.frames;
    blind += block.blind;
  }
  const std::size_t n = blocks_.size();
  if (n < kLeastBlocks || frames < blind) return;
  const std::array<Sums, kPieces> sums = total();
  std::array<Vector, kPieces> state;
  std::array<double, kPieces> cost;
  std::optional<std::size_t> best;
  std::array<bool, kPieces> within;
  for (std::size_t p = 0; p < kPieces; ++p) {
    state[p] = sums[p].A.ldlt().solve(sums[p].b);
    cost[p] = sums[p].cost(state[p]);
    const double along = (state[p][0] - middle(p)) / period_;
    const std::size_t m = p % (2 * kReach);
    const double below = m == 0 ? 1.0 : kMargin, above = m == 2 * kReach - 1 ? 1.0 : kMargin;
    within[p] = along > -below && along < 1.0 + above;
    if (within[p] && (!best || cost[p] < cost[*best])) best = p;
  }
  if (!best) return;
  // The jackknife: what the estimate would be without each block.
  std::vector<double> without;
  double mean = 0.0;
  for (const Block& block : blocks_) {
    const Matrix A = sums[*best].A - block.of[*best].A;
    const Vector b = sums[*best].b - block.of[*best].b;
    without.push_back(A.ldlt().solve(b)[0]);
    mean += without.back() / static_cast<double>(n);
  }
  double squares = 0.0, alike = 0.0;  // and what blocks share with the next two (Newey, West 1987)
  for (std::size_t i = 0; i < n; ++i) {
    const auto with = [&](std::size_t lag) {
      return i + lag < n ? (without[i] - mean) * (without[i + lag] - mean) : 0.0;
    };
    squares += with(0);
    alike += 2.0 * (2.0 / 3.0 * with(1) + 1.0 / 3.0 * with(2));
  }
  squares += std::max(0.0, alike);
  const double blocks = static_cast<double>(n);
  const double jackknife = std::sqrt((blocks - 1.0) / blocks * squares) * widening(n);
  const double formal = std::sqrt(sums[*best].A.ldlt().solve(Vector::Unit(0))[0]);
  // Between frames the curve is a guess.
  const double share = state[*best][0] / period_ - std::floor(state[*best][0] / period_);
  const double between = kGuess * period_ * 4.0 * share * (1.0 - share);
  const double sigma = std::hypot(jackknife, formal, between);
  if (!(sigma < 0.5 * options_.prior_sigma)) return;
  // Whether a piece that says otherwise fits worse for certain.
  for (std::size_t p = 0; p < kPieces; ++p) {
    if (!within[p] || std::abs(state[p][0] - state[*best][0]) < 3.0 * sigma) continue;
    double sum = 0.0, sum_squares = 0.0;
    for (const Block& block : blocks_) {
      const double worse = block.of[p].cost(state[p]) - block.of[*best].cost(state[*best]);
      sum += worse;
      sum_squares += worse * worse;
    }
    const double variance =
        std::max(0.0, sum_squares - sum * sum / blocks) * blocks / (blocks - 1.0);
    if (!(sum > 3.0 * widening(n) * std::sqrt(variance))) return;
  }
  known_ = true;
  value_ = state[*best][0];
  sigma_ = sigma;
}

double CameraTimeOffset::depth_error() const {
  return frames_ > 0.0 ? std::abs(value()) * flow_ / frames_ : 0.0;
}

double CameraTimeOffset::depth_sigma() const {
  return frames_ > 0.0 ? std::hypot(value(), sigma()) * flow_ / frames_ : 0.0;
}

bool CameraTimeOffset::out_of_step() const {
  return known_ && depth_error() > options_.max_error && std::abs(value()) > 4.0 * sigma();
}

std::string CameraTimeOffset::reason(double period) const {
  const std::string late = value() > 0.0 ? "late" : "early";
  const double offset = std::abs(value());
  const double frames = period > 0.0 ? std::round(offset / period) : 0.0;
  // Neither a few milliseconds nor an estimate that leaves it open make a shift.
  const double tolerance = std::min(3.0 * sigma() + 0.05 * offset, 0.25 * period);
  if (frames >= 1.0 && std::abs(offset - frames * period) <= tolerance) {
    const std::string n = std::to_string(static_cast<int>(frames));
    return "the right images are " + n + (frames > 1.0 ? " frames " : " frame ") + late +
           ": pair each left image with the right one " + n +
           (value() > 0.0 ? " before" : " after") + " its own";
  }
  return "the right camera is " + std::to_string(std::lround(1e3 * offset)) + " ms " + late;
}

}  // namespace prospect
