// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/anchored_map.h"

#include <octomap/octomap_utils.h>

#include <utility>

#include "engine/maps/planar_error.h"

namespace prospect {
namespace {

EvidenceTable::Model model_of(const OccupancyMapperOptions& options) {
  return {octomap::logodds(options.probability_hit), octomap::logodds(options.probability_miss),
          octomap::logodds(options.probability_min), octomap::logodds(options.probability_max)};
}

}  // namespace

AnchoredMap::AnchoredMap(std::shared_ptr<OccupancyMapper> map, const Pose& start)
    : map_(std::move(map)), table_(model_of(map_->options())) {
  MapAnchor first;
  first.origin = start;
  anchors_.push_back(std::move(first));
  record();
  note(start);
}

AnchoredMap::~AnchoredMap() { map_->record(nullptr, nullptr); }

void AnchoredMap::record() { map_->record(&anchors_.back().evidence, &table_); }

void AnchoredMap::note(const Pose& robot) {
  std::vector<Eigen::Vector2d>& way = anchors_.back().way;
  const Eigen::Vector2d p = robot.position.head<2>();
  if (!p.allFinite() || (!way.empty() && (way.back() - p).norm() < kWayStep)) return;
  way.push_back(p);
}

void AnchoredMap::begin(const Pose& origin, const Eigen::Matrix3d& covariance,
                        std::optional<int> parent, const PlanarMove& jump) {
  MapAnchor next;
  next.id = open().id + 1;
  next.parent = parent.value_or(open().id);
  next.origin = origin;
  next.jump = jump;
  next.covariance = covariance;
  anchors_.push_back(std::move(next));
  record();
  note(origin);
}

void AnchoredMap::begin_apart(const Pose& origin, const Eigen::Matrix3d& covariance) {
  aside_.reset();
  for (std::size_t n = static_cast<std::size_t>(first_); first_ > 0 && n < anchors_.size(); ++n) {
    anchors_[n].evidence = {};
    anchors_[n].way.clear();
  }
  begin(origin, covariance);
  first_ = open().id;
  *map_ = OccupancyMapper(map_->options());
  record();
}

void AnchoredMap::found(int anchor, int parent, const MapAnchor::Found& found) {
  MapAnchor& a = anchors_[static_cast<std::size_t>(anchor)];
  a.parent = parent;
  a.found = found;
}

bool AnchoredMap::is_worth(const std::vector<PlanarMove>& to_W) const {
  for (std::size_t n = 0; n < to_W.size() && n + 1 < anchors_.size(); ++n) {
    const MapAnchor& a = anchors_[n];
    const PlanarMove move = to_W[n] * a.to_W.inverse();
    const Eigen::Vector2d at = a.to_W(Eigen::Vector2d(a.origin.position.head<2>()));
    if (move.farthest(at, kReach) > kLeastMove) return true;
  }
  return false;
}

bool AnchoredMap::follow(std::vector<PlanarMove> to_W) {
  if (aside_) return false;
  aside_ = std::make_unique<OccupancyMapper>(map_->options());
  goes_to_ = std::move(to_W);
  next_ = 0;
  return true;
}

std::optional<AnchoredMap::Moved> AnchoredMap::go_on(int bricks,
                                                     const std::vector<Eigen::Matrix3d>& sure) {
  if (!aside_) return std::nullopt;
  const double r = map_->options().resolution;
  const auto place_of = [this](std::size_t n) {
    return n < goes_to_.size() && n + 1 < anchors_.size() ? goes_to_[n] : anchors_[n].to_W;
  };
  while (next_ + 1 < anchors_.size()) {
    if (bricks <= 0) break;
    const MapEvidence& evidence = anchors_[next_].evidence;
    bricks -= static_cast<int>(evidence.bricks().size());
    aside_->enter(evidence.moved(place_of(next_), r, table_), table_);
    ++next_;
  }
  if (next_ + 1 < anchors_.size() || bricks <= 0) {
    aside_->voxels();  // what has come is brought to the copies that are given out
    return std::nullopt;
  }
  aside_->enter(open().evidence, table_);
  Moved moved;
  std::vector<PlaceMoves::Known> known;
  for (std::size_t n = 0; n < anchors_.size(); ++n) {
    MapAnchor& a = anchors_[n];
    const PlanarMove now = place_of(n);
    moved.anchors.push_back(now * a.to_W.inverse());
    const MapAnchor& at = anchors_[sure.empty() ? n : sure.size() - 1];
    const Eigen::Vector2d from = at.origin.position.head<2>();
    for (const Eigen::Vector2d& p : a.way) {
      // Nobody knows places of a map that it was apart from.
      if (static_cast<int>(n) < first_) continue;
      known.push_back({a.to_W(p), moved.anchors.back(), -1.0});
      if (n >= sure.size()) continue;
      known.back().variance = place_variance(sure[n], now(p) - from);
    }
    a.to_W = now;
  }
  first_ = 0;
  *map_ = std::move(*aside_);
  aside_.reset();
  record();
  moved.places = std::make_shared<const PlaceMoves>(std::move(known));
  return moved;
}

bool AnchoredMap::merge(int from, int to) {
  if (aside_) return false;
  MapAnchor& a = anchors_[static_cast<std::size_t>(from)];
  MapAnchor& b = anchors_[static_cast<std::size_t>(to)];
  const double r = map_->options().resolution;
  MapEvidence earlier = std::move(a.evidence);
  a.evidence = {};
  earlier = earlier.moved(b.to_W.inverse() * a.to_W, r, table_);
  if (from < to) {
    earlier.append(b.evidence, table_);
    b.evidence = std::move(earlier);
  } else {
    b.evidence.append(earlier, table_);
  }
  return true;
}

std::size_t AnchoredMap::bytes() const {
  std::size_t sum = 0;
  for (const MapAnchor& a : anchors_) {
    sum += sizeof a + a.way.capacity() * sizeof(Eigen::Vector2d) + a.evidence.bytes();
  }
  return sum;
}

}  // namespace prospect
