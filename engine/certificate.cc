#include "engine/certificate.h"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/utility.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <list>
#include <stdexcept>
#include <vector>

#include "engine/shape_geometry.h"
#include "models/body_transform.h"

namespace prospect {
namespace {

constexpr double kRestSpeed = 1e-3;      // [m/s] and [rad/s]
constexpr double kHeldTolerance = 1e-4;  // [m]

bool at_rest(const Twist& twist) {
  return twist.linear.norm() <= kRestSpeed && std::abs(twist.yaw_rate) <= kRestSpeed;
}

/// A vertical run of voxels: column (i, j), layers low..high inclusive.
struct Run {
  int i = 0, j = 0, low = 0, high = 0;
  friend bool operator==(const Run&, const Run&) = default;
};

/// Signed distance from a point to a box given by its lowest and highest corner.
double box_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& low,
                    const Eigen::Vector3d& high) {
  const Eigen::Vector3d out = (low - p).cwiseMax(p - high);
  return out.maxCoeff() <= 0.0 ? out.maxCoeff() : out.cwiseMax(0.0).norm();
}

/// One convex part of the body and the ball about its local bounding box.
struct Part {
  PlacedGeometry placed;
  Eigen::Vector3d ball_center;  // in B
  double ball_radius;
};

std::string at_time(double time, const Pose& pose) {
  char text[120];
  std::snprintf(text, sizeof text, "after %.2f s, at (%.2f, %.2f, %.2f) m, yaw %.2f rad", time,
                pose.position.x(), pose.position.y(), pose.position.z(), pose.yaw);
  return text;
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
  std::vector<Shell> shells;  // by drift; the first is for all columns
  double circumscribed = 0.0;
  double middle = 0.0;  // height of the body's middle in B

  static std::vector<Part> parts(const RobotShape& shape, double inflation) {
    std::vector<Part> result;
    for (PlacedGeometry& g : shape_geometry(shape, inflation)) {
      const Eigen::Vector3d center = g.T_BG * g.geometry->aabb_center;
      const double radius = g.geometry->aabb_radius;
      result.push_back({std::move(g), center, radius});
    }
    return result;
  }
};

namespace {

/// Walks the voxels near a body at a pose and asks FCL about them.
class Scene {
 public:
  Scene(const Belief& belief, const VerticalExtent& slice, bool planar, double middle)
      : voxels_(*belief.voxels), ground_(*belief.ground), planar_(planar), middle_(middle) {
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
    return box_distance(pose.position + Eigen::Vector3d(0.0, 0.0, middle_), low, high);
  }

  /// Calls visit(run) for every run of occupied voxels that a part touches, until it returns false.
  /// Returns whether all were visited.
  template <typename Visit>
  bool occupied(const std::vector<Part>& parts, const Pose& pose, const Visit& visit) const {
    return occupied(
        parts, pose, [](Cell) { return true; }, visit);
  }
  /// The same for the columns for which counts(cell) holds.
  template <typename Counts, typename Visit>
  bool occupied(const std::vector<Part>& parts, const Pose& pose, const Counts& counts,
                const Visit& visit) const {
    return each_column(parts, pose, [&](const Part& part, const Box& box, int i, int j) {
      if (!voxels_.frame().contains({i, j}) || !counts({i, j})) return true;
      for (int k = std::max(low_, box.k_low); k <= std::min(high_, box.k_high); ++k) {
        if (voxels_.state(i, j, k) != CellState::kOccupied) continue;
        Run run{i, j, k, k};
        while (run.low > low_ && voxels_.state(i, j, run.low - 1) == CellState::kOccupied) {
          --run.low;
        }
        while (run.high < high_ && voxels_.state(i, j, run.high + 1) == CellState::kOccupied) {
          ++run.high;
        }
        k = run.high;
        if (touches(part, box, run) && !visit(run)) return false;
      }
      return true;
    });
  }

