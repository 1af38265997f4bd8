#include "engine/footprint_visibility.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/exponential.h"

namespace prospect {
namespace {

// Regularises angles of a point at the sensor itself [m].
constexpr double kNear = 0.02;
// Beyond this exponent a sigmoid is below 1e-43, or 1 to the last bit; the clamp keeps products of
// six finite.
constexpr double kLargestExponent = 100.0;
// Looks with q < e^-24 = 4e-11 are not evaluated further.
constexpr double kNegligibleExponent = 24.0;

void check(bool ok, const char* what, double value, const char* expected) {
  if (!ok) {
    throw std::invalid_argument("footprint visibility: " + std::string(what) + " is " +
                                std::to_string(value) + "; expected " + expected);
  }
}

}  // namespace

FootprintVisibility::Scratch::Scratch(int points)
    : probability(points),
      d_x(points),
      d_y(points),
      d_z(points),
      seen(points),
      X(points),
      Y(points),
      Z(points),
      rho(points),
      r(points),
      e(6 * points),
      q(points) {}

FootprintVisibility::FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount,
                                         std::shared_ptr<const OcclusionTable> occlusion,
                                         const Options& options)
    : footprint_(footprint), mount_(mount), options_(options), occlusion_(std::move(occlusion)) {
  if (!occlusion_) throw std::invalid_argument("footprint visibility: no occlusion table given");
  prepare();
}

FootprintVisibility::FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount)
    : footprint_(footprint), mount_(mount) {
  prepare();
}

void FootprintVisibility::prepare() {
  constexpr double pi = std::numbers::pi;
  const RgbdFootprint& f = footprint_;
  check(f.horizontal_fov > 0.0 && f.horizontal_fov < pi, "horizontal_fov", f.horizontal_fov,
        "an angle in (0, pi) rad");
  check(f.vertical_fov > 0.0 && f.vertical_fov < pi, "vertical_fov", f.vertical_fov,
        "an angle in (0, pi) rad");
  check(f.min_range >= 0.0 && std::isfinite(f.min_range), "min_range", f.min_range, ">= 0 m");
  check(f.max_range > f.min_range && std::isfinite(f.max_range), "max_range", f.max_range,
        "more than min_range");
  check(options_.angle_scale > 0.0, "angle_scale", options_.angle_scale, "> 0 rad");
  check(options_.range_scale > 0.0, "range_scale", options_.range_scale, "> 0 m");
  check(options_.inset >= 0.0, "inset", options_.inset, ">= 0");
  const std::vector<Eigen::Vector3d> none;
  const std::vector<Eigen::Vector3d>& points = occlusion_ ? occlusion_->points() : none;
  const auto n = static_cast<Eigen::Index>(points.size());
  px_.resize(n);
  py_.resize(n);
  pz_.resize(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const Eigen::Vector3d& p = points[static_cast<std::size_t>(c)];
    px_[c] = p.x();
    py_[c] = p.y();
    pz_[c] = p.z();
  }
  sin_h_ = std::sin(0.5 * f.horizontal_fov);
  cos_h_ = std::cos(0.5 * f.horizontal_fov);
  sin_v_ = std::sin(0.5 * f.vertical_fov);
  cos_v_ = std::cos(0.5 * f.vertical_fov);
}

FootprintVisibility::View FootprintVisibility::view(const Pose& pose) const {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  Eigen::Matrix3d R_WB;
  R_WB << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  return {pose.position + R_WB * mount_.T_BC.translation(),
          (R_WB * mount_.T_BC.linear()).transpose()};
}

inline FootprintVisibility::Exponents FootprintVisibility::exponents(double X, double Y,
                                                                     double Z) const {
  const double inset = options_.inset;
  const double range = 1.0 / options_.range_scale;
  const auto clamped = [](double a) {
    const double b = a < kLargestExponent ? a : kLargestExponent;
    return b > -kLargestExponent ? b : -kLargestExponent;
  };
  Exponents e;
  const double rho2 = X * X + Z * Z + kNear * kNear;
  e.rho = std::sqrt(rho2);
  e.r = std::sqrt(rho2 + Y * Y);
  const double h = 1.0 / (options_.angle_scale * e.rho), v = 1.0 / (options_.angle_scale * e.r);
  const double h0 = inset - sin_h_ * Z * h, h1 = cos_h_ * X * h;
  const double v0 = inset - sin_v_ * e.rho * v, v1 = cos_v_ * Y * v;
  e.a0 = clamped(h0 + h1);
  e.a1 = clamped(h0 - h1);
  e.a2 = clamped(v0 + v1);
  e.a3 = clamped(v0 - v1);
  e.a4 = clamped(inset - (e.r - footprint_.min_range) * range);
  e.a5 = clamped(inset - (footprint_.max_range - e.r) * range);
  return e;
}

