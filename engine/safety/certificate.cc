// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/certificate.h"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/utility.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/narrowphase/collision.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <limits>
#include <list>
#include <optional>
#include <span>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/maps/column_levels.h"
#include "engine/maps/correction.h"
#include "engine/maps/floor_state.h"
#include "engine/maps/heading_fit.h"
#include "engine/maps/map_projection.h"
#include "engine/maps/movers.h"
#include "engine/maps/pose_error.h"
#include "engine/maps/present_view.h"
#include "engine/maps/shape_geometry.h"
#include "engine/safety/known_ground.h"
#include "engine/task/body_outline.h"
#include "models/body_transform.h"
#include "models/depth_sensors.h"
#include "models/limited_twist.h"

namespace prospect {
namespace {

constexpr double kReducedTolerance = 1e-4;  // [m]
constexpr double kPoint = 1e-4;             // [m]: side of the square that stands for a point
constexpr double kUnmoved = 1e-6;           // [m]: a robot that turns on the spot
constexpr double kSpeedTolerance = 1e-4;    // [m/s] above a slow zone's limit

// Elementary checks that things cost, about as they do in time; looking at a voxel is two.
constexpr long long kPoseCost = 200;     // a step of the motion
constexpr long long kNearCost = 12;      // a voxel that is kept in mind, or held against a bound
constexpr long long kSideCost = 8;       // a side of a zone, for each disc or side of the body
constexpr long long kContactCost = 800;  // FCL; each vertex of a hull is two more

/// Thrown by Budget, caught in this file.
struct Exhausted {};

/// What a check may cost. A count, not a time: the same verdict on a busy machine.
class Budget {
 public:
  explicit Budget(long long checks) : left_(checks) {}
  void spend(long long checks) {
    left_ -= checks;
    if (left_ < 0) throw Exhausted{};
  }

 private:
  long long left_;
};

/// A vertical run of voxels: column (i, j), layers low..high inclusive.
struct Run {
  int i = 0, j = 0, low = 0, high = 0;
  friend bool operator==(const Run&, const Run&) = default;
};

struct RunHash {
  std::size_t operator()(const Run& run) const {
    const auto u = [](int v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)); };
    std::uint64_t h = (u(run.i) << 32 | u(run.j)) * 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 29) ^ u(run.low)) * 0xbf58476d1ce4e5b9u;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
};

/// Signed distance from a point to a box given by its lowest and highest corner.
double box_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& low,
                    const Eigen::Vector3d& high) {
  const Eigen::Vector3d out = (low - p).cwiseMax(p - high);
  return out.maxCoeff() <= 0.0 ? out.maxCoeff() : out.cwiseMax(0.0).norm();
}

/// One convex part of the body and its bounds.
struct Part {
  PlacedGeometry placed;
  Eigen::Vector3d center;  // of the local bounding box, in B
  Eigen::Vector3d half;    // of the local bounding box
  double ball;             // radius about the centre
  double disc;             // horizontal radius about the centre
  long long cost;          // of asking FCL about it
};

/// What bounds the grown body in B: its horizontal reach about the z axis, and its heights.
struct BodyExtent {
  double middle;  // height of the body's middle
  double reach;
  VerticalExtent height;
};

std::string at_time(double time, const Pose& pose) {
  char text[120];
  std::snprintf(text, sizeof text, "after %.2f s, at (%.2f, %.2f, %.2f) m, yaw %.2f rad", time,
                pose.position.x(), pose.position.y(), pose.position.z(), pose.yaw);
  return text;
}

std::string over_budget(long long max_checks) {
  return "the check is given up after " + std::to_string(max_checks) +
         " elementary checks: the body is too large for what is about it, or the motion too long";
}

}  // namespace

struct Certifier::Body {
  /// The body grown by `margin`, for the columns that may have drifted by `drift` at least [m].
  struct Shell {
    double margin;
    double drift;
    std::vector<Part> parts;
  };
  RobotShape shape;
  std::vector<Part> exact;
  std::vector<Shell> shells;        // by drift; the first is for all columns
  BodyOutline outline;              // on the ground
  std::vector<OutlinePart> ground;  // the same
  double circumscribed = 0.0;
  double middle = 0.0;  // height of the body's middle in B

  static std::vector<Part> parts(const RobotShape& shape, double inflation) {
    const auto* hull = std::get_if<ConvexShape>(&shape);
    const auto vertices = hull == nullptr ? 0LL : static_cast<long long>(hull->vertices.size());
    const long long cost = kContactCost + 16 * vertices;  // of each vertex there are eight
    std::vector<Part> result;
    for (PlacedGeometry& g : shape_geometry(shape, inflation)) {
      const Eigen::Vector3d center = g.T_BG * g.geometry->aabb_center;
      const Eigen::Vector3d half =
          0.5 * (g.geometry->aabb_local.max_ - g.geometry->aabb_local.min_);
      // FCL's own radius is that of the box about the geometry.
      const bool ball = std::holds_alternative<SphereSetShape>(shape);
      const bool round = ball || std::holds_alternative<CylinderShape>(shape);
      const double disc = round ? half.x() : half.head<2>().norm();
      const double radius = ball ? half.x() : std::hypot(disc, half.z());
      result.push_back({std::move(g), center, half, radius, disc, cost});
    }
    return result;
  }
  /// What it costs to make and to place the parts once.
  static long long making_cost(const std::vector<Part>& parts) {
    long long cost = 0;
    for (const Part& part : parts) cost += part.cost;
    return cost;
  }
  BodyExtent extent() const {
    BodyExtent all{middle, 0.0, {0.0, 0.0}};
    for (const std::vector<Part>* parts : {&exact, &shells.back().parts}) {
      for (const Part& p : *parts) {
        all.reach = std::max(all.reach, p.center.head<2>().norm() + p.disc);
        all.height.z_min = std::min(all.height.z_min, p.center.z() - p.half.z());
        all.height.z_max = std::max(all.height.z_max, p.center.z() + p.half.z());
      }
    }
    return all;
  }
};

