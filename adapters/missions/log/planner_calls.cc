// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/planner_calls.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <unordered_map>
#include <utility>

#include "adapters/formats/files/content_hash.h"
#include "adapters/formats/files/input_error.h"
#include "engine/maps/correction.h"

namespace prospect {
namespace {

constexpr std::size_t kLandmarkValues = 19;
constexpr std::int64_t kMostPlaces = std::int64_t{1} << 30;
constexpr std::int32_t kFarthestPlace = std::int32_t{1} << 29;

using LandmarkValues = std::array<double, kLandmarkValues>;

LandmarkValues values_of(const Landmark& l) {
  LandmarkValues v;
  double* at = std::copy_n(l.position.data(), 3, v.data());
  at = std::copy_n(l.covariance.data(), 9, at);
  at = std::copy_n(l.creation_direction.data(), 3, at);
  std::copy_n(
      std::initializer_list<double>{l.creation_range, l.survival, l.multiplicity, l.per_cell}
          .begin(),
      4, at);
  return v;
}

Landmark landmark_of(std::uint64_t id, const double* v) {
  Landmark l;
  l.id = id;
  std::copy_n(v, 3, l.position.data());
  std::copy_n(v + 3, 9, l.covariance.data());
  std::copy_n(v + 12, 3, l.creation_direction.data());
  l.creation_range = v[15];
  l.survival = v[16];
  l.multiplicity = v[17];
  l.per_cell = v[18];
  return l;
}

bool same_bits(const Landmark& a, const Landmark& b) {
  const LandmarkValues va = values_of(a), vb = values_of(b);
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): whether they are the same bits
  return a.id == b.id && std::memcmp(va.data(), vb.data(), sizeof va) == 0;
}

/// Fills in runs and values of the places at which `now` differs; all of a whole map.
template <typename Differs, typename ValueAt>
void add_changes(MapChanges& changes, std::size_t size, const Differs& differs,
                 const ValueAt& value_at) {
  for (std::size_t n = 0; n < size; ++n) {
    if (!changes.whole && !differs(n)) continue;
    if (changes.runs.empty() || changes.runs[changes.runs.size() - 2] + changes.runs.back() != n) {
      changes.runs.insert(changes.runs.end(), {static_cast<std::uint32_t>(n), 0});
    }
    ++changes.runs.back();
    changes.values.push_back(value_at(n));
  }
  changes.changed = changes.whole || !changes.runs.empty();
}

MapChanges changes_of(const VoxelGrid* before, const VoxelGrid& now) {
  MapChanges changes;
  if (before == &now) return changes;
  const GridFrame& f = now.frame();
  changes.resolution = f.resolution;
  changes.frame = {f.i0, f.j0, f.width, f.height, now.k0(), now.depth()};
  changes.whole =
      !before || before->frame() != f || before->k0() != now.k0() || before->depth() != now.depth();
  const std::vector<CellState>& data = now.data();
  add_changes(
      changes, data.size(), [&](std::size_t n) { return before->data()[n] != data[n]; },
      [&](std::size_t n) { return static_cast<std::uint8_t>(data[n]); });
  return changes;
}

std::uint8_t ground_value(const GroundMap& map, std::size_t n) {
  return static_cast<std::uint8_t>(2 * static_cast<int>(map.cells().data[n]) +
                                   (map.sights().data[n] != 0));
}

MapChanges changes_of(const GroundMap* before, const GroundMap& now) {
  MapChanges changes;
  if (before == &now) return changes;
  const GridFrame& f = now.frame();
  changes.resolution = f.resolution;
  changes.frame = {f.i0, f.j0, f.width, f.height, 0, 1};
  changes.whole = !before || before->frame() != f;
  add_changes(
      changes, static_cast<std::size_t>(f.size()),
      [&](std::size_t n) { return ground_value(*before, n) != ground_value(now, n); },
      [&](std::size_t n) { return ground_value(now, n); });
  return changes;
}

constexpr std::size_t kOfMove = 6, kOfMover = 6;  // numbers

/// Those of corrections since that one; false: none.
bool add_moves(PlannerCall& call, const MapFrame& frame, int since) {
  for (const MovedPlaces& moved : frame.moved_places) {
    if (moved.taken <= since) continue;
    const std::vector<PlaceMoves::Known>& known = moved.how->known();
    call.area.push_back(static_cast<double>(known.size()));
    for (const PlaceMoves::Known& k : known) {
      call.area.insert(call.area.end(), {k.before.x(), k.before.y(), k.move.shift.x(),
                                         k.move.shift.y(), k.move.yaw, k.variance});
    }
  }
  return !call.area.empty();
}

void add_landmarks(PlannerCall& call, const LandmarkMap* before, const LandmarkMap& now) {
  const OdometryNoise noise = now.odometry_noise.value_or(OdometryNoise());
  call.landmark_map = {now.feature_density,
                       now.image_cell,
                       now.odometry_noise ? 1.0 : 0.0,
                       noise.position_per_metre,
                       noise.position_per_radian,
                       noise.yaw_per_metre,
                       noise.yaw_per_radian,
                       noise.reference_count,
                       noise.floor_count,
                       noise.scale};
  std::unordered_map<std::uint64_t, std::uint32_t> places;
  if (before) {
    for (std::uint32_t n = 0; n < before->landmarks.size(); ++n) {
      places.emplace(before->landmarks[n].id, n);
    }
  }
  std::vector<std::uint32_t>& runs = call.landmark_runs;
  for (const Landmark& landmark : now.landmarks) {
    const auto place = places.find(landmark.id);
    const bool kept =
        place != places.end() && same_bits(before->landmarks[place->second], landmark);
    if (kept) {
      const bool goes_on = !runs.empty() && runs.back() == 0 &&
                           runs[runs.size() - 3] + runs[runs.size() - 2] == place->second;
      if (!goes_on) runs.insert(runs.end(), {place->second, 0, 0});
      ++runs[runs.size() - 2];
      continue;
    }
    if (runs.empty()) runs.insert(runs.end(), {0, 0, 0});
    ++runs.back();
    call.landmark_ids.push_back(landmark.id);
    const LandmarkValues values = values_of(landmark);
    call.landmark_values.insert(call.landmark_values.end(), values.begin(), values.end());
  }
}

[[noreturn]] void damaged(const std::string& said, const char* what) {
  fail(said, std::string(what) + "; expected what the calls before it lead to");
}

/// Hands each changed place and its value to `set`. Throws InputError.
template <typename Set>
void take_changes(const MapChanges& changes, std::size_t size, std::uint8_t most,
                  const std::string& said, const Set& set) {
  if (changes.runs.size() % 2 != 0) damaged(said, "half a run of map changes");
  std::size_t value = 0;
  for (std::size_t r = 0; r < changes.runs.size(); r += 2) {
    const std::size_t first = changes.runs[r], count = changes.runs[r + 1];
    if (first > size || count > size - first || count > changes.values.size() - value) {
      damaged(said, "map changes outside the map");
    }
    for (std::size_t n = first; n < first + count; ++n, ++value) {
      if (changes.values[value] > most) damaged(said, "no state of a cell");
      set(n, changes.values[value]);
    }
  }
}

/// Of a whole map; throws InputError for one that no message can tell.
GridFrame frame_of(const MapChanges& changes, const std::string& said) {
  const auto& [i0, j0, width, height, k0, depth] = changes.frame;
  const auto near = [](std::int32_t place) {
    return place >= -kFarthestPlace && place <= kFarthestPlace;
  };
  const bool sound =
      changes.resolution > 0.0 && near(i0) && near(j0) && near(k0) && width >= 1 && height >= 1 &&
      depth >= 1 && std::int64_t{width} * height <= kMostPlaces &&
      std::int64_t{width} * height * depth <= kMostPlaces &&
      static_cast<std::size_t>(std::int64_t{width} * height * depth) == changes.values.size();
  if (!sound) damaged(said, "no frame of a map");
  return {changes.resolution, i0, j0, width, height};
}

OdometryNoise noise_of(const std::array<double, 10>& v) {
  return {v[3], v[4], v[5], v[6], v[7], v[8], v[9]};
}

}  // namespace