double FootprintVisibility::in_footprint(const Pose& pose, const Eigen::Vector3d& point) const {
  const View v = view(pose);
  const Eigen::Vector3d Y = v.R_CW * (point - v.position);
  if (!Y.allFinite()) return 0.0;
  const Exponents e = exponents(Y.x(), Y.y(), Y.z());
  double product = 1.0;
  for (const double a : {e.a0, e.a1, e.a2, e.a3, e.a4, e.a5}) product *= 1.0 + exponential(a);
  return 1.0 / product;
}

int FootprintVisibility::look(const View& view, Scratch& s) const {
  // A point whose occlusion probability is exactly 0 has q = 0, and a gradient of 0, exactly.
  int seen = 0;
  for (int c = 0; c < size(); ++c) {
    s.seen[seen] = c;
    seen += s.probability[c] > 0.0;
  }
  const Eigen::Matrix3d R = view.R_CW;
  const Eigen::Vector3d o = view.position;
  double* const __restrict X = s.X.data();
  double* const __restrict Y = s.Y.data();
  double* const __restrict Z = s.Z.data();
  for (int j = 0; j < seen; ++j) {
    const int c = s.seen[j];
    const double dx = px_[c] - o.x(), dy = py_[c] - o.y(), dz = pz_[c] - o.z();
    X[j] = R(0, 0) * dx + R(0, 1) * dy + R(0, 2) * dz;
    Y[j] = R(1, 0) * dx + R(1, 1) * dy + R(1, 2) * dz;
    Z[j] = R(2, 0) * dx + R(2, 1) * dy + R(2, 2) * dz;
  }
  double* const __restrict rho = s.rho.data();
  double* const __restrict r = s.r.data();
  const Eigen::Index stride = size();
  double* const __restrict e0 = s.e.data();
  double* const __restrict e1 = e0 + stride;
  double* const __restrict e2 = e1 + stride;
  double* const __restrict e3 = e2 + stride;
  double* const __restrict e4 = e3 + stride;
  double* const __restrict e5 = e4 + stride;
  double* const __restrict lost = s.q.data();
  const auto positive = [](double a) { return a > 0.0 ? a : 0.0; };
  for (int j = 0; j < seen; ++j) {
    const Exponents e = exponents(X[j], Y[j], Z[j]);
    rho[j] = e.rho;
    r[j] = e.r;
    e0[j] = e.a0;
    e1[j] = e.a1;
    e2[j] = e.a2;
    e3[j] = e.a3;
    e4[j] = e.a4;
    e5[j] = e.a5;
    // log(1 + e^a) >= max(a, 0)
    lost[j] = positive(e.a0) + positive(e.a1) + positive(e.a2) + positive(e.a3) + positive(e.a4) +
              positive(e.a5);
  }
  int kept = 0;
  for (int j = 0; j < seen; ++j) {
    s.seen[kept] = s.seen[j];
    X[kept] = X[j];
    Y[kept] = Y[j];
    Z[kept] = Z[j];
    rho[kept] = rho[j];
    r[kept] = r[j];
    e0[kept] = e0[j];
    e1[kept] = e1[j];
    e2[kept] = e2[j];
    e3[kept] = e3[j];
    e4[kept] = e4[j];
    e5[kept] = e5[j];
    kept += lost[j] < kNegligibleExponent;
  }
  seen = kept;
  for (double* const __restrict e : {e0, e1, e2, e3, e4, e5}) {
    for (int j = 0; j < seen; ++j) e[j] = exponential(e[j]);
  }
  double* const __restrict q = s.q.data();
  for (int j = 0; j < seen; ++j) {
    const double product = ((1.0 + e0[j]) * (1.0 + e1[j])) * ((1.0 + e2[j]) * (1.0 + e3[j])) *
                           ((1.0 + e4[j]) * (1.0 + e5[j]));
    q[j] = 1.0 / product;  // times the probability of no occlusion: by the caller
  }
  return seen;
}