namespace {

/// What closes space to a motion besides obstacles.
struct Closing {
  UnknownPolicy unknown = UnknownPolicy::kFree;
  const SurfaceDrift* drift = nullptr;
  double drift_limit = 0.0;                 // [m]; 0: none
  bool only_in_view = false;                // nothing bounds the error of the pose
  std::span<const PresentView> views{};     // of each depth sensor; none: nothing is in view
  const octomap::OcTree* octree = nullptr;  // null: what is free is proven to be
  double free_evidence = 0.0;               // that proves it
  std::optional<FloorLayers> floor{};       // has to be seen in them; none: it need not be
};

/// Of present views, a bit each.
using ViewMask = std::uint32_t;
static_assert(kMostDepthSensors <= 32);

/// A column or voxel that a motion may not enter, and why. passed_by: out of view, but these
/// PresentViews pass by it.
struct Closed {
  Run run;
  Certificate::Status why;
  ViewMask passed_by;
};

/// The voxels near a body, gathered about the place where it stands and gathered anew when it has
/// moved on; asks FCL about those that it may touch.
class Scene {
 public:
  Scene(const Belief& belief, const VerticalExtent& slice, bool planar, const BodyExtent& body,
        const Closing& closing, Budget& budget)
      : voxels_(*belief.voxels),
        ground_(*belief.ground),
        planar_(planar),
        body_(body),
        closing_(closing),
        budget_(budget) {
    const double r = voxels_.resolution();
    low_ = voxels_.k0();
    high_ = voxels_.k0() + voxels_.depth() - 1;
    if (planar) {
      const double from = std::floor(slice.z_min / r + kFaceTolerance);
      const double to = std::ceil(slice.z_max / r - kFaceTolerance) - 1.0;
      slice_low_ = static_cast<int>(std::clamp(from, -1e6, 1e6));
      slice_high_ = static_cast<int>(std::clamp(to, -1e6, 1e6));
      low_ = std::max(low_, slice_low_);
      high_ = std::min(high_, slice_high_);
    }
  }

  Eigen::Vector3d low_corner(const Run& run) const {
    return voxels_.resolution() * Eigen::Vector3d(run.i, run.j, run.low);
  }
  Eigen::Vector3d high_corner(const Run& run) const {
    return voxels_.resolution() * Eigen::Vector3d(run.i + 1, run.j + 1, run.high + 1);
  }
  /// From the body's centre: horizontal for planar bases.
  double centre_distance(const Pose& pose, const Run& run) const {
    Eigen::Vector3d low = low_corner(run);
    Eigen::Vector3d high = high_corner(run);
    if (planar_) {
      low.z() = -1e9;
      high.z() = 1e9;
    }
    return box_distance(pose.position + Eigen::Vector3d(0.0, 0.0, body_.middle), low, high);
  }

  /// Calls visit(run) for every run of occupied voxels that a part touches, in the columns that may
  /// have drifted by `least` at least, until it returns false. Returns whether all were visited.
  template <typename Visit>
  bool occupied(const std::vector<Part>& parts, const Pose& pose, double least,
                const Visit& visit) {
    gather(pose);
    return each_touched(
        parts, pose, obstacles_,
        [least](const Obstacle& o) { return !(least > 0.0) || o.drift >= least; },
        [&](const Obstacle& o) { return visit(o.run); });
  }

  /// The same for closed space, visit(closed): columns of the slice (planar) or single voxels.
  template <typename Visit>
  bool closed(const std::vector<Part>& parts, const Pose& pose, const Visit& visit) {
    gather(pose);
    return each_touched(
        parts, pose, closed_, [](const Closed&) { return true; },
        [&](const Closed& c) { return visit(c); });
  }
  /// What a part touches of closed space is open from now on.
  void open(const std::vector<Part>& parts, const Pose& pose) {
    closed(parts, pose, [this](const Closed& c) {
      budget_.spend(4 * kNearCost);
      opened_.insert(c.run);
      return true;
    });
    std::erase_if(closed_, [this](const Closed& c) { return opened_.count(c.run) > 0; });
  }

 private:
  struct Obstacle {
    Run run;
    double drift;
  };
  /// Where a part stands at the pose looked at, and the voxels that its bounding box meets.
  struct Box {
    Eigen::Isometry3d T_WG;
    Eigen::Vector3d center;
    int i_low, i_high, j_low, j_high, k_low, k_high;
    bool meets(const Run& run) const {
      return run.i >= i_low && run.i <= i_high && run.j >= j_low && run.j <= j_high &&
             run.high >= k_low && run.low <= k_high;
    }
  };
  // Farther than that from where it was gathered, a scene is gathered anew [m].
  static constexpr double kSlack = 0.5, kVerticalSlack = 0.25;

  template <typename Item, typename Counts, typename Visit>
  bool each_touched(const std::vector<Part>& parts, const Pose& pose,
                    const std::vector<Item>& items, const Counts& counts, const Visit& visit) {
    const Eigen::Isometry3d T_WB = body_transform(pose);
    for (const Part& part : parts) {
      budget_.spend(4 + static_cast<long long>(items.size()));
      const Box box = place(part, T_WB);
      for (const Item& item : items) {
        if (!box.meets(item.run) || !counts(item)) continue;
        if (touches(part, box, item.run) && !visit(item)) return false;
      }
    }
    return true;
  }