std::uint64_t plan_hash(const Plan& plan) {
  ContentHash hash;
  const auto twist = [&](const Twist& t) {
    for (const double v : {t.linear.x(), t.linear.y(), t.linear.z(), t.yaw_rate}) hash.add(v);
  };
  for (const auto* vectors : {&plan.states, &plan.inputs}) {
    hash.add(std::uint64_t{vectors->size()});
    for (const Eigen::VectorXd& v : *vectors) {
      for (const double value : v) hash.add(value);
    }
  }
  for (const auto* twists : {&plan.commands, &plan.tail}) {
    hash.add(std::uint64_t{twists->size()});
    for (const Twist& t : *twists) twist(t);
  }
  hash.add(static_cast<std::uint64_t>(plan.committed));
  return hash.value();
}

std::optional<PlannerCall> PlannerCallWriter::map_frame(const Belief& belief) {
  const Pose before = origin_of(map_frame_.get()), now = origin_of(belief.map_frame.get());
  const int taken = map_frame_ ? map_frame_->taken : 0;
  map_frame_ = belief.map_frame;
  PlannerCall call;
  const bool moves = map_frame_ && add_moves(call, *map_frame_, taken);
  if (!moves && before.position == now.position && before.yaw == now.yaw) return std::nullopt;
  call.sequence = sequence_++;
  call.kind = PlannerCall::kMapFrame;
  call.pose = {now.position.x(), now.position.y(), now.position.z(), now.yaw};
  return call;
}

