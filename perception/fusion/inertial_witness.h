// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <optional>
#include <string>

#include "models/imu_sample.h"
#include "perception/fusion/imu_integral.h"

namespace prospect {

class Knobs;

/// Standard deviations, each axis, of what an IMU measures, and what follows from them.
struct InertialOptions {
  double gyro_bias = 0.1;  ///< [rad/s] before any image: above the zero-rate offset of data sheets
  double bias_walk = 0.001;   ///< [rad/s per sqrt(s)]
  double gyro_noise = 0.005;  ///< [rad/s] of the mean between two images
  /// [1] of the turn: scale, axes that are mounted askew, stamps that are late.
  double gyro_share = 0.05;
  double acceleration = 0.3;  ///< [m/s^2] of what is left when gravity and bias are taken off
  double gate = 16.3;         ///< of a difference: chi^2_3, 0.999
  double max_gap = 0.05;      ///< [s] between samples; longer: nothing is measured
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, InertialOptions& options);

/// What a frame of visual odometry says of the body, to be held against the IMU.
struct SeenMotion {
  double stamp = 0.0;  ///< [s]
  Eigen::Isometry3d T_WB = Eigen::Isometry3d::Identity();
  /// Of its rotation since the frame before, in B [rad^2].
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  bool begins_map = false;  ///< nothing is known of the motion to this frame
  /// The same motion, B0 to B, by wheels; none: nobody says.
  std::optional<Eigen::Isometry3d> by_wheels{};
};

/// An IMU as a witness of how a body moves, beside its cameras: where it should be at the next
/// frame, whether what the cameras say can be, and which way is up.
///
/// State: the bias b of the gyro (each axis a Kalman filter of its own; vision measures it at every
/// frame that agrees), the specific force at rest c in W (gravity and the bias of the
/// accelerometer; likewise), and the velocity v of B in W at the newest frame. Between frames B0
/// and B, dt apart, with R, V, s of ImuIntegral:
///   R_B0B = R,   way in W: v dt + R_WB0 s - c dt^2 / 2,   v' = v + R_WB0 V - c dt.
///
/// Turn. e = log(R^T R_vision), S = (P_b + gyro_noise^2) dt^2 + (gyro_share |angle|)^2 + covariance
/// of vision and (2 mrad)^2. It disagrees if e^T S^-1 e > gate, from the frame before or over the
/// newest second, as a slow turn shows late.
/// Way. r = way - way of vision against v's variance, acceleration^2 dt^4 / 4 and (3 mm + 2 %)^2.
/// What moves before a camera that stands has it jump: it disagrees if r^2 > gate times that. From
/// then on vision may be what it follows, which moves by the sum of such jumps, u = -r / dt,
/// against the world. So each frame disagrees, by r = -u dt, until a jump takes it back (u^2 below
/// the gate), or after 5 s, when nobody knows any more.
///
/// Who is wrong? Vision may follow what moves, or the IMU is faulty: one as likely as the other. A
/// frame that disagrees is degraded at best, and e and r, as a twist in W, enter the covariance of
/// the pose by half their square, for good. Where wheels turn as vision does, the gyro is outvoted.
/// An IMU that was outvoted five times in a row, or has differed from five turns that vision saw
/// before it agreed with five, is not believed (complaint()) until it agrees with five turns; it
/// then says nothing.
///
/// Thread-safety: one thread. Errors: the constructor throws std::invalid_argument on an option out
/// of range; the rest never throws. Deterministic: same calls, same bits. Source: ours.
class InertialWitness {
 public:
  explicit InertialWitness(const InertialOptions& options = {});

  /// Why it is refused; empty: it is taken.
  std::string add(const ImuSample& sample) { return samples_.add(sample); }

  /// B at `stamp` in B at the newest frame that was measured: the turn as measured; the way as far
  /// as the velocity is known, else none. None: the IMU does not tell, or is not believed.
  std::optional<Eigen::Isometry3d> expected(double stamp) const;