  Box place(const Part& part, const Eigen::Isometry3d& T_WB) const {
    const double r = voxels_.resolution();
    Box box;
    box.T_WG = T_WB * part.placed.T_BG;
    box.center = T_WB * part.center;
    // Bounding box of the local bounding box, turned about z.
    const Eigen::Vector3d& half = part.half;
    const double c = std::abs(T_WB.linear()(0, 0));
    const double s = std::abs(T_WB.linear()(1, 0));
    const Eigen::Vector3d reach(std::min(c * half.x() + s * half.y(), part.disc),
                                std::min(s * half.x() + c * half.y(), part.disc), half.z());
    const Eigen::Vector3d from = (box.center - reach) / r;
    const Eigen::Vector3d to = (box.center + reach) / r;
    box.i_low = address(from.x());
    box.i_high = address(to.x());
    box.j_low = address(from.y());
    box.j_high = address(to.y());
    box.k_low = address(from.z());
    box.k_high = address(to.z());
    return box;
  }
  static int address(double v) { return static_cast<int>(std::clamp(std::floor(v), -2e9, 2e9)); }

  bool touches(const Part& part, const Box& box, const Run& run) {
    const Eigen::Vector3d low = low_corner(run);
    const Eigen::Vector3d high = high_corner(run);
    budget_.spend(kNearCost);
    // Apart by more than FCL's own tolerance: of the ball or the upright cylinder about the part,
    // or along an axis of its bounding box.
    constexpr double kApart = 1e-4;  // [m]
    const Eigen::Vector3d out = (low - box.center).cwiseMax(box.center - high).cwiseMax(0.0);
    if (out.norm() > part.ball + kApart || out.head<2>().norm() > part.disc + kApart) return false;
    const Eigen::Matrix3d& R = box.T_WG.linear();
    const Eigen::Vector3d gap = (R.transpose() * (0.5 * (low + high) - box.center)).cwiseAbs() -
                                part.half - R.cwiseAbs().transpose() * (0.5 * (high - low));
    if (gap.maxCoeff() > kApart) return false;
    budget_.spend(part.cost);
    const fcl::Boxd obstacle(Eigen::Vector3d(high - low));
    fcl::Transform3d T = fcl::Transform3d::Identity();
    T.translation() = 0.5 * (low + high);
    const fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    fcl::collide(part.placed.geometry.get(), box.T_WG, &obstacle, T, request, result);
    return result.isCollision();
  }

  /// Whether what is known to be free at (i, j) and layers low..high is not proven to be
  /// (Options::max_doubt): all that was seen there together.
  bool doubtful(int i, int j, int low, int high) const {
    if (closing_.octree == nullptr) return false;
    constexpr int kKeyOrigin = 32768;  // OctoMap's key of address 0
    const auto key = [](int address) {
      return static_cast<octomap::key_type>(std::clamp(address + kKeyOrigin, 0, 65535));
    };
    double evidence = 0.0;
    const int up = level_of(*closing_.octree, {i, j});
    for (int k = low; k <= high && evidence < closing_.free_evidence; ++k) {
      budget_.spend(kNearCost);
      if (voxels_.state(i, j, k) != CellState::kFree) continue;
      const octomap::OcTreeNode* node =
          closing_.octree->search(octomap::OcTreeKey(key(i), key(j), key(k + up)));
      if (node == nullptr) return false;  // the mirror alone knows of it
      evidence -= static_cast<double>(node->getLogOdds());
    }
    return evidence < closing_.free_evidence;
  }

  /// Whether a cell has drifted so far since it was in view that what is there is unknown.
  bool forgotten(Cell c) const {
    return closing_.drift != nullptr && closing_.drift_limit > 0.0 &&
           closing_.drift->sigma(c) > closing_.drift_limit;
  }

  void gather(const Pose& pose) {
    const Eigen::Vector3d moved = pose.position - gathered_;
    if (has_gathered_ && moved.head<2>().norm() <= kSlack &&
        (planar_ || std::abs(moved.z()) <= kVerticalSlack)) {
      return;
    }
    has_gathered_ = true;
    gathered_ = pose.position;
    obstacles_.clear();
    closed_.clear();
    const double r = voxels_.resolution();
    const double within = body_.reach + kSlack + kFaceTolerance;
    if (!(within / r < 1e6)) throw Exhausted{};
    const double x = gathered_.x() / r, y = gathered_.y() / r, z = gathered_.z();
    const double within_cells = within / r;
    int i_low = address(x - within_cells), i_high = address(x + within_cells);
    int j_low = address(y - within_cells), j_high = address(y + within_cells);
    const double above = kVerticalSlack + kFaceTolerance;
    const int k_low = planar_ ? low_ : address((z + body_.height.z_min - above) / r);
    const int k_high = planar_ ? high_ : address((z + body_.height.z_max + above) / r);
    const bool closing = closing_.unknown != UnknownPolicy::kFree || closing_.only_in_view ||
                         closing_.floor.has_value();
    const GridFrame& frame = voxels_.frame();
    if (!closing) {  // nothing is beyond the map
      i_low = std::max(i_low, frame.i0);
      i_high = std::min(i_high, frame.i0 + frame.width - 1);
      j_low = std::max(j_low, frame.j0);
      j_high = std::min(j_high, frame.j0 + frame.height - 1);
    }
    if (i_low > i_high || j_low > j_high) return;
    budget_.spend((1LL + i_high - i_low) * (1LL + j_high - j_low) *
                  (6 + 2 * std::max(0LL, 1LL + k_high - k_low)));
    for (int j = j_low; j <= j_high; ++j) {
      const double dy = std::max({j - y, y - (j + 1.0), 0.0});
      for (int i = i_low; i <= i_high; ++i) {
        const double dx = std::max({i - x, x - (i + 1.0), 0.0});
        if (dx * dx + dy * dy > within_cells * within_cells) continue;
        gather_obstacles(i, j, std::max(low_, k_low), std::min(high_, k_high));
        if (closing) gather_closed(i, j, k_low, k_high);
      }
    }
  }