  /// The same for unknown space and for all of cells where forgotten(cell) holds: columns of the
  /// slice (planar) or single voxels. Those for which skip(run) holds are not tested.
  template <typename Forgotten, typename Skip, typename Visit>
  bool unknown(const std::vector<Part>& parts, const Pose& pose, const Forgotten& forgotten,
               const Skip& skip, const Visit& visit) const {
    return each_column(parts, pose, [&](const Part& part, const Box& box, int i, int j) {
      const bool whole = forgotten(Cell{i, j});
      if (planar_) {
        const Run run{i, j, slice_low_, slice_high_};
        if ((ground_.explored({i, j}) && !whole) || skip(run)) return true;
        return !touches(part, box, run) || visit(run);
      }
      for (int k = box.k_low; k <= box.k_high; ++k) {
        const Run run{i, j, k, k};
        if ((voxels_.state(i, j, k) != CellState::kUnknown && !whole) || skip(run)) continue;
        if (touches(part, box, run) && !visit(run)) return false;
      }
      return true;
    });
  }

 private:
  /// Where a part stands at the pose looked at, and the voxels that its bounding box meets.
  struct Box {
    Eigen::Isometry3d T_WG;
    Eigen::Vector3d ball_center;
    int i_low, i_high, j_low, j_high, k_low, k_high;
  };

  template <typename Look>
  bool each_column(const std::vector<Part>& parts, const Pose& pose, const Look& look) const {
    const Eigen::Isometry3d T_WB = body_transform(pose);
    const double r = voxels_.resolution();
    for (const Part& part : parts) {
      Box box;
      box.T_WG = T_WB * part.placed.T_BG;
      box.ball_center = T_WB * part.ball_center;
      // Bounding box of the local bounding box, turned about z.
      const fcl::AABBd& local = part.placed.geometry->aabb_local;
      const Eigen::Vector3d half = 0.5 * (local.max_ - local.min_);
      const double c = std::abs(T_WB.linear()(0, 0));
      const double s = std::abs(T_WB.linear()(1, 0));
      const Eigen::Vector3d reach(std::min(c * half.x() + s * half.y(), part.ball_radius),
                                  std::min(s * half.x() + c * half.y(), part.ball_radius),
                                  half.z());
      const Eigen::Vector3d from = (box.ball_center - reach) / r;
      const Eigen::Vector3d to = (box.ball_center + reach) / r;
      box.i_low = static_cast<int>(std::floor(from.x()));
      box.i_high = static_cast<int>(std::floor(to.x()));
      box.j_low = static_cast<int>(std::floor(from.y()));
      box.j_high = static_cast<int>(std::floor(to.y()));
      box.k_low = static_cast<int>(std::floor(from.z()));
      box.k_high = static_cast<int>(std::floor(to.z()));
      for (int j = box.j_low; j <= box.j_high; ++j) {
        for (int i = box.i_low; i <= box.i_high; ++i) {
          if (!look(part, box, i, j)) return false;
        }
      }
    }
    return true;
  }

  bool touches(const Part& part, const Box& box, const Run& run) const {
    const Eigen::Vector3d low = low_corner(run);
    const Eigen::Vector3d high = high_corner(run);
    if (box_distance(box.ball_center, low, high) > part.ball_radius) return false;
    const fcl::Boxd obstacle(Eigen::Vector3d(high - low));
    fcl::Transform3d T = fcl::Transform3d::Identity();
    T.translation() = 0.5 * (low + high);
    const fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    fcl::collide(part.placed.geometry.get(), box.T_WG, &obstacle, T, request, result);
    return result.isCollision();
  }

  const VoxelGrid& voxels_;
  const GroundMap& ground_;
  bool planar_;
  double middle_;
  int low_ = 0, high_ = 0;              // layers in which occupied voxels count
  int slice_low_ = 0, slice_high_ = 0;  // planar: layers of the slice
};

/// What a motion has been found to touch so far, and what of that is excused.
class Walk {
 public:
  Walk(const Scene& scene, const std::vector<Part>& exact, UnknownPolicy policy,
       const SurfaceDrift* drift, double drift_limit)
      : scene_(scene),
        exact_(exact),
        body_(&exact),
        policy_(policy),
        drift_(drift),
        drift_limit_(drift_limit) {}