  enum class Verdict { kUnknown, kAgrees, kDisagrees, kOutvoted };
  struct Judgement {
    Verdict verdict = Verdict::kUnknown;
    std::string reason;  ///< of kDisagrees
  };
  /// A frame that was measured. Those that were not are passed over.
  Judgement judge(const SeenMotion& seen);

  /// By what the covariance in C of the pose is larger, and that of the motion since then
  /// (OdometryFrame::covariance).
  Eigen::Matrix<double, 6, 6> doubt(const Eigen::Isometry3d& T_CW) const;
  using Twist6 = Eigen::Matrix<double, 6, 1>;
  Twist6 sum() const { return ended_sum_ + live_; }
  Eigen::Matrix<double, 6, 6> doubt_since(const Twist6& then, const Eigen::Isometry3d& T_CW) const;

  /// Empty, or why the IMU is not believed.
  std::string complaint() const;
  int contradicted() const { return contradicted_; }          ///< frames so far
  const Eigen::Vector3d& gyro_bias() const { return bias_; }  ///< in B [rad/s]
  double gyro_bias_sigma() const;                             ///< the largest [rad/s]
  /// Upwards in W by the accelerometer, if it is known to 2 degrees: against W's z how far the
  /// attitude has drifted, and the bias of the accelerometer.
  std::optional<Eigen::Vector3d> up_in_W() const;

 private:
  struct Frame {
    double stamp = 0.0;
    Eigen::Isometry3d T_WB;
  };
  struct Turn {
    Eigen::Vector3d error = Eigen::Vector3d::Zero();  // e
    double chi2 = 0.0, sigma = 0.0;
    double angle = 0.0, seen = 0.0;  // the larger one; that by vision
  };
  void begin(const SeenMotion& seen);
  std::optional<Turn> turn_since(const Frame& from, const SeenMotion& seen) const;
  void learn_bias(const Turn& turn, double dt, const Eigen::Matrix3d& vision);
  /// v dt + R s - c dt^2 / 2, and its variance.
  struct Way {
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    double variance = 0.0;
  };
  std::optional<Way> way_of(const ImuMotion& motion, const Frame& from) const;
  /// Whether vision jumps, or follows what it has jumped to; `missed`: r.
  bool jumped(const std::optional<Way>& by_imu, const Eigen::Vector3d& way, const ImuMotion& motion,
              double stamp, Eigen::Vector3d& missed);
  void take_velocity(const ImuMotion& motion, const Frame& from, const Eigen::Vector3d& way);
  void learn_rest_force(const ImuMotion& motion, const Frame& from, const Eigen::Vector3d& way);
  void count(bool informative, Verdict verdict);
  double position_sigma(const Eigen::Vector3d& way) const;

  InertialOptions options_;
  ImuIntegral samples_;
  std::deque<Frame> frames_;  // measured, of the newest second
  Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d bias_variance_;
  Eigen::Vector3d rest_force_ = Eigen::Vector3d::Zero();  // c
  double rest_variance_ = 0.0;                            // each axis; 0: c is not known
  std::optional<Eigen::Vector3d> velocity_;               // v
  double velocity_variance_ = 0.0;
  Eigen::Vector3d followed_ = Eigen::Vector3d::Zero();  // u, in W
  double followed_variance_ = 0.0, followed_since_ = 0.0;
  struct Before {  // the interval before, for c
    Eigen::Vector3d by_imu, velocity, way;
    double dt = 0.0;
  };
  std::optional<Before> before_;

  int agreed_ = 0, differed_ = 0, outvoted_ = 0;  // turns, in a row but for the first
  int contradicted_ = 0;
  bool believed_ = true;
  Twist6 live_ = Twist6::Zero(), ended_sum_ = Twist6::Zero();  // in W
  Eigen::Matrix<double, 6, 6> ended_ = Eigen::Matrix<double, 6, 6>::Zero();
};

}  // namespace prospect