PlannerCall PlannerCallWriter::prepare(const Belief& belief) {
  return belief_call(PlannerCall::kPrepare, belief);
}

PlannerCall PlannerCallWriter::plan(const Belief& belief) {
  return belief_call(PlannerCall::kPlan, belief);
}

PlannerCall PlannerCallWriter::planned(const Plan& plan) {
  PlannerCall call;
  call.sequence = sequence_++;
  call.kind = PlannerCall::kPlanned;
  call.plan_hash = plan_hash(plan);
  call.cost = plan.explanation.cost;
  call.cost_evaluations = plan.counters.cost_evaluations;
  call.gradient_evaluations = plan.counters.gradient_evaluations;
  return call;
}

PlannerCall PlannerCallWriter::task(const Task& task) {
  PlannerCall call;
  call.sequence = sequence_++;
  call.kind = PlannerCall::kTask;
  call.task = static_cast<std::uint8_t>(task.kind);
  call.has_area = task.area.has_value();
  if (task.area) {
    for (const Eigen::Vector2d& corner : *task.area) {
      call.area.insert(call.area.end(), {corner.x(), corner.y()});
    }
  }
  call.has_goal_yaw = task.goal.yaw.has_value();
  call.goal = {task.goal.position.x(), task.goal.position.y(), task.goal.yaw.value_or(0.0),
               task.goal.position_tolerance, task.goal.yaw_tolerance};
  return call;
}

