// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/camera_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/world_mesh.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/stereo_matcher.h"
#include "tests/adapters/box_room.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::camera_rig_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

std::shared_ptr<const SceneRenderer> scene_of(const World& world, double quality = 1.0) {
  const FeatureField field(
      world, [&](int i, int j, int k) { return texture_density(world, i, j, k, 1); }, 1);
  return std::make_shared<const SceneRenderer>(world_mesh(world, field, {quality}));
}

/// Everything that is imperfect is off.
CameraRigOptions ideal() {
  CameraRigOptions options;
  options.vignetting = options.blur = options.read_noise = options.shot_noise = 0.0;
  options.depth_noise_constant = options.depth_noise_quadratic = options.depth_dropout = 0.0;
  return options;
}

TEST(CameraRig, IsAFunctionOfSeedFrameAndPose) {
  const World world = load_world("office_bare");
  const auto scene = scene_of(world);
  CameraRigOptions options;
  options.exposure_time = 0.01;
  const Twist twist{Vector3d::Zero(), 0.5};
  const CameraRig rig(scene, options);
  const ImagePair pair = rig.stereo(world.start, twist, 3);
  const DepthImage depth = rig.depth(world.start, 3);

  options.threads = 2;
  const CameraRig threaded(scene, options);
  threaded.stereo(world.start, {}, 4);  // what was taken before does not matter
  EXPECT_TRUE(depth.same(threaded.depth(world.start, 3)));
  const ImagePair again = threaded.stereo(world.start, twist, 3);
  EXPECT_EQ(pair.left.pixels, again.left.pixels);
  EXPECT_EQ(pair.right.pixels, again.right.pixels);

  EXPECT_NE(pair.left.pixels, rig.stereo(world.start, twist, 4).left.pixels);
  EXPECT_FALSE(depth.same(rig.depth(world.start, 4)));
  options.seed = 2;
  const CameraRig other(scene, options);
  EXPECT_NE(pair.left.pixels, other.stereo(world.start, twist, 3).left.pixels);
  EXPECT_NE(pair.right.pixels, other.stereo(world.start, twist, 3).right.pixels);
  EXPECT_FALSE(depth.same(other.depth(world.start, 3)));
}

TEST(CameraRig, NoiseHasTheVarianceAskedForAndIsWhite) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  const World world = load_world("office_bare");
  const auto scene = scene_of(world);
  CameraRigOptions options = ideal();
  options.read_noise = 3.0;
  options.shot_noise = 0.1;
  const CameraRig rig(scene, options);
  const ImagePair noisy = rig.stereo(world.start, {}, 0);
  const Isometry3d T_WC = camera_pose(world.start, options.stereo_mount);
  Isometry3d right = T_WC;
  right.translation() += T_WC.linear().col(0) * options.stereo.baseline;
  const std::vector<float> clean_left = scene->intensity(options.stereo.left, T_WC);
  const std::vector<float> clean_right = scene->intensity(options.stereo.left, right);
  const auto error = [](const Image& image, const std::vector<float>& clean, std::size_t n) {
    return (image.pixels[n] - clean[n]) / std::sqrt(9.0 + 0.1 * clean[n] + 1.0 / 12.0);
  };
  double sum = 0.0, squares = 0.0, neighbours = 0.0, cameras = 0.0;
  for (std::size_t n = 0; n + 1 < clean_left.size(); ++n) {
    const double e = error(noisy.left, clean_left, n);
    sum += e;
    squares += e * e;
    neighbours += e * error(noisy.left, clean_left, n + 1);
    cameras += e * error(noisy.right, clean_right, n);
  }
  const auto count = static_cast<double>(clean_left.size());
  EXPECT_NEAR(sum / count, 0.0, 0.01);
  EXPECT_NEAR(squares / count, 1.0, 0.02);
  EXPECT_NEAR(neighbours / count, 0.0, 0.01);
  EXPECT_NEAR(cameras / count, 0.0, 0.01);
}