  void gather_obstacles(int i, int j, int from, int to) {
    double drift = -1.0;
    const auto add = [&](const Run& run) {
      budget_.spend(kNearCost + run.high - run.low);
      if (drift < 0.0) drift = closing_.drift == nullptr ? 0.0 : closing_.drift->sigma({i, j});
      obstacles_.push_back({run, drift});
    };
    if (voxels_.frame().contains({i, j})) {
      const CellState* column = voxels_.data().data() + voxels_.index(i, j, voxels_.k0());
      const auto is_occupied = [&](int k) {
        return column[k - voxels_.k0()] == CellState::kOccupied;
      };
      for (int k = from; k <= to; ++k) {
        if (!is_occupied(k)) continue;
        Run run{i, j, k, k};
        while (run.low > low_ && is_occupied(run.low - 1)) --run.low;
        while (run.high < high_ && is_occupied(run.high + 1)) ++run.high;
        k = run.high;
        add(run);
      }
    }
    // Where the body cannot be, and nothing stands: there is no floor.
    if (drift < 0.0 && planar_ && ground_.state({i, j}) == CellState::kOccupied) {
      add({i, j, slice_low_, slice_high_});
    }
  }

  void gather_closed(int i, int j, int k_low, int k_high) {
    using Status = Certificate::Status;
    const bool knows = closing_.unknown != UnknownPolicy::kFree;
    const bool whole = knows && forgotten({i, j});
    const auto add = [&](const Run& run, Status why, ViewMask passed_by) {
      if (!opened_.empty() && opened_.count(run) > 0) return;
      budget_.spend(kNearCost);
      closed_.push_back({run, why, passed_by});
    };
    const auto add_unless_shown = [&](const Run& run, const auto& address) {
      long long visits = 0;
      for (const PresentView& view : closing_.views) visits -= view.visits();
      const bool shown = std::ranges::any_of(
          closing_.views, [&](const PresentView& view) { return view.shows(address); });
      if (!shown) {
        ViewMask passed_by = 0;
        for (std::size_t n = 0; n < closing_.views.size(); ++n) {
          if (closing_.views[n].passes_by(address)) passed_by |= ViewMask{1} << n;
        }
        add(run, Status::kOutOfView, passed_by);
      }
      for (const PresentView& view : closing_.views) visits += view.visits();
      budget_.spend(visits);
    };
    if (planar_) {
      const Run run{i, j, slice_low_, slice_high_};
      const CellState state = ground_.state({i, j});
      if (closing_.floor && floor_state(voxels_, {i, j}, *closing_.floor) == FloorState::kUnseen) {
        add(run, Status::kUnseenFloor, 0);
      } else if (knows &&
                 (whole || state == CellState::kUnknown ||
                  (state == CellState::kFree && doubtful(i, j, slice_low_, slice_high_)))) {
        add(run, Status::kUnknownSpace, 0);
      } else if (closing_.only_in_view) {
        add_unless_shown(run, Cell{i, j});
      }
      return;
    }
    for (int k = k_low; k <= k_high; ++k) {
      const Run run{i, j, k, k};
      const CellState state = voxels_.state(i, j, k);
      if (knows && (whole || state == CellState::kUnknown ||
                    (state == CellState::kFree && doubtful(i, j, k, k)))) {
        add(run, Status::kUnknownSpace, 0);
      } else if (closing_.only_in_view) {
        add_unless_shown(run, Eigen::Vector3i(i, j, k));
      }
    }
  }

  const VoxelGrid& voxels_;
  const GroundMap& ground_;
  bool planar_;
  BodyExtent body_;
  Closing closing_;
  Budget& budget_;
  int low_ = 0, high_ = 0;              // layers in which occupied voxels count
  int slice_low_ = 0, slice_high_ = 0;  // planar: layers of the slice
  bool has_gathered_ = false;
  Eigen::Vector3d gathered_ = Eigen::Vector3d::Zero();  // about here
  std::vector<Obstacle> obstacles_;
  std::vector<Closed> closed_;
  std::unordered_set<Run, RunHash> opened_;
};

/// What a motion has been found to touch so far, and what of that is tolerated.
class Walk {
 public:
  Walk(Scene& scene, const std::vector<Part>& exact, const Pose& start,
       std::span<const PresentView> views)
      : scene_(scene), exact_(exact), body_(&exact), start_(start.position), views_(views) {}

  /// Whether the body is free of the columns that may have drifted by `least` at least.
  bool free(const Pose& pose, const std::vector<Part>& body, double least) const {
    return scene_.occupied(body, pose, least, [](const Run&) { return false; });
  }
  /// From now on `body` has to be; it outlives the walk.
  void keep_free(const std::vector<Part>& body, double least) {
    if (least > 0.0) {
      widened_.push_back({&body, least});
    } else {
      body_ = &body;
    }
  }
  /// What the exact body touches at `pose` is tolerated.
  void tolerate_contacts(const Pose& pose) {
    scene_.occupied(exact_, pose, 0.0, [&](const Run& run) {
      contacts_.try_emplace(run, Contact{scene_.centre_distance(pose, run), false});
      return true;
    });
  }
  void tolerate_closed(const Pose& pose) { scene_.open(exact_, pose); }

  Certificate::Status step(const Pose& pose) {
    using Status = Certificate::Status;
    for (const Widened& widened : widened_) {
      if (!free(pose, *widened.body, widened.least)) return Status::kCollision;
    }
    for (auto& [run, contact] : contacts_) contact.touched = false;
    const bool clear = scene_.occupied(*body_, pose, 0.0, [&](const Run& run) {
      const auto at = contacts_.find(run);
      if (at == contacts_.end()) return false;
      Contact& contact = at->second;
      contact.touched = true;
      const double distance = scene_.centre_distance(pose, run);
      if (distance < contact.distance - 1e-9) return false;
      contact.distance = distance;
      return true;
    });
    if (!clear) return Status::kCollision;
    std::erase_if(contacts_, [](const auto& entry) { return !entry.second.touched; });
    // A robot that turns on the spot looks about.
    const bool unmoved = (pose.position - start_).norm() <= kUnmoved;
    ViewMask ahead = 0;
    for (std::size_t n = 0; n < views_.size(); ++n) {
      if (views_[n].keeps_to(pose)) ahead |= ViewMask{1} << n;
    }
    Status status = Status::kOk;
    scene_.closed(exact_, pose, [&](const Closed& c) {
      if (c.why == Status::kOutOfView && (unmoved || (c.passed_by & ahead) != 0)) return true;
      status = c.why;
      return false;
    });
    return status;
  }