PlannerCall PlannerCallWriter::belief_call(PlannerCall::Kind kind, const Belief& b) {
  PlannerCall call;
  call.sequence = sequence_++;
  call.kind = kind;
  call.stamps = {b.stamp, b.stamps.pose, b.stamps.map, b.stamps.landmarks, b.stamps.ranges};
  const Eigen::Vector3d& p = b.pose.position;
  call.pose = {p.x(), p.y(), p.z(), b.pose.yaw};
  std::copy_n(b.covariance.data(), 16, call.covariance.data());
  const auto numbers = [](const Twist& t) {
    return std::array{t.linear.x(), t.linear.y(), t.linear.z(), t.yaw_rate};
  };
  call.twist = numbers(b.twist);
  call.commanded = b.command.has_value();
  if (b.command) call.command = numbers(*b.command);
  call.localization = static_cast<std::uint8_t>(b.localization);
  call.source = static_cast<std::uint8_t>(b.localization_source);
  call.tracked = b.tracked_features;
  if (b.movers) {
    call.area.push_back(b.movers->stamp);
    for (const Mover& m : b.movers->all) {
      call.area.insert(call.area.end(), {m.position.x(), m.position.y(), m.velocity.x(),
                                         m.velocity.y(), m.radius, m.spread});
    }
  }
  if (b.voxels) {
    call.voxels = changes_of(voxels_.get(), *b.voxels);
    voxels_ = b.voxels;
  }
  if (b.ground) {
    call.ground = changes_of(ground_.get(), *b.ground);
    ground_ = b.ground;
  }
  call.has_landmarks = b.landmarks != nullptr;
  call.landmarks_changed = b.landmarks && b.landmarks != landmarks_;
  if (call.landmarks_changed) {
    add_landmarks(call, landmarks_.get(), *b.landmarks);
    landmarks_ = b.landmarks;
  }
  return call;
}

void PlannerCallReader::take_map_frame(const PlannerCall& call, const std::string& said) {
  MapFrame frame;
  frame.origin = {{call.pose[0], call.pose[1], call.pose[2]}, call.pose[3]};
  frame.taken = map_frame_ ? map_frame_->taken + 1 : 1;
  const std::vector<double>& told = call.area;
  for (std::size_t n = 0; n < told.size();) {
    const double count = told[n++];
    const std::size_t most = (told.size() - n) / kOfMove;
    if (!(count >= 0.0 && count <= static_cast<double>(most))) {
      damaged(said, "moves of places that are not there");
    }
    std::vector<PlaceMoves::Known> known;
    for (auto left = static_cast<std::size_t>(count); left > 0; --left, n += kOfMove) {
      known.push_back(
          {{told[n], told[n + 1]}, {{told[n + 2], told[n + 3]}, told[n + 4]}, told[n + 5]});
    }
    frame.moved_places.push_back(
        {frame.taken, std::make_shared<const PlaceMoves>(std::move(known))});
  }
  map_frame_ = std::make_shared<const MapFrame>(std::move(frame));
}