TEST(CameraRig, ExposureVignettingAndBlur) {
  const World world = test::box_room(4.0, 4.0, 2.0, 0.1, 40.0);
  const auto scene = scene_of(world);
  const Image plain = CameraRig(scene, ideal()).stereo(world.start, {}, 0).left;
  CameraRigOptions options = ideal();
  options.exposure = 0.5;
  const Image dark = CameraRig(scene, options).stereo(world.start, {}, 0).left;
  options.exposure = 100.0;
  const Image bright = CameraRig(scene, options).stereo(world.start, {}, 0).left;
  options = ideal();
  options.vignetting = 0.4;
  const Image vignetted = CameraRig(scene, options).stereo(world.start, {}, 0).left;
  for (std::size_t n = 0; n < plain.pixels.size(); ++n) {
    ASSERT_NEAR(dark.pixels[n], 0.5 * plain.pixels[n], 1.0);
    ASSERT_EQ(bright.pixels[n], 255);
  }
  EXPECT_NEAR(vignetted.at(320, 240), plain.at(320, 240), 1);
  EXPECT_NEAR(vignetted.at(0, 0), 0.6 * plain.at(0, 0), 1.5);

  // A blurred image is as bright, and has less contrast between neighbours.
  options = ideal();
  options.blur = 2.0;
  const Image blurred = CameraRig(scene, options).stereo(world.start, {}, 0).left;
  const auto roughness = [](const Image& image, int du, int dv) {
    double sum = 0.0;
    for (int v = 10; v < image.height - 10; ++v) {
      for (int u = 10; u < image.width - 10; ++u) {
        const double d = image.at(u + du, v + dv) - image.at(u, v);
        sum += d * d;
      }
    }
    return sum;
  };
  EXPECT_LT(roughness(blurred, 1, 0), 0.5 * roughness(plain, 1, 0));
  EXPECT_LT(roughness(blurred, 0, 1), 0.5 * roughness(plain, 0, 1));
  double sum = 0.0;
  for (std::size_t n = 0; n < plain.pixels.size(); ++n) sum += blurred.pixels[n] - plain.pixels[n];
  EXPECT_NEAR(sum / static_cast<double>(plain.pixels.size()), 0.0, 0.1);

  // Motion blurs along the rows only, and by the turn only.
  options = ideal();
  options.exposure_time = 0.02;
  const CameraRig moving(scene, options);
  const Image swept = moving.stereo(world.start, {Vector3d::Zero(), 1.0}, 0).left;
  EXPECT_LT(roughness(swept, 1, 0), 0.4 * roughness(plain, 1, 0));
  EXPECT_GT(roughness(swept, 0, 1), 0.4 * roughness(plain, 0, 1));
  EXPECT_EQ(moving.stereo(world.start, {Vector3d(1, 0, 0), 0.0}, 0).left.pixels, plain.pixels);
}

TEST(CameraRig, MotionBlurIsTheMeanOverTheTurn) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  // Against the mean of sharp images from the yaws that the exposure sweeps.
  const World world = test::box_room(8.0, 8.0, 2.0, 0.1, 40.0);
  const auto scene = scene_of(world);
  CameraRigOptions options = ideal();
  const CameraRig sharp(scene, options);
  options.exposure_time = 0.02;
  const Twist twist{Vector3d::Zero(), 0.8};
  const Image blurred = CameraRig(scene, options).stereo(world.start, twist, 0).left;
  std::vector<double> sum(blurred.pixels.size());
  constexpr int kSteps = 16;
  for (int n = 0; n < kSteps; ++n) {
    Pose pose = world.start;
    pose.yaw += twist.yaw_rate * options.exposure_time * ((n + 0.5) / kSteps - 0.5);
    const Image image = sharp.stereo(pose, {}, 0).left;
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += image.pixels[k] / double{kSteps};
  }
  const Image still = sharp.stereo(world.start, {}, 0).left;
  double error = 0.0, without = 0.0;
  for (int v = 100; v < 380; ++v) {
    for (int u = 220; u < 420; ++u) {  // the middle: farther out the flow is larger
      const auto k = static_cast<std::size_t>(v * 640 + u);
      error += std::abs(blurred.pixels[k] - sum[k]);
      without += std::abs(still.pixels[k] - sum[k]);
    }
  }
  EXPECT_LT(error, 0.25 * without);
}