void FootprintVisibility::evaluate(const Pose& pose, Scratch& s, double* q) const {
  const View v = view(pose);
  occlusion_->evaluate(v.position, s.probability.data());
  if (!v.position.allFinite() || !v.R_CW.allFinite()) {
    Eigen::Map<Eigen::ArrayXd>(q, size()).setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  const int seen = look(v, s);
  Eigen::Map<Eigen::ArrayXd>(q, size()).setZero();
  for (int j = 0; j < seen; ++j) q[s.seen[j]] = s.q[j] * s.probability[s.seen[j]];
}

Eigen::Vector4d FootprintVisibility::gradient(const Pose& pose, const double* weight,
                                              Scratch& s) const {
  const View v = view(pose);
  occlusion_->evaluate(v.position, s.probability.data(), s.d_x.data(), s.d_y.data(), s.d_z.data());
  if (!v.position.allFinite() || !v.R_CW.allFinite()) {
    return Eigen::Vector4d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  const int seen = look(v, s);
  const double angle = 1.0 / options_.angle_scale;
  const double range = 1.0 / options_.range_scale;
  // F = sum of dJ/dY_c over the points (Y_c in C), M = sum of Y_c x dJ/dY_c, O = the part through
  // the occlusion, with respect to the camera's position in W.
  const double* const e0 = s.e.data();
  const Eigen::Index stride = size();
  const double* const e1 = e0 + stride;
  const double* const e2 = e1 + stride;
  const double* const e3 = e2 + stride;
  const double* const e4 = e3 + stride;
  const double* const e5 = e4 + stride;
  double Fx = 0, Fy = 0, Fz = 0, Mx = 0, My = 0, Mz = 0, Ox = 0, Oy = 0, Oz = 0;
  for (int j = 0; j < seen; ++j) {
    const int c = s.seen[j];
    const double wq = weight[c] * s.q[j];
    Ox += wq * s.d_x[c];
    Oy += wq * s.d_y[c];
    Oz += wq * s.d_z[c];
    const double q = wq * s.probability[c];
    const double X = s.X[j], Y = s.Y[j], Z = s.Z[j];
    const double over_rho = 1.0 / s.rho[j], over_r = 1.0 / s.r[j];
    // dq/da = q (1 - s(a)) for each sigmoid; 1 - s(a) = e / (1 + e).
    const double a0 = q * e0[j] / (1.0 + e0[j]);
    const double a1 = q * e1[j] / (1.0 + e1[j]);
    const double a2 = q * e2[j] / (1.0 + e2[j]);
    const double a3 = q * e3[j] / (1.0 + e3[j]);
    const double a4 = q * e4[j] / (1.0 + e4[j]);
    const double a5 = q * e5[j] / (1.0 + e5[j]);
    const double h = angle * over_rho, u = angle * over_r;
    // (sin_h Z -+ cos_h X) / rho
    const double horizontal =
        (a0 * (sin_h_ * Z - cos_h_ * X) + a1 * (sin_h_ * Z + cos_h_ * X)) * over_rho;
    double gX = h * ((a1 - a0) * cos_h_ - horizontal * X * over_rho);
    double gZ = h * ((a0 + a1) * sin_h_ - horizontal * Z * over_rho);
    // (sin_v rho -+ cos_v Y) / r
    const double vertical =
        (a2 * (sin_v_ * s.rho[j] - cos_v_ * Y) + a3 * (sin_v_ * s.rho[j] + cos_v_ * Y)) * over_r;
    double gY = u * ((a3 - a2) * cos_v_ - vertical * Y * over_r);
    const double g_rho = u * ((a2 + a3) * sin_v_ - vertical * s.rho[j] * over_r) * over_rho;
    const double g_r = (a4 - a5) * range * over_r;
    gX += (g_rho + g_r) * X;
    gZ += (g_rho + g_r) * Z;
    gY += g_r * Y;
    Fx += gX;
    Fy += gY;
    Fz += gZ;
    Mx += Y * gZ - Z * gY;
    My += Z * gX - X * gZ;
    Mz += X * gY - Y * gX;
  }
  // Moving the camera by dc moves every point by -R_CW dc in C; turning it by d(yaw) about W's z
  // axis turns them by -d(yaw) about that axis and moves the camera along z x (camera - base).
  const Eigen::Vector3d by_camera =
      Eigen::Vector3d(Ox, Oy, Oz) - v.R_CW.transpose() * Eigen::Vector3d(Fx, Fy, Fz);
  const Eigen::Vector3d arm = v.position - pose.position;
  const double turning = -v.R_CW.col(2).dot(Eigen::Vector3d(Mx, My, Mz)) - by_camera.x() * arm.y() +
                         by_camera.y() * arm.x();
  return {by_camera.x(), by_camera.y(), by_camera.z(), turning};
}

}  // namespace prospect
