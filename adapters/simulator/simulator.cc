#include "adapters/simulator/simulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "adapters/simulator/relocalization.h"

namespace prospect {
namespace {

// One well-mixed seed for each source of noise (SplitMix64).
std::uint64_t stream_seed(std::uint64_t seed, std::uint64_t stream) {
  std::uint64_t z = seed + (stream + 1) * 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}
enum Stream : std::uint64_t { kActuation, kDepth, kFeatures, kOdometry, kPoints, kTexture };

void require(bool ok, const char* what, double got, const char* expected) {
  if (!ok) {
    throw std::invalid_argument(std::string("simulator: ") + what + " is " + std::to_string(got) +
                                ", expected " + expected);
  }
}

std::shared_ptr<const World> not_null(std::shared_ptr<const World> world) {
  if (!world) throw std::invalid_argument("simulator: expected a world, got none");
  return world;
}

OccupancyMapperOptions mapping_options(const World& world, const SimulatorOptions& options) {
  OccupancyMapperOptions mapping = options.mapping;
  const VerticalExtent extent = vertical_extent(options.shape);
  mapping.slice.z_min = world.start.position.z() + extent.z_min;
  mapping.slice.z_max = world.start.position.z() + extent.z_max;
  mapping.slice.sight = world.start.position.z() + options.depth_mount.T_BC.translation().z();
  mapping.max_range = options.depth.footprint.max_range;
  return mapping;
}

}  // namespace

struct Simulator::Impl {
  std::shared_ptr<const World> world;
  SimulatorOptions options;
  KinematicRobot robot;
  DepthCamera depth;
  FeatureField field;
  FeatureCamera camera;
  OdometryModel odometry;
  LandmarkBuilder landmarks;
  OccupancyMapper mapper;

  double time = 0.0;
  double lost_time = 0.0;
  std::int64_t images = 0;  // taken so far; the next one is due at images / image_rate
  std::int64_t scans = 0;
  Twist twist;  // being executed

  Pose image_pose;  // true pose of the newest image
  std::vector<std::uint64_t> tracked;
  int visible = 0;
  int relocalization_images_left = 0;

  // What has really been seen, on the true lattice.
  SliceLayers layers;
  std::vector<CellState> seen_voxels;
  std::vector<std::uint32_t> newly_seen;
  std::vector<std::uint16_t> seen_free;  // of each column, within the slice
  std::vector<std::uint8_t> seen_column;
  std::vector<std::int32_t> reachable_cells;  // of each column: how many it stands for
  std::int64_t reachable_total = 0;
  std::int64_t reachable_seen = 0;
  std::int64_t columns_seen = 0;

  Impl(std::shared_ptr<const World> w, const SimulatorOptions& o)
      : world(not_null(std::move(w))),
        options(o),
        robot(*world, o.shape, o.actuation, world->start, stream_seed(o.seed, kActuation)),
        depth(*world, o.depth, o.depth_mount, stream_seed(o.seed, kDepth)),
        field(
            *world,
            [&](int i, int j, int k) {
              return texture_density(*world, i, j, k, stream_seed(o.seed, kTexture));
            },
            stream_seed(o.seed, kPoints)),
        camera(*world, field, o.features, o.stereo_mount, stream_seed(o.seed, kFeatures)),
        odometry(o.odometry, o.features.stereo, o.stereo_mount, world->start,
                 stream_seed(o.seed, kOdometry)),
        landmarks(o.landmarks, o.features, o.stereo_mount),
        mapper(mapping_options(*world, o)) {
    require(o.depth_rate > 0.0 && o.depth_rate <= 1000.0, "depth_rate", o.depth_rate,
            "0..1000 Hz, not zero");
    require(o.image_rate > 0.0 && o.image_rate <= 1000.0, "image_rate", o.image_rate,
            "0..1000 Hz, not zero");
    layers = slice_layers(mapper.options().slice, world->voxels.resolution());
    seen_voxels.assign(world->voxels.data().size(), CellState::kUnknown);
    const auto columns = static_cast<std::size_t>(world->voxels.frame().size());
    seen_free.assign(columns, 0);
    seen_column.assign(columns, 0);
    reachable_cells.assign(columns, 0);
    // The robot stands there: every voxel that its outline touches is free.
    mapper.clear_cylinder(world->start.position,
                          robot.contact_test().radius() + 0.75 * mapper.options().resolution,
                          mapper.options().slice.z_max);
    scan();
    image();
  }