Belief PlannerCallReader::belief(const PlannerCall& call, const std::string& said) {
  Belief b;
  b.stamp = call.stamps[0];
  b.stamps = {call.stamps[1], call.stamps[2], call.stamps[3], call.stamps[4]};
  b.pose = {{call.pose[0], call.pose[1], call.pose[2]}, call.pose[3]};
  std::copy_n(call.covariance.data(), 16, b.covariance.data());
  const auto twist = [](const std::array<double, 4>& v) { return Twist{{v[0], v[1], v[2]}, v[3]}; };
  b.twist = twist(call.twist);
  if (call.commanded) b.command = twist(call.command);
  if (call.localization > static_cast<int>(Localization::kLost) ||
      call.source > static_cast<int>(LocalizationSource::kExternal)) {
    damaged(said, "no localization");
  }
  b.localization = static_cast<Localization>(call.localization);
  b.localization_source = static_cast<LocalizationSource>(call.source);
  b.tracked_features = call.tracked;
  b.map_frame = map_frame_;
  if (!call.area.empty()) {
    if (call.area.size() % kOfMover != 1) damaged(said, "movers that are cut off");
    auto movers = std::make_shared<Movers>();
    movers->stamp = call.area[0];
    for (std::size_t n = 1; n < call.area.size(); n += kOfMover) {
      const double* m = &call.area[n];
      movers->all.push_back({{m[0], m[1]}, {m[2], m[3]}, m[4], m[5]});
    }
    b.movers = std::move(movers);
  }

  if (call.voxels.changed) {
    if (!voxels_ && !call.voxels.whole) damaged(said, "changes of no voxels");
    const GridFrame frame = call.voxels.whole ? frame_of(call.voxels, said) : voxels_->frame();
    std::vector<CellState> data =
        call.voxels.whole ? std::vector<CellState>(call.voxels.values.size(), CellState::kUnknown)
                          : voxels_->data();
    take_changes(call.voxels, data.size(), 2, said, [&](std::size_t n, std::uint8_t value) {
      data[n] = static_cast<CellState>(value);
    });
    const int k0 = call.voxels.whole ? call.voxels.frame[4] : voxels_->k0();
    const int depth = call.voxels.whole ? call.voxels.frame[5] : voxels_->depth();
    voxels_ = std::make_shared<const VoxelGrid>(frame, k0, depth, std::move(data));
  }
  if (call.ground.changed) {
    if (!ground_ && !call.ground.whole) damaged(said, "changes of no ground map");
    auto ground = call.ground.whole ? std::make_shared<GroundMap>(frame_of(call.ground, said))
                                    : std::make_shared<GroundMap>(*ground_);
    const GridFrame frame = ground->frame();  // of whole tiles, as that of the map that was told
    if (call.ground.whole && static_cast<std::size_t>(frame.size()) != call.ground.values.size()) {
      damaged(said, "no frame of a ground map");
    }
    take_changes(call.ground, static_cast<std::size_t>(frame.size()), 5, said,
                 [&](std::size_t n, std::uint8_t value) {
                   ground->set(frame.at(static_cast<int>(n)), static_cast<CellState>(value / 2),
                               value % 2 != 0);
                 });
    ground_ = std::move(ground);
  }
  if (call.landmarks_changed) {
    auto map = std::make_shared<LandmarkMap>();
    map->feature_density = call.landmark_map[0];
    map->image_cell = call.landmark_map[1];
    if (call.landmark_map[2] != 0.0) map->odometry_noise = noise_of(call.landmark_map);
    const std::size_t before = landmarks_ ? landmarks_->landmarks.size() : 0;
    if (call.landmark_runs.size() % 3 != 0 ||
        call.landmark_values.size() != kLandmarkValues * call.landmark_ids.size()) {
      damaged(said, "landmarks that are cut off");
    }
    std::size_t next = 0, left = before;
    for (std::size_t r = 0; r < call.landmark_runs.size(); r += 3) {
      const std::size_t first = call.landmark_runs[r], kept = call.landmark_runs[r + 1],
                        made = call.landmark_runs[r + 2];
      if (first > before || kept > before - first || made > call.landmark_ids.size() - next) {
        damaged(said, "landmarks that are not there");
      }
      if (kept > left) damaged(said, "landmarks more than once");
      left -= kept;
      for (std::size_t n = first; n < first + kept; ++n) {
        map->landmarks.push_back(landmarks_->landmarks[n]);
      }
      for (std::size_t n = next; n < next + made; ++n) {
        map->landmarks.push_back(
            landmark_of(call.landmark_ids[n], &call.landmark_values[kLandmarkValues * n]));
      }
      next += made;
    }
    landmarks_ = std::move(map);
  }
  if (!octree_ && voxels_) {
    octree_ = std::make_shared<const octomap::OcTree>(voxels_->resolution());
  }
  b.octree = octree_;
  b.voxels = voxels_;
  b.ground = ground_;
  if (call.has_landmarks) b.landmarks = landmarks_;
  return b;
}

Task task_of(const PlannerCall& call, const std::string& said) {
  if (call.kind != PlannerCall::kTask || call.task > static_cast<int>(TaskKind::kHold) ||
      call.area.size() % 2 != 0) {
    damaged(said, "no task");
  }
  Task task;
  task.kind = static_cast<TaskKind>(call.task);
  if (call.has_area) {
    task.area.emplace();
    for (std::size_t n = 0; n < call.area.size(); n += 2) {
      task.area->emplace_back(call.area[n], call.area[n + 1]);
    }
  }
  task.goal.position = {call.goal[0], call.goal[1]};
  if (call.has_goal_yaw) task.goal.yaw = call.goal[2];
  task.goal.position_tolerance = call.goal[3];
  task.goal.yaw_tolerance = call.goal[4];
  return task;
}

}  // namespace prospect