TEST(CameraRig, DepthNoiseAndWhatIsInvalid) {
  const World world = test::box_room(8.0, 8.0, 3.0);
  const auto scene = scene_of(world);
  CameraRigOptions options = ideal();
  options.footprint.max_range = 20.0;
  options.max_incidence = 1.6;
  Pose pose = world.start;
  pose.position.x() = 5.0;  // 3 m to the wall ahead
  const DepthImage clean = CameraRig(scene, options).depth(pose, 0);
  EXPECT_TRUE(
      std::none_of(clean.depth.begin(), clean.depth.end(), [](float z) { return std::isnan(z); }));
  options.depth_noise_constant = 0.002;
  options.depth_noise_quadratic = 0.003;
  options.depth_dropout = 0.1;
  const DepthImage noisy = CameraRig(scene, options).depth(pose, 0);
  double squares = 0.0;
  int invalid = 0, count = 0;
  for (std::size_t n = 0; n < clean.depth.size(); ++n) {
    if (std::isnan(noisy.depth[n])) {
      ++invalid;
      continue;
    }
    const double z = clean.depth[n], e = (noisy.depth[n] - z) / (0.002 + 0.003 * z * z);
    squares += e * e;
    ++count;
  }
  EXPECT_NEAR(squares / count, 1.0, 0.02);
  EXPECT_NEAR(invalid, 0.1 * static_cast<double>(clean.depth.size()), 1500);

  // Range and incidence, ray by ray.
  options = ideal();
  options.footprint.min_range = 1.0;
  options.footprint.max_range = 3.3;
  options.max_incidence = 1.2;
  const CameraRig rig(scene, options);
  std::vector<float> incidence;
  const Isometry3d T_WC = camera_pose(pose, options.depth_mount);
  const DepthImage truth = scene->depth(rig.depth_camera(), T_WC, 1, &incidence);
  const DepthImage measured = rig.depth(pose, 0);
  int seen = 0;
  for (int v = 0; v < truth.height; ++v) {
    for (int u = 0; u < truth.width; ++u) {
      const double range = truth.at(u, v) * pixel_ray(rig.depth_camera(), u, v).norm();
      const double angle = std::acos(incidence[static_cast<std::size_t>(v * truth.width + u)]);
      if (std::min({std::abs(range - 1.0), std::abs(range - 3.3), std::abs(angle - 1.2)}) < 1e-4) {
        continue;
      }
      const bool valid = range > 1.0 && range < 3.3 && angle < 1.2;
      ASSERT_EQ(!std::isnan(measured.at(u, v)), valid) << u << ' ' << v;
      if (valid) {
        ASSERT_EQ(measured.at(u, v), truth.at(u, v));
      }
      seen += valid;
    }
  }
  EXPECT_GT(seen, 10000);
  EXPECT_LT(seen, 300000);
}

TEST(CameraRig, DisparitiesAreThoseOfTheDepth) {
  const World world = load_world("office_bare");
  const auto scene = scene_of(world);
  const CameraRig rig(scene, {});  // noise and blur as they come
  const StereoCamera& stereo = rig.options().stereo;
  std::vector<double> errors;
  std::vector<double> signed_errors;
  for (int n = 0; n < 8; ++n) {
    Pose pose = world.start;
    pose.position.x() += 0.7 * n;
    pose.yaw = 0.8 * n;
    const ImagePair pair = rig.stereo(pose, {}, static_cast<std::uint64_t>(n));
    const DepthImage depth =
        scene->depth(stereo.left, camera_pose(pose, rig.options().stereo_mount));
    const auto points = detect_corners(pair.left.view());
    const auto matches =
        match_stereo(ImagePyramid(pair.left.view(), 5), ImagePyramid(pair.right.view(), 5), points);
    for (const StereoMatch& match : matches) {
      const Eigen::Vector2f& p = points[static_cast<std::size_t>(match.index)];
      const double z = depth.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
      const double error = match.disparity - stereo.left.fx * stereo.baseline / z;
      errors.push_back(std::abs(error));
      signed_errors.push_back(error);
    }
  }
  std::sort(errors.begin(), errors.end());
  ASSERT_GT(errors.size(), 400u);
  const double median = errors[errors.size() / 2];
  const double p90 = errors[errors.size() * 9 / 10];
  std::sort(signed_errors.begin(), signed_errors.end());
  const double bias = signed_errors[signed_errors.size() / 2];
  std::printf("%zu matches: disparity error median %.3f px, 90 %% below %.3f px, bias %.3f px\n",
              errors.size(), median, p90, bias);
  EXPECT_LT(median, 0.1);
  EXPECT_LT(p90, 0.4);
  EXPECT_LT(std::abs(bias), 0.03);
}