 private:
  struct Contact {
    double distance;
    bool touched;
  };
  struct Widened {
    const std::vector<Part>* body;
    double least;
  };

  Scene& scene_;
  const std::vector<Part>& exact_;
  const std::vector<Part>* body_;
  Eigen::Vector3d start_;
  std::span<const PresentView> views_;  // none: nothing is in view, or it does not matter
  std::vector<Widened> widened_;
  std::unordered_map<Run, Contact, RunHash> contacts_;
};

}  // namespace

namespace {

/// unknown_ground() of the poses between the stages.
std::string unknown_ground_of(const Belief& belief, const RobotShape& shape,
                              const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& x0,
                              const Eigen::MatrixXd& inputs, double dt) {
  Eigen::VectorXd x = x0, next(model.nx());
  std::vector<Pose> poses{model.pose(x)};
  for (Eigen::Index n = 0; n < inputs.cols(); ++n) {
    model.step(x, inputs.col(n), dt, next);
    x.swap(next);
    poses.push_back(model.pose(x));
  }
  return unknown_ground(belief, shape, model.pose_layout().pz < 0, poses);
}

}  // namespace

Eigen::MatrixXd stopping_tail(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& x,
                              const Eigen::Ref<const Eigen::VectorXd>& u_previous, double dt,
                              int max_steps) {
  std::vector<Eigen::VectorXd> inputs;
  Eigen::VectorXd state = x;
  Eigen::VectorXd next(model.nx());
  Eigen::VectorXd u = u_previous;
  do {
    u = model.braking_input(state, u, dt);
    inputs.push_back(u);
    model.step(state, u, dt, next);
    state.swap(next);
  } while (!is_at_rest(model.twist(state, u)) && static_cast<int>(inputs.size()) < max_steps &&
           state.allFinite());
  Eigen::MatrixXd tail(model.nu(), static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t n = 0; n < inputs.size(); ++n)
    tail.col(static_cast<Eigen::Index>(n)) = inputs[n];
  return tail;
}

Certifier::Options Certifier::options_for(const RobotDescription& robot) {
  Options options;
  options.slice = robot.slice();
  options.sensors = robot.depth_sensors();
  return options;
}

Certifier::Certifier(const RobotShape& shape, Options options) : options_(options) {
  if (!(options.margin > 0.0) || !std::isfinite(options.margin)) {
    throw std::invalid_argument("certifier: margin is " + std::to_string(options.margin) +
                                " m; expected > 0");
  }
  if (!std::isfinite(options.slice.z_min) || !std::isfinite(options.slice.z_max) ||
      !(options.slice.z_max > options.slice.z_min)) {
    throw std::invalid_argument("certifier: slice is [" + std::to_string(options.slice.z_min) +
                                ", " + std::to_string(options.slice.z_max) +
                                "] m; expected z_min < z_max");
  }
  if (!(options.max_tail_time > 0.0)) {
    throw std::invalid_argument("certifier: max_tail_time is " +
                                std::to_string(options.max_tail_time) + " s; expected > 0");
  }
  if (!(options.reduced_margin_share >= 0.0 && options.reduced_margin_share <= 1.0)) {
    throw std::invalid_argument("certifier: reduced_margin_share is " +
                                std::to_string(options.reduced_margin_share) + "; expected 0 to 1");
  }
  if (!(options.drift_margin >= 0.0) || !std::isfinite(options.drift_margin)) {
    throw std::invalid_argument("certifier: drift_margin is " +
                                std::to_string(options.drift_margin) + " m; expected >= 0");
  }
  if (!(options.drift_limit >= 0.0) || !std::isfinite(options.drift_limit)) {
    throw std::invalid_argument("certifier: drift_limit is " + std::to_string(options.drift_limit) +
                                " m; expected >= 0");
  }
  if (!(options.max_doubt > 0.0 && options.max_doubt <= 0.5)) {
    throw std::invalid_argument("certifier: max_doubt is " + std::to_string(options.max_doubt) +
                                "; expected above 0, at most 0.5");
  }
  if (!(options.max_lost_error >= 0.0)) {
    throw std::invalid_argument("certifier: max_lost_error is " +
                                std::to_string(options.max_lost_error) + " m; expected >= 0");
  }
  if (options.max_checks < 1) {
    throw std::invalid_argument("certifier: max_checks is " + std::to_string(options.max_checks) +
                                "; expected >= 1");
  }
  validate("certifier", options.sensors);
  auto body = std::make_unique<Body>();
  body->shape = shape;
  body->exact = Body::parts(shape, 0.0);
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    const double drift = share * options.drift_margin;
    if (share > 0.0 && !(drift > 0.0)) break;
    const double margin = options.margin + drift;
    body->shells.push_back({margin, drift, Body::parts(shape, margin)});
  }
  body->outline = body_outline(shape);
  body->ground = ground_outline(shape);
  body->circumscribed = circumscribed_radius(shape);
  const VerticalExtent extent = vertical_extent(shape);
  body->middle = 0.5 * (extent.z_min + extent.z_max);
  body_ = std::move(body);
}

Certifier::~Certifier() = default;
Certifier::Certifier(Certifier&&) noexcept = default;
Certifier& Certifier::operator=(Certifier&&) noexcept = default;

/// One motion that is followed pose by pose, and what was found of it so far.
class Certifier::Check {
 public:
  using Status = Certificate::Status;

