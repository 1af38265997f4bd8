// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/problem_specification.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/maps/body_clearance.h"
#include "engine/terms/builtin_terms.h"

namespace prospect {
namespace {

void require(bool present, const char* what) {
  if (!present) throw std::invalid_argument(std::string("problem: no ") + what + "; expected one");
}

/// An axis-aligned box in W [m].
struct Box {
  Eigen::Vector3d low, high;

  void include(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
};

/// Where rays of a table can run: between its nodes and those of its points that are within reach.
Box rays(const SensorLattice& lattice, const OcclusionTable::Options& options,
         const std::vector<Eigen::Vector3d>& points) {
  const Eigen::Vector3d last(lattice.nx - 1, lattice.ny - 1, lattice.nz - 1);
  const Box nodes{lattice.origin, lattice.origin + lattice.spacing * last};
  const Eigen::Vector3d farthest_low = nodes.low.array() - options.max_range;
  const Eigen::Vector3d farthest_high = nodes.high.array() + options.max_range;
  Box box = nodes;
  for (const Eigen::Vector3d& p : points) {
    box.low = box.low.cwiseMin(p.cwiseMax(farthest_low));
    box.high = box.high.cwiseMax(p.cwiseMin(farthest_high));
  }
  return box;
}

/// The part of the range [first, first + count) that [low, high] [m] touches, with a margin for
/// rounding; a single entry where they do not meet.
std::pair<int, int> cut(int first, int count, double low, double high, double resolution) {
  constexpr double kMargin = 2.0;  // [voxels]
  const double from = std::floor(low / resolution) - kMargin;
  const double to = std::floor(high / resolution) + kMargin + 1.0;
  const double end = static_cast<double>(first) + count;
  const auto begin = static_cast<int>(std::clamp<double>(from, first, end - 1.0));
  return {begin, static_cast<int>(std::clamp<double>(to, begin + 1.0, end)) - begin};
}

GridFrame cut(const GridFrame& frame, const Box& box) {
  GridFrame part = frame;
  std::tie(part.i0, part.width) =
      cut(frame.i0, frame.width, box.low.x(), box.high.x(), frame.resolution);
  std::tie(part.j0, part.height) =
      cut(frame.j0, frame.height, box.low.y(), box.high.y(), frame.resolution);
  return part;
}

/// What a depth sensor's lines of sight are made from.
struct TargetRays {
  DepthSensor sensor;
  SensorLattice lattice;
  std::vector<Eigen::Vector3d> targets;  // at the sensor's height
};

std::vector<TargetRays> target_rays(const ProblemSpecification& s) {
  std::vector<TargetRays> all;
  const double height = s.robot.depth_mount.T_BC.translation().z();
  for (const DepthSensor& sensor : s.robot.depth_sensors()) {
    all.push_back({sensor, all.empty() ? s.target_lattice : s.more_target_lattices[all.size() - 1],
                   s.targets.positions(sensor.mount.T_BC.translation().z() - height)});
  }
  return all;
}

}  // namespace

std::vector<Eigen::Vector3d> positions(const std::vector<Landmark>& landmarks) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(landmarks.size());
  for (const Landmark& l : landmarks) points.push_back(l.position);
  return points;
}

void update_clearance(const ProblemSpecification& specification, ClearanceEvaluators& evaluators,
                      const PausePoint& pause) {
  require(specification.voxels != nullptr, "voxels");
  require(specification.ground != nullptr, "ground map");
  ClearanceField::Options options = specification.clearance_field;
  options.zones = specification.zones;
  options.obstacles = ClearanceField::Obstacles::kOccupied;
  evaluators.occupied = std::make_shared<const ClearanceField>(
      specification.clearance_center, *specification.voxels, *specification.ground, options,
      evaluators.occupied.get(), pause);
  evaluators.body =
      evaluators.body != nullptr
          ? std::make_shared<const BodyClearance>(evaluators.occupied, *evaluators.body)
          : std::make_shared<const BodyClearance>(evaluators.occupied, specification.robot.shape);
  if (specification.unknown == UnknownPolicy::kFree) {
    evaluators.known = nullptr;
    evaluators.known_body = nullptr;
    return;
  }
  options.obstacles = ClearanceField::Obstacles::kOccupiedAndUnknown;
  evaluators.known = std::make_shared<const ClearanceField>(
      specification.clearance_center, *specification.voxels, *specification.ground, options,
      evaluators.known.get(), pause);
  evaluators.known_body = std::make_shared<const BodyClearance>(evaluators.known, *evaluators.body);
}

void update_views(const ProblemSpecification& specification, CachedEvaluators& evaluators,
                  OcclusionTable::Clock::time_point take_over_until) {
  require(specification.robot.model != nullptr, "motion model");
  require(specification.voxels != nullptr, "voxels");
  evaluators.landmark_table = std::make_shared<const OcclusionTable>(
      specification.landmark_lattice, positions(specification.landmarks), specification.voxels,
      specification.landmark_occlusion, evaluators.landmark_table.get(), take_over_until);
  evaluators.prediction = std::make_shared<const VisibilityPrediction>(
      specification.landmarks, specification.robot.stereo, specification.robot.stereo_mount,
      evaluators.landmark_table, specification.visibility);
  require(specification.more_target_lattices.size() == specification.robot.more_depth.size(),
          "lattice of each depth sensor");
  std::vector<ExplorationGain::Sight> sights;
  evaluators.target_tables.resize(1 + specification.robot.more_depth.size());
  for (const TargetRays& of : target_rays(specification)) {
    std::shared_ptr<const OcclusionTable>& table = evaluators.target_tables[sights.size()];
    table = std::make_shared<const OcclusionTable>(of.lattice, of.targets, specification.voxels,
                                                   specification.target_occlusion, table.get(),
                                                   take_over_until);
    sights.push_back({of.sensor, table});
  }
  evaluators.gain = std::make_shared<const ExplorationGain>(
      specification.targets, std::move(sights), specification.gain,
      specification.robot.model->pose(specification.x0));
  evaluators.visible_features = std::make_shared<const VisibleFeatures>(
      evaluators.prediction, specification.features,
      specification.features.rho > 0.0 ? evaluators.gain : nullptr);
}

void update_added_terms(const ProblemSpecification& specification, CachedEvaluators& evaluators) {
  evaluators.added_terms.clear();
  for (const TermUse& use : specification.added_terms) {
    evaluators.added_terms.push_back(make_term(use, {specification, evaluators}));
  }
}

std::shared_ptr<const Problem> assemble_problem(const ProblemSpecification& specification,
                                                CachedEvaluators& evaluators) {
  require(specification.robot.model != nullptr, "motion model");
  require(specification.cost_to_go != nullptr, "cost-to-go");
  require(evaluators.occupied && evaluators.gain && evaluators.visible_features &&
              evaluators.body && evaluators.added_terms.size() == specification.added_terms.size(),
          "evaluators to assemble");
  ProblemDefinition d;
  d.model = specification.robot.model;
  d.x0 = specification.x0;
  d.u_previous = specification.u_previous;
  d.N = specification.N;
  d.dt = specification.dt;
  d.M = specification.M;
  d.zones = specification.zones;
  d.terms = make_builtin_terms({specification, evaluators});
  for (std::size_t i = 0; i < evaluators.added_terms.size(); ++i) {
    d.terms.push_back({evaluators.added_terms[i], specification.added_terms[i].weight});
  }
  return std::make_shared<const Problem>(std::move(d));
}

std::shared_ptr<const Problem> make_problem(const ProblemSpecification& specification) {
  CachedEvaluators evaluators;
  update_clearance(specification, evaluators);
  update_views(specification, evaluators);
  update_added_terms(specification, evaluators);
  evaluators.landmark_table->cast_all();
  for (const auto& table : evaluators.target_tables) table->cast_all();
  return assemble_problem(specification, evaluators);
}

ProblemSpecification with_maps_cut(ProblemSpecification specification) {
  require(specification.voxels != nullptr, "voxels");
  require(specification.ground != nullptr, "ground map");
  if (!specification.added_terms.empty()) return specification;
  const VoxelGrid& voxels = *specification.voxels;
  const double r = voxels.resolution();

  const ClearanceField::Options& field = specification.clearance_field;
  // The nodes within reach, two rings of them more, and the obstacles within the cutoff.
  const double around = field.cutoff + 4.0 * r;
  const Eigen::Vector3d half(field.reach + around, field.reach + around,
                             field.vertical_reach + around);
  Box window{specification.clearance_center - half, specification.clearance_center + half};
  if (!field.vertical) {
    window.low.z() = field.slice.z_min;
    window.high.z() = field.slice.z_max;
  }
  Box box = window;
  box.include(rays(specification.landmark_lattice, specification.landmark_occlusion,
                   positions(specification.landmarks)));
  for (const TargetRays& of : target_rays(specification)) {
    box.include(rays(of.lattice, specification.target_occlusion, of.targets));
  }

  const GridFrame columns = cut(voxels.frame(), box);
  const auto [k0, depth] = cut(voxels.k0(), voxels.depth(), box.low.z(), box.high.z(), r);
  std::vector<CellState> data;
  data.reserve(static_cast<std::size_t>(columns.size()) * static_cast<std::size_t>(depth));
  for (int n = 0; n < columns.size(); ++n) {
    const Cell c = columns.at(n);
    const auto column =
        voxels.data().begin() + static_cast<std::ptrdiff_t>(voxels.index(c.i, c.j, k0));
    data.insert(data.end(), column, column + depth);
  }
  specification.voxels = std::make_shared<const VoxelGrid>(columns, k0, depth, std::move(data));

  const GridFrame cells = cut(specification.ground->frame(), window);
  auto ground = std::make_shared<GroundMap>(cells);
  for (int n = 0; n < cells.size(); ++n) {
    ground->set(cells.at(n), specification.ground->state(cells.at(n)));
  }
  specification.ground = std::move(ground);
  return specification;
}

}  // namespace prospect