/// Corners on a square metre of a wall that is looked at from 1.5 m.
double corners_per_square_metre(double density, double quality) {
  const World world = test::box_room(8.0, 8.0, 3.0, 0.1, density);
  const CameraRig rig(scene_of(world, quality), {});
  CornerDetectorOptions options;
  options.cells = 3000;
  double corners = 0.0;
  constexpr int kViews = 6;
  for (int n = 0; n < kViews; ++n) {
    Pose pose;
    pose.position = {6.5, 2.0 + 0.8 * n, 0.75};  // the eye in the middle of the wall's height
    corners += static_cast<double>(
        detect_corners(rig.stereo(pose, {}, static_cast<std::uint64_t>(n)).left.view(), {}, options)
            .size());
  }
  const double seen = (640.0 / 450.0 * 1.5) * (480.0 / 450.0 * 1.5);
  return corners / kViews / seen;
}

TEST(CameraRig, CornersGrowWithTexture) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  const double rich = corners_per_square_metre(40.0, 1.0);
  const double medium = corners_per_square_metre(15.0, 1.0);
  const double poor = corners_per_square_metre(4.0, 1.0);
  const double faint = corners_per_square_metre(40.0, 0.08);
  const double blank = corners_per_square_metre(40.0, 0.0);
  const double none = corners_per_square_metre(0.0, 1.0);
  std::printf(
      "corners per m^2: density 40 %.0f, 15 %.0f, 4 %.0f, 0 %.1f; quality 0.08 %.0f, 0 "
      "%.1f\n",
      rich, medium, poor, none, faint, blank);
  EXPECT_GT(rich, 40.0);  // a mark has more than one corner
  EXPECT_GT(rich, 1.5 * medium);
  EXPECT_GT(medium, 2.0 * poor);
  EXPECT_GT(poor, 4.0);
  EXPECT_LT(faint, 0.7 * rich);
  EXPECT_EQ(blank, 0.0);
  EXPECT_EQ(none, 0.0);
}

TEST(CameraRig, MarksAreCornersFromHalfAMetreToFive) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  const World world = test::box_room(12.0, 12.0, 3.0, 0.1, 20.0);
  const CameraRig rig(scene_of(world), {});
  for (const double distance : {0.5, 1.0, 2.0, 3.5, 5.0}) {
    Pose pose;
    pose.position = {12.0 - distance, 6.0, 0.75};
    const Image image = rig.stereo(pose, {}, 0).left;
    CornerDetectorOptions options;
    options.cells = 3000;
    // Of the marks whose middle is in the image, those with a corner within their size.
    const FeatureField field(
        world, [&](int i, int j, int k) { return texture_density(world, i, j, k, 1); }, 1);
    const auto corners = detect_corners(image.view(), {}, options);
    const Isometry3d T_CW = camera_pose(pose, rig.options().stereo_mount).inverse();
    int marks = 0, found = 0;
    for (const Feature& feature : field.features()) {
      if (feature.normal.x() > -0.5) continue;
      const Vector3d p = T_CW * feature.position;
      if (p.z() <= 0.0) continue;
      const Eigen::Vector2d pixel = rig.options().stereo.left.project(p);
      if ((pixel - Eigen::Vector2d(320, 240)).cwiseAbs().x() > 290 ||
          std::abs(pixel.y() - 240) > 210) {
        continue;
      }
      ++marks;
      const double reach = 450.0 * 0.06 / p.z() + 3.0;
      found += std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector2f& c) {
        return (c.cast<double>() - pixel).norm() < reach;
      });
    }
    std::printf("%.1f m: %d of %d marks give a corner\n", distance, found, marks);
    EXPECT_GT(marks, 3);
    EXPECT_GE(found, 0.9 * marks);
  }
}

TEST(CameraRig, WithoutRealismItsEffectsDoNotMatter) {
  const World world = load_world("office_bare");
  const auto scene = scene_of(world);
  CameraRigOptions options, other;
  other.effects = scaled({.focal_length = 0.1, .rotation = 0.02, .people = 9.0}, 0.0);
  const CameraRig rig(scene, options), same(scene, other);
  const ImageMoment moment{3, 7.1, 1.0, 0.4};
  const ImagePair plain = rig.stereo(world.start, {Vector3d::Zero(), 0.4}, 3);
  const ImagePair pair = same.stereo(world.start, moment, {});
  EXPECT_EQ(plain.left.pixels, pair.left.pixels);
  EXPECT_EQ(plain.right.pixels, pair.right.pixels);
  EXPECT_TRUE(rig.depth(world.start, 3).same(same.depth(world.start, 3)));
}

