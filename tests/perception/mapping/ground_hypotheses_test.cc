// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/ground_hypotheses.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/perception/depth_scene.h"

namespace prospect::ground_hypotheses_test {
namespace {

using test::DepthScene;

constexpr double kDegree = M_PI / 180.0;
const PinholeCamera kCamera{262.5, 262.5, 159.5, 119.5, 320.0, 240.0};

/// A flat surface within a box.
struct Surface {
  Eigen::Vector3d normal, point, low, high;

  static Surface level(double z, double x0, double x1, double y0 = -9.0, double y1 = 9.0) {
    return {Eigen::Vector3d::UnitZ(), {0, 0, z}, {x0, y0, z - 0.1}, {x1, y1, z + 0.1}};
  }
  /// Rises along +x from (x, 0, z) by `angle`.
  static Surface slope(double x, double z, double angle, double x1) {
    return {{-std::sin(angle), 0.0, std::cos(angle)}, {x, 0, z}, {x, -9, -9}, {x1, 9, 9}};
  }
  static Surface wall(double x) {
    return {-Eigen::Vector3d::UnitX(), {x, 0, 0}, {x - 0.1, -9, -9}, {x + 0.1, 9, 9}};
  }
};

/// Surfaces as a depth camera with noise sees them; only pixels that a search for the ground reads.
struct Scene {
  std::vector<Surface> surfaces;
  double noise = 0.002;  // of a depth z: noise z^2 [1/m]

  DepthImage view(const Eigen::Isometry3d& T_WC, std::uint64_t seed,
                  int stride = GroundPlaneOptions().stride) const {
    DepthImage image(320, 240);
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal;
    const Eigen::Vector3d eye = T_WC.translation();
    for (int v = stride / 2; v < 240; v += stride) {
      for (int u = stride / 2; u < 320; u += stride) {
        const Eigen::Vector3d ray = T_WC.linear() * pixel_ray(kCamera, u, v);
        double z = 1e9;
        for (const Surface& s : surfaces) {
          const double t = s.normal.dot(s.point - eye) / s.normal.dot(ray);
          const Eigen::Vector3d p = eye + t * ray;
          if (t > 0.0 && t < z && ((p - s.low).array() >= 0.0).all() &&
              ((s.high - p).array() >= 0.0).all()) {
            z = t;
          }
        }
        image.at(u, v) = static_cast<float>(z + noise * z * z * normal(generator));
      }
    }
    return image;
  }
};

/// A recording's world, whose axes point anywhere.
Eigen::Isometry3d anywhere() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.rotate(Eigen::AngleAxisd(2.0, Eigen::Vector3d(0.6, -0.5, 0.3).normalized()));
  T.translation() << 0.4, -3.0, 1.1;
  return T;
}

/// A run of the hypotheses over frames, one call each.
struct Watch {
  GroundHypotheses ground;
  std::uint64_t seed = 1;
  int changes = 0, doubtful = 0;

  explicit Watch(const GroundHypothesesOptions& options = {}) : ground(kCamera, options) {}