  /// Whether the body is free of the columns that may have drifted by `least` at least.
  bool free(const Pose& pose, const std::vector<Part>& body, double least) const {
    return scene_.occupied(
        body, pose,
        [&](Cell c) { return !(least > 0.0) || (drift_ != nullptr && drift_->sigma(c) >= least); },
        [](const Run&) { return false; });
  }
  /// From now on `body` has to be; it outlives the walk.
  void keep_free(const std::vector<Part>& body, double least) {
    if (least > 0.0) {
      widened_.push_back({&body, least});
    } else {
      body_ = &body;
    }
  }
  /// What the exact body touches at `pose` is excused.
  void excuse_contacts(const Pose& pose) {
    scene_.occupied(exact_, pose, [&](const Run& run) {
      if (find(run) == contacts_.end()) {
        contacts_.push_back({run, scene_.centre_distance(pose, run), false});
      }
      return true;
    });
  }
  void excuse_unknown(const Pose& pose) {
    if (policy_ == UnknownPolicy::kFree) return;
    scene_.unknown(
        exact_, pose, [this](Cell c) { return forgotten(c); }, [](const Run&) { return false; },
        [&](const Run& run) {
          excused_.push_back(run);
          return true;
        });
  }

  Certificate::Status step(const Pose& pose) {
    for (const Widened& widened : widened_) {
      if (!free(pose, *widened.body, widened.least)) return Certificate::Status::kCollision;
    }
    for (Contact& contact : contacts_) contact.touched = false;
    const bool clear = scene_.occupied(*body_, pose, [&](const Run& run) {
      const auto contact = find(run);
      if (contact == contacts_.end()) return false;
      contact->touched = true;
      const double distance = scene_.centre_distance(pose, run);
      if (distance < contact->distance - 1e-9) return false;
      contact->distance = distance;
      return true;
    });
    if (!clear) return Certificate::Status::kCollision;
    std::erase_if(contacts_, [](const Contact& contact) { return !contact.touched; });
    if (policy_ == UnknownPolicy::kFree) return Certificate::Status::kOk;
    const bool known = scene_.unknown(
        exact_, pose, [this](Cell c) { return forgotten(c); },
        [&](const Run& run) {
          return std::find(excused_.begin(), excused_.end(), run) != excused_.end();
        },
        [](const Run&) { return false; });
    return known ? Certificate::Status::kOk : Certificate::Status::kUnknownSpace;
  }

 private:
  struct Contact {
    Run run;
    double distance;
    bool touched;
  };
  struct Widened {
    const std::vector<Part>* body;
    double least;
  };
  /// Whether a cell has drifted so far since it was in view that what is there is unknown.
  bool forgotten(Cell c) const {
    return drift_ != nullptr && drift_limit_ > 0.0 && drift_->sigma(c) > drift_limit_;
  }
  std::vector<Contact>::iterator find(const Run& run) {
    return std::find_if(contacts_.begin(), contacts_.end(),
                        [&](const Contact& contact) { return contact.run == run; });
  }