  /// way [m]: that the motion covers at most. Throws Exhausted, as all of it does.
  Check(const Certifier& certifier, const Belief& belief, const MotionModel& model,
        const SurfaceDrift* drift, double path)
      : options_(certifier.options_),
        body_(*certifier.body_),
        model_(model),
        budget_(options_.max_checks),
        planar_(model.pose_layout().pz < 0),
        half_voxel_(0.5 * belief.voxels->resolution()),
        drift_(drift),
        map_frame_(belief.map_frame.get()),
        movers_(predicted(belief.movers.get(), belief.stamp)),
        sub_(model.nx()) {
    closing_ = {options_.unknown, drift, options_.drift_limit};
    closing_.octree = belief.octree.get();
    if (planar_ && options_.seen_floor) {
      const HeightSlice slice{options_.slice.z_min, options_.slice.z_max, {}, options_.step};
      closing_.floor = slice_layers(slice, belief.voxels->resolution()).floor;
    }
    closing_.free_evidence = std::log(1.0 / options_.max_doubt - 1.0);
    const BodyExtent extent = body_.extent();
    unbounded_ = unbounded_pose_error(belief, options_.max_lost_error);
    if (!unbounded_.empty()) {
      closing_.only_in_view = true;
      views_.reserve(options_.sensors.size());
      for (const DepthSensor& sensor : options_.sensors) see(belief, sensor, extent.reach, path);
      closing_.views = views_;
    }
    scene_.emplace(belief, options_.slice, planar_, extent, closing_, budget_);
  }

  /// The place where the motion begins, and what is tolerated there. Returns result().ok().
  bool begin(const Pose& pose) {
    checked_ = pose;
    for (const Mover& mover : movers_) {
      if (!mover.sound()) return ends(0.0, "what is told of somebody who moves is not finite");
    }
    walk_.emplace(*scene_, body_.exact, pose, closing_.views);
    double margin = margin_at(pose);
    walk_->tolerate_closed(pose);
    if (options_.zones != nullptr) margin = std::min(margin, enter_zones(pose));
    // Without a margin nothing covers the poses in between: they are spaced as for a quarter of it.
    spacing_ = std::min(2.0 * std::max(margin, 0.25 * options_.margin), half_voxel_);
    return passes(pose, 0.0);
  }

  /// Input u for dt from x, which begins `start` [s] after the motion. Puts the state after it into
  /// x. Returns result().ok().
  bool stage(Eigen::VectorXd& x, const Eigen::Ref<const Eigen::VectorXd>& u, double start,
             double dt) {
    const Eigen::VectorXd x_start = x;
    model_.step(x_start, u, dt, x);
    if (!x.allFinite() || !usable(model_.pose(x))) {
      return ends(start, "the motion leaves the finite numbers");
    }
    // Pieces short enough by the speed at either end; a piece that turns out longer all the same
    // is halved on the spot.
    const double wanted = std::max(speed(x_start, u), speed(x, u)) * dt / spacing_;
    // Enough poses for 100 m at the finest spacing; a longer stage is no motion of a robot.
    constexpr int kMaxPieces = 1 << 14;
    if (!(wanted < kMaxPieces)) return ends(start, "the motion is too fast to be checked");
    if (too_fast(checked_, model_.twist(x_start, u), start)) return false;
    const double piece = dt / std::max(1.0, std::ceil(wanted));
    double done = 0.0;
    double length = piece;
    while (done < dt) {
      const bool last = done + length >= dt * (1.0 - 1e-12);
      const double until = last ? dt : done + length;
      if (last) {
        sub_ = x;
      } else {
        model_.step(x_start, u, until, sub_);
      }
      const Pose pose = model_.pose(sub_);
      if (!usable(pose)) return ends(start, "the motion leaves the finite numbers");
      if (moved(checked_, pose) > spacing_ * (1.0 + 1e-6) && until - done > piece / 64.0) {
        length = 0.5 * (until - done);
        continue;
      }
      if (!passes(pose, start + until)) return false;
      if (too_fast(pose, model_.twist(sub_, u), start + until)) return false;
      checked_ = pose;
      done = until;
      length = piece;
    }
    return true;
  }

  static bool usable(const Pose& pose) {
    return pose.position.allFinite() && std::isfinite(pose.yaw) &&
           pose.position.cwiseAbs().maxCoeff() < kFarthest;
  }
  void spend(long long checks) { budget_.spend(checks); }
  Certificate& result() { return result_; }

 private:
  void see(const Belief& belief, DepthSensor sensor, double reach, double path) {
    // Farther than it moves nothing is asked for.
    sensor.footprint.max_range =
        std::min(sensor.footprint.max_range,
                 sensor.mount.T_BC.translation().norm() + 2.0 * reach + 1.0 + path);
    const double across = sensor.footprint.max_range / belief.voxels->resolution();
    if (!(across < 1e6)) throw Exhausted{};
    budget_.spend(static_cast<long long>(2.0 * sensor.footprint.horizontal_fov * across * across));
    views_.emplace_back(belief, sensor, body_.shape, planar_);
  }

  /// [m] that the body keeps from what all columns hold: less than asked for where it starts
  /// closer.
  double margin_at(const Pose& pose) {
    double margin = options_.margin;
    for (const Body::Shell& shell : body_.shells) {
      if (shell.drift > 0.0 && drift_ == nullptr) break;
      double kept = shell.margin;
      if (walk_->free(pose, shell.parts, shell.drift)) {
        walk_->keep_free(shell.parts, shell.drift);
      } else if (walk_->free(pose, body_.exact, shell.drift)) {
        double low = 0.0, high = shell.margin;
        while (high - low > kReducedTolerance) {
          const double middle = 0.5 * (low + high);
          budget_.spend(Body::making_cost(shell.parts));
          (walk_->free(pose, Body::parts(body_.shape, middle), shell.drift) ? low : high) = middle;
        }
        // Rounding must not keep a robot from turning on the spot.
        kept = std::max(0.0, options_.reduced_margin_share * low - 0.1 * kReducedTolerance);
        reduced_.push_back(Body::parts(body_.shape, kept));
        walk_->keep_free(reduced_.back(), shell.drift);
      } else {
        kept = 0.0;
        if (!(shell.drift > 0.0)) walk_->tolerate_contacts(pose);
      }
      if (!(shell.drift > 0.0)) margin = kept;
    }
    return margin;
  }