  GroundObservation see(const DepthImage& image, const Eigen::Isometry3d& T_WC) {
    const GroundObservation view = ground.add(image, anywhere() * T_WC);
    changes += view.changed;
    doubtful += view.doubtful;
    return view;
  }
  GroundObservation see(const Scene& scene, const Eigen::Isometry3d& T_WC) {
    return see(scene.view(T_WC, ++seed), T_WC);
  }
  /// Of the plane taken; of the first camera.
  double height() const {
    return ground.taken() == nullptr ? std::nan("") : ground.taken()->height;
  }
  double pitch() const {
    return ground.taken() == nullptr ? std::nan("") : ground.taken()->pitch / kDegree;
  }
  std::string told() const {
    std::string text;
    for (const GroundHypothesis& h : ground.all()) {
      text += std::to_string(h.number) + ": " + std::to_string(h.height) + " m, " +
              std::to_string(h.frames) + " frames, " + h.why + "\n";
    }
    return text;
  }
  bool rejected(const std::string& why) const {
    for (const GroundHypothesis& h : ground.all()) {
      if (!h.taken && h.why.find(why) != std::string::npos) return true;
    }
    return false;
  }
};

/// Frame k of a walk along +x.
Eigen::Isometry3d walk(int k, double height = 1.4, double pitch = 30.0, double roll = 0.0) {
  return DepthScene::looking(0.12 * k, 0.02 * (k % 3), height, 0.01 * k, pitch * kDegree,
                             roll * kDegree);
}

TEST(GroundHypotheses, NoneIsBelievedFromOneView) {
  const Scene scene{{Surface::level(0.0, -9, 9)}};
  Watch run;
  EXPECT_FALSE(run.see(scene, walk(0)).changed);
  EXPECT_EQ(run.ground.taken(), nullptr);
  ASSERT_EQ(run.ground.all().size(), 1U);
  EXPECT_EQ(run.ground.all()[0].why, "seen in 1 frames, 3 must agree");
  // One view is not worth millimetres.
  EXPECT_GT(run.ground.all()[0].sigma_height, 0.009);
  EXPECT_GT(run.ground.all()[0].sigma_tilt, 0.009);
  run.see(scene, walk(1));
  EXPECT_TRUE(run.see(scene, walk(2)).changed);
  ASSERT_NE(run.ground.taken(), nullptr);
  EXPECT_NEAR(run.height(), 1.4, 0.005);
  EXPECT_NEAR(run.pitch(), 30.0, 0.5);
  EXPECT_EQ(run.ground.taken()->frames, 3);
}

TEST(GroundHypotheses, ATableFirstTheFloorLater) {
  const Scene scene{{Surface::level(0.0, -9, 9), Surface::level(0.99, -1, 1.4)}};
  for (const int table : {3, 12}) {  // frames that show the table alone
    Watch run;
    for (int k = 0; k < table; ++k) run.see(scene, walk(k % 4, 1.4, 50.0));
    EXPECT_NEAR(run.height(), 0.41, 0.01) << run.told();
    for (int k = 0; k < 5; ++k) run.see(scene, walk(6 + k, 1.4, 35.0));
    EXPECT_NEAR(run.height(), 1.40, 0.02) << run.told();
    EXPECT_EQ(run.changes, 2);
    EXPECT_EQ(run.doubtful, 2);  // until three frames agree on the floor
    EXPECT_TRUE(run.rejected("lies 0.99 m below it")) << run.told();
  }
}

// A tenth of the image shows the floor beside the table.
TEST(GroundHypotheses, ATableWithALittleFloorBesideIt) {
  const Scene scene{{Surface::level(0.0, -9, 9), Surface::level(0.75, -1, 1.45)}};
  Watch run;
  for (int k = 0; k < 4; ++k) run.see(scene, walk(0, 1.4, 40.0 - 0.3 * k));
  EXPECT_NEAR(run.height(), 1.40, 0.03) << run.told();
}

TEST(GroundHypotheses, ARampIsNotTheGround) {
  for (const double angle : {10.0, -10.0}) {
    const Scene scene{{Surface::level(0.0, -9, 1.9), Surface::slope(1.9, 0.0, angle * kDegree, 9)}};
    Watch run;
    for (int k = 0; k < 10; ++k) run.see(scene, walk(k, 0.62, 18.0));
    EXPECT_NEAR(run.height(), 0.62, 0.01) << run.told();
    EXPECT_NEAR(run.pitch(), 18.0, 1.0);
    EXPECT_EQ(run.changes, 1) << run.told();
  }
}

// Two storeys of floor in view: the lower one, unless the camera is said to stand on the upper one.
TEST(GroundHypotheses, OfStepsTheLowerOne) {
  const Scene scene{{Surface::level(0.0, -9, 1.5), Surface::level(-0.3, 1.5, 9)}};
  Watch run;
  const auto at = [](int k) {
    return DepthScene::looking(0.04 * k, 0.0, 0.8, 0.01 * k, 30.0 * kDegree);
  };
  for (int k = 0; k < 6; ++k) run.see(scene, at(k));
  EXPECT_NEAR(run.height(), 1.10, 0.03) << run.told();
  GroundHypothesesOptions options;
  options.height = 0.8;
  Watch told(options);
  for (int k = 0; k < 6; ++k) told.see(scene, at(k));
  EXPECT_NEAR(told.height(), 0.80, 0.02) << told.told();
  EXPECT_TRUE(told.rejected("is said to be 0.80 +- 0.05 m high")) << told.told();
}

// Looking up by 45 degrees a wall is where the ground is expected to be.
TEST(GroundHypotheses, AWallThatLooksLikeTheGround) {
  const Scene scene{{Surface::level(0.0, -9, 2.5), Surface::wall(2.5)}};
  Watch run;
  for (int k = 0; k < 4; ++k) run.see(scene, DepthScene::looking(1.5, 0, 0.9, 0, -45.0 * kDegree));
  ASSERT_NE(run.ground.taken(), nullptr);
  EXPECT_LT(run.pitch(), 60.0);
  for (int k = 0; k < 10; ++k) run.see(scene, walk(-k, 0.9, 25.0));
  EXPECT_NEAR(run.pitch(), -45.0, 1.0) << run.told();
  EXPECT_NEAR(run.height(), 0.9, 0.02) << run.told();
}

TEST(GroundHypotheses, ACameraTiltedBy30Degrees) {
  const Scene scene{{Surface::level(0.0, -9, 9), Surface::wall(4.0)}};
  for (const double roll : {30.0, -30.0, 0.0}) {
    const double pitch = roll == 0.0 ? 30.0 : 20.0;
    Watch run;
    for (int k = 0; k < 4; ++k) run.see(scene, walk(k, 1.0, pitch, roll));
    ASSERT_NE(run.ground.taken(), nullptr) << roll;
    EXPECT_NEAR(run.height(), 1.0, 0.01);
    EXPECT_NEAR(run.pitch(), pitch, 0.5);
    EXPECT_NEAR(run.ground.taken()->roll / kDegree, roll, 0.7);
  }
}

TEST(GroundHypotheses, WithoutAFloorNoneIsTaken) {
  const Scene scene{{Surface::wall(1.5)}};
  Watch run;
  std::string reason;
  for (int k = 0; k < 4; ++k) {
    reason = run.see(scene, DepthScene::looking(0.1 * k, 0, 1.2, 0)).reason;
    EXPECT_FALSE(reason.empty());
  }
  EXPECT_EQ(run.ground.taken(), nullptr);
  EXPECT_FALSE(run.ground.settle());
}

TEST(GroundHypotheses, TheFirstFramesAreDegraded) {
  const Scene scene{{Surface::level(0.0, -9, 9), Surface::wall(4.5)}};
  Watch run;
  const Eigen::Isometry3d T = walk(0, 0.62, 20.0);
  const DepthImage first = scene.view(T, 1);
  EXPECT_EQ(run.see(DepthImage(320, 240), T).reason, "no depth");
  EXPECT_EQ(run.see(DepthImage(160, 120, 1.0F), T).reason, "the image has the wrong size");
  DepthImage half = first;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 160; ++u) half.at(u, v) = DepthImage::kInvalid;
  }
  run.see(half, T);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(run.see(half, walk(k, 0.62)).reason, "the image is frozen");
  }
  Eigen::Isometry3d wild = T;
  wild.translation().x() = std::nan("");
  EXPECT_EQ(run.see(first, wild).reason, "the pose is no rotation and translation");
  EXPECT_EQ(run.ground.taken(), nullptr);
  // Depths in a wrong unit: a plane where a lower floor could be.
  for (int k = 0; k < 3; ++k) {
    DepthImage wrong = scene.view(walk(k, 0.62, 20.0), 50 + static_cast<std::uint64_t>(k));
    for (float& z : wrong.depth) z *= 2.5F;
    run.see(wrong, walk(k, 0.62, 20.0));
  }
  for (int k = 0; k < 8; ++k) run.see(scene, walk(k, 0.62, 20.0));
  EXPECT_NEAR(run.height(), 0.62, 0.01) << run.told();
}