  const Scene& scene_;
  const std::vector<Part>& exact_;
  const std::vector<Part>* body_;
  UnknownPolicy policy_;
  const SurfaceDrift* drift_;
  double drift_limit_;
  std::vector<Widened> widened_;
  std::vector<Contact> contacts_;
  std::vector<Run> excused_;
};

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
  } while (!at_rest(model.twist(state, u)) && static_cast<int>(inputs.size()) < max_steps &&
           state.allFinite());
  Eigen::MatrixXd tail(model.nu(), static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t n = 0; n < inputs.size(); ++n)
    tail.col(static_cast<Eigen::Index>(n)) = inputs[n];
  return tail;
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
  if (!(options.held >= 0.0 && options.held <= 1.0)) {
    throw std::invalid_argument("certifier: held is " + std::to_string(options.held) +
                                "; expected 0 to 1");
  }
  if (!(options.drift_margin >= 0.0) || !std::isfinite(options.drift_margin)) {
    throw std::invalid_argument("certifier: drift_margin is " +
                                std::to_string(options.drift_margin) + " m; expected >= 0");
  }
  if (!(options.drift_limit >= 0.0) || !std::isfinite(options.drift_limit)) {
    throw std::invalid_argument("certifier: drift_limit is " + std::to_string(options.drift_limit) +
                                " m; expected >= 0");
  }
  auto body = std::make_unique<Body>();
  body->shape = shape;
  body->exact = Body::parts(shape, 0.0);
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    const double drift = share * options.drift_margin;
    if (share > 0.0 && !(drift > 0.0)) break;
    const double margin = options.margin + drift;
    body->shells.push_back({margin, drift, Body::parts(shape, margin)});
  }
  body->circumscribed = circumscribed_radius(shape);
  const VerticalExtent extent = vertical_extent(shape);
  body->middle = 0.5 * (extent.z_min + extent.z_max);
  body_ = std::move(body);
}

Certifier::~Certifier() = default;
Certifier::Certifier(Certifier&&) noexcept = default;
Certifier& Certifier::operator=(Certifier&&) noexcept = default;