  void scan() {
    ++scans;
    newly_seen.clear();
    const DepthScan scan_B = depth.sense(robot.pose(), &seen_voxels, &newly_seen);
    mapper.insert(transform(scan_B, odometry.estimate(robot.pose())));
    const auto depth_layers = static_cast<std::uint32_t>(world->voxels.depth());
    for (const std::uint32_t index : newly_seen) {
      const int k = world->voxels.k0() + static_cast<int>(index % depth_layers);
      if (k < layers.k_low || k > layers.k_high) continue;
      const std::uint32_t column = index / depth_layers;
      if (seen_column[column] != 0) continue;
      const bool solid = seen_voxels[index] == CellState::kOccupied;
      if (!solid) ++seen_free[column];
      if (project_column(solid ? 1 : 0, seen_free[column]) == CellState::kUnknown) {
        continue;
      }
      seen_column[column] = 1;
      ++columns_seen;
      reachable_seen += reachable_cells[column];
    }
  }

  void image() {
    const Pose& pose = robot.pose();
    const bool first = images == 0;
    ++images;
    // A robot that stands still sees what it saw.
    if (!first && pose.yaw == image_pose.yaw && pose.position == image_pose.position) return;
    image_pose = pose;
    const std::vector<FeatureObservation> observations = camera.observe(pose, &visible);
    tracked.clear();
    std::vector<Eigen::Vector3d> points;
    points.reserve(observations.size());
    for (const FeatureObservation& o : observations) {
      tracked.push_back(o.feature);
      points.push_back(o.true_point);
    }
    const bool keyframe = odometry.image(pose, points);
    // Points seen before the loss are looked for until they are found or given up; new ones would
    // carry the error of the loss and wait that long.
    constexpr int kRelocalizationImages = 30;
    if (odometry.localization() == Localization::kLost) {
      relocalization_images_left = kRelocalizationImages;
    } else if (relocalization_images_left > 0) {
      --relocalization_images_left;
      const auto find = [this](std::uint32_t feature) { return landmarks.find(feature); };
      const Eigen::Vector3i planar(0, 1, 3);
      const Eigen::Matrix3d drift = odometry.drift_covariance()(planar, planar);
      const auto found = relocalize(observations, find, options.features.stereo,
                                    options.stereo_mount, odometry.estimate(pose), drift.inverse());
      if (found) {
        odometry.relocalize(pose, *found);
        relocalization_images_left = 0;
      } else if (relocalization_images_left == 0) {
        odometry.accept_drift();
      }
    }
    if (relocalization_images_left > 0) return;
    if ((keyframe || first) && odometry.localization() != Localization::kLost) {
      const double r = mapper.options().resolution;
      landmarks.update(observations, odometry.estimate(pose), *mapper.voxels(),
                       static_cast<double>(mapper.surface_voxels()) * r * r);
    }
  }
};

Simulator::Simulator(std::shared_ptr<const World> world, const SimulatorOptions& options)
    : impl_(std::make_unique<Impl>(std::move(world), options)) {}
Simulator::~Simulator() = default;

std::shared_ptr<const Belief> Simulator::sense() {
  Impl& s = *impl_;
  auto belief = std::make_shared<Belief>();
  belief->stamp = s.time;
  belief->pose = s.odometry.estimate(s.robot.pose());
  belief->covariance = s.odometry.covariance();
  belief->twist = s.twist;
  belief->localization = s.odometry.localization();
  belief->tracked_features = static_cast<int>(s.tracked.size());
  belief->octree = s.mapper.octree();
  belief->voxels = s.mapper.voxels();
  belief->ground = s.mapper.ground();
  belief->landmarks = s.landmarks.map();
  return belief;
}

void Simulator::apply(const Twist& twist, double duration) {
  Impl& s = *impl_;
  if (!(duration > 0.0) || !std::isfinite(duration)) return;
  s.twist = twist;
  s.twist.linear.z() = 0.0;
  if (!twist.linear.allFinite() || !std::isfinite(twist.yaw_rate)) s.twist = Twist{};
  // Instants closer than this are one: sums of periods do not meet exactly.
  constexpr double kInstant = 1e-9;
  const double end = s.time + duration;
  while (s.time < end - kInstant) {
    const double next_image = static_cast<double>(s.images) / s.options.image_rate;
    const double next_scan = static_cast<double>(s.scans) / s.options.depth_rate;
    const double next = std::max(s.time, std::min({end, next_image, next_scan}));
    if (next > s.time) {
      if (!s.robot.move(s.twist, next - s.time)) s.twist = Twist{};
      if (s.odometry.localization() == Localization::kLost) s.lost_time += next - s.time;
      s.time = next;
    }
    if (s.time >= next_image - kInstant) s.image();
    if (s.time >= next_scan - kInstant) s.scan();
  }
  s.time = end;
}

double Simulator::time() const { return impl_->time; }
const World& Simulator::world() const { return *impl_->world; }
const SimulatorOptions& Simulator::options() const { return impl_->options; }
Pose Simulator::true_pose() const { return impl_->robot.pose(); }
Pose Simulator::estimated_pose() const { return impl_->odometry.estimate(impl_->robot.pose()); }
double Simulator::localization_error() const {
  return (estimated_pose().position - true_pose().position).head<2>().norm();
}
int Simulator::collisions() const { return impl_->robot.collisions(); }
bool Simulator::in_contact() const { return impl_->robot.in_contact(); }
double Simulator::path_length() const { return impl_->robot.path_length(); }
double Simulator::rotation() const { return impl_->robot.rotation(); }
int Simulator::losses() const { return impl_->odometry.losses(); }
double Simulator::lost_time() const { return impl_->lost_time; }
const std::vector<std::uint64_t>& Simulator::tracked() const { return impl_->tracked; }
int Simulator::visible_features() const { return impl_->visible; }

void Simulator::set_reachable(const Grid<std::uint8_t>& reachable) {
  Impl& s = *impl_;
  const GridFrame& frame = s.world->voxels.frame();
  std::fill(s.reachable_cells.begin(), s.reachable_cells.end(), 0);
  s.reachable_total = 0;
  s.reachable_seen = 0;
  for (int n = 0; n < reachable.frame.size(); ++n) {
    if (reachable.data[static_cast<std::size_t>(n)] == 0) continue;
    ++s.reachable_total;
    // The cell stands for the column that holds its centre.
    const Eigen::Vector2d center = reachable.frame.center(reachable.frame.at(n));
    const Cell column = frame.cell(center.x(), center.y());
    if (!frame.contains(column)) continue;
    const auto index = static_cast<std::size_t>(frame.index(column));
    ++s.reachable_cells[index];
    s.reachable_seen += s.seen_column[index] != 0 ? 1 : 0;
  }
}

double Simulator::coverage() const {
  return impl_->reachable_total == 0 ? 0.0
                                     : static_cast<double>(impl_->reachable_seen) /
                                           static_cast<double>(impl_->reachable_total);
}

double Simulator::seen_area() const {
  const double r = impl_->world->voxels.resolution();
  return static_cast<double>(impl_->columns_seen) * r * r;
}

bool Simulator::seen(Cell true_cell) const {
  const GridFrame& frame = impl_->world->voxels.frame();
  return frame.contains(true_cell) &&
         impl_->seen_column[static_cast<std::size_t>(frame.index(true_cell))] != 0;
}

}  // namespace prospect