// A tenth of the pixels shows the room's mirror image below the floor.
TEST(GroundHypotheses, AReflectionIsNotTheGround) {
  const Scene scene{{Surface::level(0.0, -9, 9)}};
  Watch run;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Isometry3d T = walk(k, 0.62, 25.0);
    DepthImage image = scene.view(T, static_cast<std::uint64_t>(k));
    std::mt19937 generator(static_cast<std::uint32_t>(k));
    for (float& z : image.depth) {
      if (generator() % 10 == 0) z *= 1.8F;
    }
    run.see(image, T);
  }
  EXPECT_NEAR(run.height(), 0.62, 0.01) << run.told();
  EXPECT_EQ(run.changes, 1) << run.told();
  EXPECT_TRUE(run.rejected("seen through")) << run.told();
}

// What is stated is a measurement with its standard deviation, and a limit at three of them.
TEST(GroundHypotheses, TheHeightStatedIsAPrior) {
  const Scene scene{{Surface::level(0.0, -9, 9)}};
  const auto height = [&](double stated, double sigma) {
    GroundHypothesesOptions options;
    options.height = stated;
    options.sigma_height = sigma;
    Watch run(options);
    for (int k = 0; k < 3; ++k) run.see(scene, walk(k, 1.4));
    if (run.ground.taken() == nullptr) {
      EXPECT_TRUE(run.rejected("the camera is said to be")) << run.told();
    }
    return run.height();
  };
  EXPECT_NEAR(height(1.45, 0.05), 1.40, 0.01);
  EXPECT_NEAR(height(1.42, 0.0005), 1.42, 0.005);  // surer than the views
  EXPECT_TRUE(std::isnan(height(1.7, 0.05)));
  EXPECT_NEAR(height(1.7, 0.15), 1.40, 0.01);
}

