// SPDX-License-Identifier: Apache-2.0
#include "engine/features/feature_visibility_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "engine/features/landmark_selection.h"
#include "engine/features/unseen_features.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr double kWorthARay = 0.02;  // expected features below which occlusion is not asked for
constexpr double kUpdatesPerMetre = 1.0;  // by which a block's turn is deferred, a metre away

}  // namespace

FeatureVisibilityMap::FeatureVisibilityMap(const FeatureVisibilityMapOptions& options,
                                           const RobotDescription& robot,
                                           const VisibilityParameters& visibility)
    : options_(options),
      camera_(robot.stereo),
      mount_(robot.stereo_mount),
      visibility_(visibility) {
  constexpr const char* kOwner = "feature visibility_map";
  check_positive(kOwner, "block", options.block);
  check_parameter(options.blocks_per_update >= 1, kOwner, "blocks_per_update",
                  options.blocks_per_update, "at least 1");
  check_parameter(options.max_landmarks >= 1, kOwner, "max_landmarks", options.max_landmarks,
                  "at least 1");
  check_positive(kOwner, "prior_range", options.prior_range);
  check_not_negative(kOwner, "attenuation", options.attenuation);
}

void FeatureVisibilityMap::update(const Belief& belief, double density, const LocalTexture* texture,
                                  WorkerThreads* workers, const PausePoint& pause) {
  ++updates_;
  const GroundMap& ground = *belief.ground;
  const GridFrame& fine = ground.frame();
  const int side = std::max(1, static_cast<int>(std::lround(options_.block / fine.resolution)));
  side_ = side;
  const GridFrame frame = frame_of_blocks(fine, side);
  if (!(frame == blocks_.frame)) {
    Grid<Block> wider(frame, Block{}, pause);
    for (int k = 0; k < blocks_.frame.size(); ++k) {
      if (k % 1024 == 0) pause();
      const Cell b = blocks_.frame.at(k);
      if (frame.resolution == blocks_.frame.resolution && frame.contains(b)) {
        wider[b] = blocks_.data[static_cast<std::size_t>(k)];
      }
    }
    blocks_ = std::move(wider);
  }

  // Whose turn it is, and where in its block.
  struct Turn {
    int block;
    double due;
  };
  std::vector<Turn> turns;
  const Eigen::Vector2d here = belief.pose.position.head<2>();
  const GridFrame window = intersection(
      frame, frame_around(frame.cell(here.x(), here.y()), options_.prior_range, frame.resolution));
  for (int n = 0; n < window.size(); ++n) {
    pause();
    const Cell b = window.at(n);
    const int k = frame.index(b);
    std::optional<Cell> middle;
    int least = std::numeric_limits<int>::max();
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const int di = 2 * i - side + 1, dj = 2 * j - side + 1;
        const Cell c{b.i * side + i, b.j * side + j};
        if (di * di + dj * dj >= least || ground.state(c) != CellState::kFree) continue;
        least = di * di + dj * dj;
        middle = c;
      }
    }
    if (!middle) continue;
    Block& block = blocks_.data[static_cast<std::size_t>(k)];
    block.middle = *middle;
    const double wait = kUpdatesPerMetre * (frame.center(b) - here).norm();
    turns.push_back({k, (block.counted < 0 ? -1e9 : static_cast<double>(block.counted)) + wait});
  }
  const auto first = [](const Turn& a, const Turn& b) {
    return a.due != b.due ? a.due < b.due : a.block < b.block;
  };
  if (turns.size() > static_cast<std::size_t>(options_.blocks_per_update)) {
    std::nth_element(turns.begin(), turns.begin() + options_.blocks_per_update, turns.end(), first);
    turns.resize(static_cast<std::size_t>(options_.blocks_per_update));
  }
  if (turns.empty()) return;

  UnseenFeatureOptions unseen;
  unseen.density = density;
  unseen.range = options_.prior_range;
  unseen.height = belief.pose.position.z() + mount_.T_BC.translation().z();
  unseen.max_blocks = options_.max_landmarks / 4;
  unseen.image_cell = belief.landmarks->image_cell;
  std::vector<Landmark> landmarks = unseen_features(ground, belief.pose, unseen, texture, pause);
  const double farthest = std::numbers::sqrt2 * options_.prior_range;  // of a block in the window
  const std::vector<Landmark> mapped = select_landmarks(
      *belief.landmarks, belief.pose, farthest,
      options_.max_landmarks - static_cast<int>(landmarks.size()), visibility_, pause);
  landmarks.insert(landmarks.end(), mapped.begin(), mapped.end());
  const VisibilityPrediction prediction(landmarks, camera_, mount_, nullptr, visibility_);

  const double trim = 1.5 * belief.voxels->resolution();
  const auto count = [&](int n) {
    Eigen::MatrixXd visible(static_cast<Eigen::Index>(landmarks.size()), kHeadings);
    Block& block = blocks_.data[static_cast<std::size_t>(turns[static_cast<std::size_t>(n)].block)];
    block.counted = updates_;
    block.counts.fill(0.0F);
    Pose pose = belief.pose;
    pose.position.head<2>() = fine.center(block.middle);
    for (int k = 0; k < kHeadings; ++k) {
      pose.yaw = 2.0 * std::numbers::pi * k / kHeadings;
      visible.col(k) = prediction.probabilities(pose);
    }
    std::vector<Eigen::Vector3d> points;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const double best = visible.row(static_cast<Eigen::Index>(i)).maxCoeff();
      if (!(landmarks[i].multiplicity * best > kWorthARay)) continue;
      points.push_back(landmarks[i].position);
      which.push_back(i);
    }
    std::vector<VoxelGrid::Ray> rays(points.size());
    Eigen::Vector3d eye = prediction.sensor_position(pose);
    eye.head<2>() = pose.position.head<2>();  // of no heading in particular
    belief.voxels->cast_many(eye, points.data(), static_cast<int>(points.size()), trim,
                             rays.data());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (rays[i].blocked) continue;
      const double in_view = landmarks[which[i]].multiplicity *
                             std::exp(-options_.attenuation * rays[i].unknown_length);
      for (int k = 0; k < kHeadings; ++k) {
        block.counts[static_cast<std::size_t>(k)] +=
            static_cast<float>(in_view * visible(static_cast<Eigen::Index>(which[i]), k));
      }
    }
  };
  WorkerThreads alone(1);
  // One for each thread at a time: in between it may pause.
  WorkerThreads& threads = workers ? *workers : alone;
  for (int first = 0; first < static_cast<int>(turns.size()); first += threads.size()) {
    pause();
    const int portion = std::min(threads.size(), static_cast<int>(turns.size()) - first);
    threads.run(portion, [&](int k) { count(first + k); });
  }
}

double FeatureVisibilityMap::count(Cell c, double yaw) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (blocks_.frame.size() == 0 || !std::isfinite(yaw)) return kInfinity;
  const Cell b{floor_divide(c.i, side_), floor_divide(c.j, side_)};
  if (!blocks_.frame.contains(b) || blocks_[b].counted < 0) return kInfinity;
  const double turn = yaw / (2.0 * std::numbers::pi);
  const double at = (turn - std::floor(turn)) * kHeadings;
  const auto low = static_cast<std::size_t>(std::min(static_cast<int>(at), kHeadings - 1));
  const double share = at - static_cast<double>(low);
  const auto& counts = blocks_[b].counts;
  return (1.0 - share) * static_cast<double>(counts[low]) +
         share * static_cast<double>(counts[(low + 1) % kHeadings]);
}

}  // namespace prospect