Certificate Certifier::certify_inputs(const Belief& belief, const MotionModel& model,
                                      const Eigen::Ref<const Eigen::VectorXd>& x0,
                                      const Eigen::Ref<const Eigen::MatrixXd>& inputs, double dt,
                                      const SurfaceDrift* drift) const {
  Certificate result;
  const auto reject = [&result](Certificate::Status status, std::string detail) {
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
    const auto usable = [](const Pose& pose) {
      return pose.position.allFinite() && std::isfinite(pose.yaw) &&
             pose.position.cwiseAbs().maxCoeff() < kFarthest;
    };
    if (!x0.allFinite() || !inputs.allFinite() || !std::isfinite(dt) || !(dt > 0.0) ||
        !usable(model.pose(x0))) {
      return reject(Status::kNonFinite, "the state, an input or the time step is not finite");
    }
    const bool planar = model.pose_layout().pz < 0;
    const Scene scene(belief, options_.slice, planar, body_->middle);
    Walk walk(scene, body_->exact, options_.unknown, drift, options_.drift_limit);
    const auto moved = [&](const Pose& a, const Pose& b) {
      const double turn = std::min(std::abs(b.yaw - a.yaw), M_PI);
      return (b.position - a.position).norm() + 2.0 * body_->circumscribed * std::sin(0.5 * turn);
    };

    Eigen::VectorXd x = x0;
    Eigen::VectorXd sub(model.nx());
    Pose checked = model.pose(x);
    std::list<std::vector<Part>> held;  // bodies of a robot that starts within a margin
    double margin = options_.margin;    // that is left of the first shell's
    for (const Body::Shell& shell : body_->shells) {
      if (shell.drift > 0.0 && drift == nullptr) break;
      double kept = shell.margin;
      if (walk.free(checked, shell.parts, shell.drift)) {
        walk.keep_free(shell.parts, shell.drift);
      } else if (walk.free(checked, body_->exact, shell.drift)) {
        double low = 0.0, high = shell.margin;
        while (high - low > kHeldTolerance) {
          const double middle = 0.5 * (low + high);
          (walk.free(checked, Body::parts(body_->shape, middle), shell.drift) ? low : high) =
              middle;
        }
        // Rounding must not keep a robot from turning on the spot.
        kept = std::max(0.0, options_.held * low - 0.1 * kHeldTolerance);
        held.push_back(Body::parts(body_->shape, kept));
        walk.keep_free(held.back(), shell.drift);
      } else {
        kept = 0.0;
        if (!(shell.drift > 0.0)) walk.excuse_contacts(checked);
      }
      if (!(shell.drift > 0.0)) margin = kept;
    }
    walk.excuse_unknown(checked);
    // Without a margin nothing covers the poses in between: they are spaced as for a quarter of it.
    const double spacing =
        std::min(2.0 * std::max(margin, 0.25 * options_.margin), 0.5 * belief.voxels->resolution());
    const auto check = [&](const Pose& pose, double time) {
      ++result.poses;
      result.time = time;
      result.pose = pose;
      result.status = walk.step(pose);
      if (result.status == Status::kCollision) {
        result.detail = "the body would touch an occupied voxel " + at_time(time, pose);
      } else if (result.status == Status::kUnknownSpace) {
        result.detail = "the body would enter unknown space " + at_time(time, pose);
      }
      return result.ok();
    };
    if (!check(checked, 0.0)) return result;

    // Enough poses for 100 m at the finest spacing; a longer stage is no motion of a robot.
    constexpr int kMaxPieces = 1 << 14;
    for (Eigen::Index n = 0; n < inputs.cols(); ++n) {
      const auto u = inputs.col(n);
      const auto speed = [&](const Eigen::VectorXd& state) {
        const Twist twist = model.twist(state, u);
        return twist.linear.norm() + body_->circumscribed * std::abs(twist.yaw_rate);
      };
      const double start = static_cast<double>(n) * dt;
      const Eigen::VectorXd x_start = x;
      model.step(x_start, u, dt, x);
      if (!x.allFinite() || !usable(model.pose(x))) {
        result.time = start;
        return reject(Status::kNonFinite, "the motion leaves the finite numbers");
      }
      // Pieces short enough by the speed at either end; a piece that turns out longer all the same
      // is halved on the spot.
      const double wanted = std::max(speed(x_start), speed(x)) * dt / spacing;
      if (!(wanted < kMaxPieces)) {
        result.time = start;
        return reject(Status::kNonFinite, "the motion is too fast to be checked");
      }
      const double piece = dt / std::max(1.0, std::ceil(wanted));
      double done = 0.0;
      double length = piece;
      while (done < dt) {
        const bool last = done + length >= dt * (1.0 - 1e-12);
        const double until = last ? dt : done + length;
        if (last) {
          sub = x;
        } else {
          model.step(x_start, u, until, sub);
        }
        const Pose pose = model.pose(sub);
        if (!usable(pose)) {
          result.time = start;
          return reject(Status::kNonFinite, "the motion leaves the finite numbers");
        }
        if (moved(checked, pose) > spacing * (1.0 + 1e-6) && until - done > piece / 64.0) {
          length = 0.5 * (until - done);
          continue;
        }
        if (!check(pose, start + until)) return result;
        checked = pose;
        done = until;
        length = piece;
      }
    }
    char detail[40];
    std::snprintf(detail, sizeof detail, "clear for %.6g s", result.time);
    result.detail = detail;
    return result;
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
    const int most = static_cast<int>(std::min(1e4, std::ceil(options_.max_tail_time / dt)));
    const Eigen::MatrixXd tail = stopping_tail(model, x, u, dt, most);
    Eigen::MatrixXd inputs(model.nu(), committed.cols() + tail.cols());
    inputs << committed, tail;
    result = certify_inputs(belief, model, x0, inputs, dt, drift);
    if (!result.ok()) return result;
    for (Eigen::Index n = 0; n < tail.cols(); ++n) {
      model.step(x, tail.col(n), dt, next);
      x.swap(next);
    }
    if (!at_rest(model.twist(x, tail.col(tail.cols() - 1)))) {
      result.status = Certificate::Status::kNotStopping;
      result.detail = "the stopping tail has not come to rest after " +
                      std::to_string(options_.max_tail_time) + " s";
    }
    return result;
  } catch (const std::exception& error) {
    result.status = Certificate::Status::kNonFinite;
    result.detail = std::string("the check failed: ") + error.what();
    return result;
  }
}

bool Certifier::in_collision(const Belief& belief, const Pose& pose, bool planar) const {
  if (!(pose.position.cwiseAbs().maxCoeff() < kFarthest) || !std::isfinite(pose.yaw)) return true;
  const Scene scene(belief, options_.slice, planar, body_->middle);
  return !scene.occupied(body_->exact, pose, [](const Run&) { return false; });
}

}  // namespace prospect