TEST(GroundHypotheses, WithoutPoses) {
  const Scene scene{{Surface::level(0.0, -9, 9)}};
  GroundHypothesesOptions options;
  options.poses = false;
  GroundHypotheses ground(kCamera, options);
  for (int k = 0; k < 8; ++k) {
    ground.add(scene.view(walk(k, 0.62, 20.0), static_cast<std::uint64_t>(k)),
               Eigen::Isometry3d::Identity());
  }
  ASSERT_NE(ground.taken(), nullptr);
  EXPECT_NEAR(ground.taken()->height, 0.62, 0.005);
  EXPECT_NEAR(ground.taken()->pitch / kDegree, 20.0, 0.3);
  EXPECT_GT(ground.taken()->sigma_height, 0.009);  // the same view, again and again
}

TEST(GroundHypotheses, OfFewFramesTheBestThereIs) {
  const Scene scene{{Surface::level(0.0, -9, 9)}};
  Watch run;
  run.see(scene, walk(0));
  EXPECT_TRUE(run.ground.settle());
  ASSERT_NE(run.ground.taken(), nullptr);
  EXPECT_EQ(run.ground.taken()->why, "the best there is: seen in 1 frames, 3 should agree");
  EXPECT_FALSE(run.ground.settle());
}

// Poses that are off by a tilt and a height of their own in each frame, as large as one view is
// taken to be off, and half and twice of that. The floor is flat besides, which is not known.
TEST(GroundHypotheses, ClaimsHold) {
  const Scene scene{{Surface::level(0.0, -9, 9)}};
  GroundHypothesesOptions options;
  options.ground.stride = options.ground.score_stride;  // cheaper
  const auto nees = [&](int frames, double times, double& height, double& tilt) {
    constexpr int kTrials = 30;
    height = tilt = 0.0;
    std::mt19937_64 generator(static_cast<std::uint64_t>(frames));
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < kTrials; ++trial) {
      GroundHypotheses ground(kCamera, options);
      const Eigen::Vector3d up = walk(0, 0.9, 30.0).linear().row(2).transpose();
      for (int k = 0; k < frames; ++k) {
        const Eigen::Isometry3d T = walk(k, 0.9, 30.0);
        Eigen::Isometry3d off = T;
        off.linear() =
            Eigen::AngleAxisd(0.01 * times * normal(generator), Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(0.01 * times * normal(generator), Eigen::Vector3d::UnitY()) *
            T.linear();
        off.translation().z() += 0.01 * times * normal(generator);
        ground.add(scene.view(off, generator(), options.ground.stride), anywhere() * T);
      }
      ground.settle();
      ASSERT_NE(ground.taken(), nullptr);
      const GroundHypothesis& h = *ground.taken();
      const Eigen::Vector3d n =
          walk(0).linear().transpose() * anywhere().linear().transpose() * h.normal;
      const Eigen::Vector3d t1 = (Eigen::Vector3d::UnitX() - n.x() * n).normalized();
      const Eigen::Vector2d e(up.dot(t1), up.dot(n.cross(t1)));
      const Eigen::Matrix2d C = h.covariance.topLeftCorner<2, 2>();
      tilt += 0.5 * e.dot(C.inverse() * e) / kTrials;
      height += std::pow((h.height - 0.9) / h.sigma_height, 2) / kTrials;
    }
  };
  for (const auto& [frames, times] : {std::pair{1, 1.0}, {8, 1.0}, {8, 0.5}, {8, 2.0}}) {
    double height = 0.0, tilt = 0.0;
    nees(frames, times, height, tilt);
    std::printf("%d frames, %.2f times off: NEES of the height %.2f, of the tilt %.2f\n", frames,
                times, height, tilt);
    EXPECT_GT(height, 0.1);
    EXPECT_LT(height, 2.0);
    EXPECT_GT(tilt, 0.1);
    EXPECT_LT(tilt, 2.0);
  }
}