  /// Zones are in the map's frame.
  Pose in_map(const Pose& pose) const { return map_frame_ ? map_frame_->to_map(pose) : pose; }
  /// [m] that the body keeps from forbidden zones.
  double enter_zones(const Pose& pose) {
    const ZoneMap& zones = *options_.zones;
    for (int part = 0; part < zones.num_forbidden(); ++part) zone_cost_ += zones.corners(part);
    zone_cost_ *= kSideCost * static_cast<long long>(body_.outline.discs.size() +
                                                     body_.outline.corners.size() + 1);
    for (const SpeedZone& zone : zones.zones().slow) {
      zone_cost_ += kSideCost * static_cast<long long>(zone.area.size());
    }
    budget_.spend(zone_cost_);
    zone_walk_.emplace(zones, body_.outline, in_map(pose), options_.margin,
                       options_.reduced_margin_share);
    return zone_walk_->margin();
  }

  /// From the body's outline to a place on the ground [m].
  double outline_gap(const Pose& pose, const Eigen::Vector2d& place) const {
    return outline_distance(body_.ground, pose.position.head<2>(), pose.yaw,
                            place.array() - 0.5 * kPoint, kPoint);
  }

  /// Whether the body, coming from checked_, gets nearer to where somebody may be by then.
  bool closes_in_on_a_mover(const Pose& pose, double time) {
    for (const Mover& mover : movers_) {
      budget_.spend(kSideCost);
      const Eigen::Vector2d place = mover.at(time);
      const double far = mover.reach(time) + options_.margin;
      // Cheap, for who is far away.
      if ((pose.position.head<2>() - place).norm() > far + body_.circumscribed) continue;
      budget_.spend(8 * kSideCost * static_cast<long long>(body_.ground.size()));
      const double gap = outline_gap(pose, place);
      if (gap < far && gap < outline_gap(checked_, place) - kUnmoved) return true;
    }
    return false;
  }

  bool passes(const Pose& pose, double time) {
    ++result_.poses;
    budget_.spend(kPoseCost);
    result_.time = time;
    result_.pose = pose;
    result_.status = walk_->step(pose);
    if (result_.status == Status::kCollision) {
      result_.detail = "the body would touch an occupied voxel " + at_time(time, pose);
    } else if (result_.status == Status::kUnknownSpace) {
      result_.detail = "the body would enter unknown space " + at_time(time, pose);
    } else if (result_.status == Status::kUnseenFloor) {
      result_.detail =
          "the body would enter ground whose floor was not seen " + at_time(time, pose);
    } else if (result_.status == Status::kOutOfView) {
      result_.detail =
          unbounded_ + ", and the body would leave what is in view " + at_time(time, pose);
    }
    if (result_.ok() && closes_in_on_a_mover(pose, time)) {
      result_.status = Status::kCollision;
      result_.detail = "the body would drive into where somebody may be " + at_time(time, pose);
    }
    if (!result_.ok() || !zone_walk_) return result_.ok();
    budget_.spend(zone_cost_);
    if (const int part = zone_walk_->step(in_map(pose)); part >= 0) {
      const bool bound = options_.zones->zones().bound && part == 0;
      result_.status = Status::kForbidden;
      result_.detail = (bound ? "the body would leave " : "the body would enter ") +
                       options_.zones->name(part) + ' ' + at_time(time, pose);
    }
    return result_.ok();
  }

  bool too_fast(const Pose& pose, const Twist& twist, double time) {
    if (!zone_walk_ || !options_.zones->slows()) return false;
    const double limit =
        options_.zones->speed_limit(in_map(pose).position.head<2>(), 0.5 * spacing_);
    if (twist.linear.norm() <= limit + kSpeedTolerance) return false;
    result_.status = Status::kTooFast;
    result_.time = time;
    result_.pose = pose;
    char speeds[80];
    std::snprintf(speeds, sizeof speeds, "it would drive %.2f m/s where %.2f are allowed ",
                  twist.linear.norm(), limit);
    result_.detail = speeds + at_time(time, pose);
    return true;
  }

  bool ends(double time, const char* why) {
    result_.status = Status::kNonFinite;
    result_.time = time;
    result_.detail = why;
    return false;
  }

  /// At most so far [m] a point of the body moves from one pose to the other.
  double moved(const Pose& a, const Pose& b) const {
    const double turn = std::min(std::abs(b.yaw - a.yaw), M_PI);
    return (b.position - a.position).norm() + 2.0 * body_.circumscribed * std::sin(0.5 * turn);
  }
  /// [m/s] likewise.
  double speed(const Eigen::VectorXd& x, const Eigen::Ref<const Eigen::VectorXd>& u) const {
    const Twist twist = model_.twist(x, u);
    return twist.linear.norm() + body_.circumscribed * std::abs(twist.yaw_rate);
  }

  const Options& options_;
  const Body& body_;
  const MotionModel& model_;
  Budget budget_;
  const bool planar_;
  const double half_voxel_;    // [m]
  const SurfaceDrift* drift_;  // null: none is minded
  const MapFrame* map_frame_;  // null: it is W
  std::string unbounded_;      // why nothing bounds the error of the pose; empty: something does
  std::vector<PresentView> views_;
  Closing closing_;
  std::optional<Scene> scene_;
  std::optional<Walk> walk_;
  std::list<std::vector<Part>> reduced_;  // bodies of a robot that starts within a margin
  std::vector<Mover> movers_;             // as from the motion's start
  std::optional<ZoneWalk> zone_walk_;
  long long zone_cost_ = 0;  // of a step
  double spacing_ = 0.0;     // [m]
  Pose checked_;
  Eigen::VectorXd sub_;  // state within a stage
  Certificate result_;
};