TEST(CameraRig, ImagesAreThoseOfTheTrueCamerasAndTheRobotIsToldOthers) {
  const World world = load_world("office_bare");
  const auto scene = scene_of(world);
  CameraRigOptions options = ideal();
  options.effects.focal_length = 0.02;
  options.effects.rotation = 0.005;
  options.effects.mount = 0.01;
  options.effects.baseline = 0.05;
  const CameraRig rig(scene, options);
  EXPECT_EQ(rig.options().stereo.left.fx, StereoCamera().left.fx);
  EXPECT_EQ(rig.depth_camera().fx,
            depth_camera(options.footprint, options.depth_width, options.depth_height).fx);
  const ImagePair pair = rig.stereo(world.start, {}, 0);
  // By its parts.
  const TrueStereo stereo = true_stereo(options.stereo, options.effects,
                                        stream_seed(options.seed, NoiseStream::kTrueStereo));
  const Isometry3d T_WC =
      camera_pose(world.start, true_mount(options.stereo_mount, options.effects,
                                          stream_seed(options.seed, NoiseStream::kStereoMount)));
  EXPECT_EQ(pair.left.pixels, scene->grey(stereo.camera, T_WC).pixels);
  const Image right = scene->grey(stereo.camera, T_WC * stereo.T_LR);
  int apart = 0;
  for (std::size_t n = 0; n < right.pixels.size(); ++n) {
    apart += std::abs(right.pixels[n] - pair.right.pixels[n]) > 1;
  }
  EXPECT_LT(apart, 100);
  // Another mission, another camera.
  options.seed = 2;
  EXPECT_NE(CameraRig(scene, options).stereo(world.start, {}, 0).left.pixels, pair.left.pixels);
  // Depths are wrong by one factor, and seen from another mount.
  options.effects = scaled({}, 0.0);
  const DepthImage truth = CameraRig(scene, options).depth(world.start, 0);
  options.effects.baseline = 0.05;
  const DepthImage longer = CameraRig(scene, options).depth(world.start, 0);
  double factor = 0.0;
  for (std::size_t n = 0; n < truth.depth.size(); ++n) {
    if (!(truth.depth[n] < 3.0f)) continue;
    const double ratio = longer.depth[n] / truth.depth[n];
    if (factor == 0.0) factor = ratio;
    ASSERT_NEAR(ratio, factor, 1e-5);
  }
  EXPECT_NE(factor, 1.0);
  EXPECT_LT(std::abs(factor - 1.0), 3.6 * 0.05);
}

TEST(CameraRig, RefusesWhatMakesNoSense) {
  const auto scene = scene_of(test::box_room(2.0, 2.0));
  EXPECT_THROW(CameraRig(nullptr, {}), std::invalid_argument);
  const auto refused = [&](auto&& damage) {
    CameraRigOptions options;
    damage(options);
    EXPECT_THROW(CameraRig(scene, options), std::invalid_argument);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  refused([](CameraRigOptions& o) { o.blur = -1.0; });
  refused([](CameraRigOptions& o) { o.exposure = kNaN; });
  refused([](CameraRigOptions& o) { o.depth_width = 0; });
  refused([](CameraRigOptions& o) { o.depth_dropout = 1.1; });
  refused([](CameraRigOptions& o) { o.threads = 0; });
  refused([](CameraRigOptions& o) { o.footprint.max_range = 0.1; });
  // No image in perspective shows it.
  refused([](CameraRigOptions& o) { o.footprint.horizontal_fov = 2.0 * M_PI; });
  refused([](CameraRigOptions& o) { o.footprint.horizontal_fov = 3.1; });
  refused([](CameraRigOptions& o) { o.footprint.vertical_fov = 0.0; });
  refused([](CameraRigOptions& o) { o.stereo.baseline = 0.0; });
}

TEST(CameraRig, DepthCameraSeesTheFootprint) {
  const RgbdFootprint footprint;
  const PinholeCamera camera = depth_camera(footprint, 64, 48);
  // The outer borders of the outermost pixels.
  EXPECT_NEAR(std::atan2(camera.cx + 0.5, camera.fx), 0.5 * footprint.horizontal_fov, 1e-12);
  EXPECT_NEAR(std::atan2(63.5 - camera.cx, camera.fx), 0.5 * footprint.horizontal_fov, 1e-12);
  EXPECT_NEAR(std::atan2(camera.cy + 0.5, camera.fy), 0.5 * footprint.vertical_fov, 1e-12);
}

}  // namespace
}  // namespace prospect::camera_rig_test