// A floor of which a piece is seen at an angle, from places near each other, and which is not quite
// flat: looks at the same bumps do not make it better known.
TEST(GroundHypotheses, ClaimsHoldOfAPieceThatIsSeenAgainAndAgain) {
  GroundHypothesesOptions options;
  options.ground.stride = options.ground.score_stride;  // cheaper
  constexpr int kTrials = 30, kFrames = 12;
  double height = 0.0, tilt = 0.0;
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> any(0.0, 2.0 * M_PI);
  for (int trial = 0; trial < kTrials; ++trial) {
    const double size = 0.8 + 0.1 * (trial % 5);  // [m]
    const Scene scene{{Surface::level(0.0, 2.0, 2.0 + size, -0.5 * size, 0.5 * size)}};
    const double along = any(generator), across = any(generator);
    const auto bump = [&](const Eigen::Vector3d& p) {
      return 0.008 * (std::sin(7.0 * p.x() + along) + std::sin(7.0 * p.y() + across));
    };
    GroundHypotheses ground(kCamera, options);
    for (int k = 0; k < kFrames; ++k) {
      const Eigen::Isometry3d T = walk(k, 1.4, 30.0);
      DepthImage image = scene.view(T, generator(), options.ground.stride);
      for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
          float& z = image.at(u, v);
          if (!(z > 0.0f && z < 9.0f)) continue;
          // A rise of the floor by b shows nearer by the share b / h of its depth.
          z *= static_cast<float>(1.0 - bump(T * (z * pixel_ray(kCamera, u, v))) / 1.4);
        }
      }
      ground.add(image, anywhere() * T);
    }
    ground.settle();
    ASSERT_NE(ground.taken(), nullptr) << ground.all().size();
    const GroundHypothesis& h = *ground.taken();
    const Eigen::Matrix3d to_first =
        walk(0, 1.4, 30.0).linear().transpose() * anywhere().linear().transpose();
    const Eigen::Vector3d n = to_first * h.normal;
    const Eigen::Vector3d up = walk(0, 1.4, 30.0).linear().row(2).transpose();
    Eigen::Vector3d t1, t2;
    ground_tangents(n, t1, t2);
    const Eigen::Vector2d e(up.dot(t1), up.dot(t2));
    tilt += 0.5 * e.dot(h.covariance.topLeftCorner<2, 2>().inverse() * e) / kTrials;
    height += std::pow((h.height - 1.4) / h.sigma_height, 2) / kTrials;
  }
  std::printf("NEES of the height %.2f, of the tilt %.2f\n", height, tilt);
  EXPECT_LT(height, 2.0);
  EXPECT_LT(tilt, 2.0);
  EXPECT_GT(tilt, 0.1);  // not by claiming nothing
}

TEST(GroundHypotheses, OfGarbageNoneIsTaken) {
  std::mt19937_64 generator(9);
  const float inf = std::numeric_limits<float>::infinity();
  const float special[] = {DepthImage::kInvalid, 0.0F, inf, -inf, 1e38F, -1.0F, 0.5F, 3.0F};
  const PinholeCamera small{40.0, 40.0, 32.0, 24.0, 64.0, 48.0};
  GroundHypotheses ground(small);
  for (int n = 0; n < 40; ++n) {
    DepthImage image(64, 48);
    for (float& z : image.depth) {
      z = generator() % 3 == 0 ? special[generator() % 8]
                               : 0.3F + 1e-3F * static_cast<float>(generator() % 4000);
    }
    if (generator() % 16 == 0) image.depth.pop_back();
    Eigen::Isometry3d T = DepthScene::looking(0, 0, 0.6, 0.01 * n, 0.3);
    if (generator() % 10 == 0) T.translation().x() = 1e300;
    ASSERT_NO_THROW(ground.add(image, T));
  }
  EXPECT_EQ(ground.taken(), nullptr);
}

TEST(GroundHypotheses, SameFramesSameBits) {
  const Scene scene{{Surface::level(0.0, -9, 9), Surface::level(0.75, -1, 1.45)}};
  Watch a, b;
  for (int k = 0; k < 5; ++k) {
    a.see(scene, walk(k));
    b.see(scene, walk(k));
  }
  ASSERT_NE(a.ground.taken(), nullptr);
  EXPECT_EQ(a.ground.taken()->normal, b.ground.taken()->normal);
  EXPECT_EQ(a.ground.taken()->offset, b.ground.taken()->offset);
  EXPECT_EQ(a.told(), b.told());
}

}  // namespace
}  // namespace prospect::ground_hypotheses_test