Certificate Certifier::certify_inputs(const Belief& belief, const MotionModel& model,
                                      const Eigen::Ref<const Eigen::VectorXd>& x0,
                                      const Eigen::Ref<const Eigen::MatrixXd>& inputs, double dt,
                                      const SurfaceDrift* drift) const {
  std::optional<Check> check;
  const auto reject = [&check](Certificate::Status status, std::string detail) {
    Certificate result = check ? check->result() : Certificate();
    result.status = status;
    result.detail = std::move(detail);
    return result;
  };
  try {
    using Status = Certificate::Status;
    if (belief.voxels == nullptr || belief.ground == nullptr) {
      return reject(Status::kNonFinite, "the belief has no map");
    }
    if (x0.size() != model.nx() || (inputs.cols() > 0 && inputs.rows() != model.nu())) {
      return reject(Status::kNonFinite, "the state or the inputs have the wrong size");
    }
    if (!x0.allFinite() || !inputs.allFinite() || !std::isfinite(dt) || !(dt > 0.0) ||
        !Check::usable(model.pose(x0))) {
      return reject(Status::kNonFinite, "the state, an input or the time step is not finite");
    }
    check.emplace(*this, belief, model, drift,
                  model.max_speed() * dt * static_cast<double>(inputs.cols()));
    check->spend(kPoseCost * static_cast<long long>(inputs.cols()));
    Eigen::VectorXd x = x0;
    if (!check->begin(model.pose(x))) return check->result();
    for (Eigen::Index n = 0; n < inputs.cols(); ++n) {
      if (!check->stage(x, inputs.col(n), static_cast<double>(n) * dt, dt)) return check->result();
    }
    char detail[40];
    std::snprintf(detail, sizeof detail, "clear for %.6g s", check->result().time);
    check->result().detail = detail;
    return check->result();
  } catch (const Exhausted&) {
    return reject(Certificate::Status::kOverBudget, over_budget(options_.max_checks));
  } catch (const std::exception& error) {
    return reject(Certificate::Status::kNonFinite,
                  std::string("the check failed: ") + error.what());
  }
}

Certificate Certifier::certify(const Belief& belief, const MotionModel& model,
                               const Eigen::Ref<const Eigen::VectorXd>& x0,
                               const Eigen::Ref<const Eigen::VectorXd>& u_previous,
                               const Eigen::Ref<const Eigen::MatrixXd>& committed, double dt,
                               const SurfaceDrift* drift) const {
  Certificate result;
  try {
    if (x0.size() != model.nx() || u_previous.size() != model.nu() ||
        (committed.cols() > 0 && committed.rows() != model.nu())) {
      result.detail = "the state or the inputs have the wrong size";
      return result;
    }
    if (!x0.allFinite() || !u_previous.allFinite() || !committed.allFinite() ||
        !std::isfinite(dt) || !(dt > 0.0)) {
      result.detail = "the state, an input or the time step is not finite";
      return result;
    }
    // More stages than can be afforded are not even simulated.
    const int affordable = max_stages();
    if (committed.cols() > affordable) {
      result.status = Certificate::Status::kOverBudget;
      result.detail = over_budget(options_.max_checks);
      return result;
    }
    Eigen::VectorXd x = x0;
    Eigen::VectorXd next(model.nx());
    Eigen::VectorXd u = u_previous;
    for (Eigen::Index n = 0; n < committed.cols(); ++n) {
      u = committed.col(n);
      model.step(x, u, dt, next);
      x.swap(next);
    }
    if (!x.allFinite()) {
      result.detail = "the motion leaves the finite numbers";
      return result;
    }
    const double wanted = std::ceil(options_.max_tail_time / dt);
    const int most = static_cast<int>(std::min<double>(affordable, wanted));
    const Eigen::MatrixXd tail = stopping_tail(model, x, u, dt, most);
    Eigen::MatrixXd inputs(model.nu(), committed.cols() + tail.cols());
    inputs << committed, tail;
    result = certify_inputs(belief, model, x0, inputs, dt, drift);
    if (!result.ok()) return result;
    if (options_.known_ground) {
      std::string unknown = unknown_ground_of(belief, body_->shape, model, x0, inputs, dt);
      if (!unknown.empty()) {
        result.status = Certificate::Status::kUnknownSpace;
        result.detail = std::move(unknown);
        return result;
      }
    }
    for (Eigen::Index n = 0; n < tail.cols(); ++n) {
      model.step(x, tail.col(n), dt, next);
      x.swap(next);
    }
    if (!is_at_rest(model.twist(x, tail.col(tail.cols() - 1)))) {
      const bool cut = affordable < wanted;
      result.status = cut ? Certificate::Status::kOverBudget : Certificate::Status::kNotStopping;
      result.detail = cut ? over_budget(options_.max_checks)
                          : "the stopping tail has not come to rest after " +
                                std::to_string(options_.max_tail_time) + " s";
    }
    return result;
  } catch (const std::exception& error) {
    result.status = Certificate::Status::kNonFinite;
    result.detail = std::string("the check failed: ") + error.what();
    return result;
  }
}

int Certifier::max_stages() const {
  constexpr long long kMost = 1'000'000;
  return static_cast<int>(std::clamp(options_.max_checks / (4 * kPoseCost), 1LL, kMost));
}

bool Certifier::in_collision(const Belief& belief, const Pose& pose, bool planar) const {
  if (!(pose.position.cwiseAbs().maxCoeff() < kFarthest) || !std::isfinite(pose.yaw)) return true;
  try {
    Budget budget(options_.max_checks);
    Scene scene(belief, options_.slice, planar, body_->extent(), {}, budget);
    return !scene.occupied(body_->exact, pose, 0.0, [](const Run&) { return false; });
  } catch (const Exhausted&) {
    return true;
  }
}

}  // namespace prospect
