// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/image_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/exposure_control.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "models/types.h"

namespace prospect::image_sensor_test {
namespace {

/// No noise, no lens, no effect.
CameraRigOptions plain() {
  CameraRigOptions options;
  options.vignetting = options.blur = options.read_noise = options.shot_noise = 0.0;
  return options;
}

const Eigen::Isometry3d kAhead = camera_pose(Pose(), CameraMount());

std::vector<float> grey_wall(const PinholeCamera& camera, float grey) {
  return std::vector<float>(static_cast<std::size_t>(camera.width * camera.height), grey);
}

double mean(const Image& image) {
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) /
         static_cast<double>(image.pixels.size());
}

double mean_of_row(const Image& image, int v) {
  const auto row = image.pixels.begin() + static_cast<std::ptrdiff_t>(v) * image.width;
  return std::accumulate(row, row + image.width, 0.0) / image.width;
}

TEST(ImageSensor, TheExposureFollowsTheLightWithItsLag) {
  CameraRigOptions options = plain();
  options.effects.exposure_lag = 0.3;
  const ImageSensor sensor(options, options.stereo.left, 0);
  ExposureControl control(options.effects.exposure_lag);
  const auto seen = [&](double stamp, float light) {
    const Image image = sensor.image(grey_wall(options.stereo.left, light), kAhead,
                                     {.stamp = stamp, .exposure = control.exposure()});
    control.measured(stamp, image);
    return mean(image);
  };
  double stamp = 0.0;
  for (int n = 0; n < 40; ++n) seen(stamp += 0.1, 150.0f);
  EXPECT_NEAR(seen(stamp += 0.1, 150.0f), ExposureControl::kWanted, 1.0);
  // Half the light: half as bright at first, and after the lag off by 1/e of its logarithm.
  EXPECT_NEAR(seen(stamp += 0.1, 75.0f), 0.5 * ExposureControl::kWanted, 1.5);
  seen(stamp += 0.1, 75.0f);
  seen(stamp += 0.1, 75.0f);
  EXPECT_NEAR(seen(stamp += 0.1, 75.0f), ExposureControl::kWanted * std::exp2(-std::exp(-1.0)),
              1.5);
  for (int n = 0; n < 40; ++n) seen(stamp += 0.1, 75.0f);
  EXPECT_NEAR(seen(stamp += 0.1, 75.0f), ExposureControl::kWanted, 1.0);

  ExposureControl fixed(0.0);
  fixed.measured(1.0, Image(4, 4, 20));
  EXPECT_EQ(fixed.exposure(), 1.0);
}

TEST(ImageSensor, MotionBlurIsAsLongAsTheExposure) {
  CameraRigOptions options = plain();
  options.effects.shutter = 0.01;
  const PinholeCamera& camera = options.stereo.left;
  const ImageSensor sensor(options, camera, 0);
  EXPECT_NEAR(sensor.motion_blur({.yaw_rate = 0.8}), 0.8 * 0.01 * camera.fx, 1e-9);
  EXPECT_NEAR(sensor.motion_blur({.exposure = 1.5, .yaw_rate = -0.8}), 0.8 * 0.015 * camera.fx,
              1e-9);
  EXPECT_NEAR(sensor.motion_blur({.exposure = 8.0, .yaw_rate = 0.8}), 0.8 * 0.02 * camera.fx, 1e-9)
      << "the longest exposure; the rest is gain";
  EXPECT_EQ(sensor.motion_blur({.yaw_rate = 0.0}), 0.0);

  // A bright column becomes that long, and as dark as it is longer.
  std::vector<float> grey = grey_wall(camera, 0.0f);
  for (int v = 0; v < 480; ++v) grey[static_cast<std::size_t>(v * 640 + 320)] = 200.0f;
  const Image image = sensor.image(std::move(grey), kAhead, {.exposure = 1.0, .yaw_rate = 2.0});
  const double length = 2.0 * 0.01 * camera.fx;  // 9 px
  int bright = 0;
  for (int u = 0; u < image.width; ++u) bright += image.at(u, 240) > 0;
  EXPECT_NEAR(bright, length, 1.0);
  EXPECT_NEAR(image.at(320, 240), 200.0 / length, 1.0);
}

TEST(ImageSensor, WhatTheExposureLacksIsAmplifiedWithItsNoise) {
  CameraRigOptions options = plain();
  options.effects.shutter = 0.01;
  options.read_noise = 2.0;
  const ImageSensor sensor(options, options.stereo.left, 0);
  const auto deviation = [&](double exposure, float light) {
    const Image image = sensor.image(grey_wall(options.stereo.left, light), kAhead,
                                     {.frame = 3, .exposure = exposure});
    const double m = mean(image);
    EXPECT_NEAR(m, exposure * light, 0.5);
    double squares = 0.0;
    for (const auto pixel : image.pixels) squares += (pixel - m) * (pixel - m);
    return std::sqrt(squares / static_cast<double>(image.pixels.size()));
  };
  EXPECT_NEAR(deviation(1.0, 100.0f), 2.0, 0.1);
  EXPECT_NEAR(deviation(2.0, 50.0f), 2.0, 0.1) << "twice as long: 20 ms";
  EXPECT_NEAR(deviation(8.0, 12.5f), 8.0, 0.2) << "four times amplified";
}

TEST(ImageSensor, LampsFlickerInBandsOfRows) {
  CameraRigOptions options = plain();
  options.effects.flicker = 0.4;
  options.effects.readout = 0.02;  // two periods of 100 Hz
  const PinholeCamera& camera = options.stereo.left;
  const auto rows = [&](double shutter, double stamp) {
    options.effects.shutter = shutter;
    const ImageSensor sensor(options, camera, 0);
    const Image image = sensor.image(grey_wall(camera, 100.0f), kAhead, {.stamp = stamp});
    std::vector<double> means;
    for (int v = 0; v < image.height; ++v) means.push_back(mean_of_row(image, v));
    return means;
  };
  const auto depth = [](const std::vector<double>& v) {
    const auto [low, high] = std::minmax_element(v.begin(), v.end());
    return 0.5 * (*high - *low) / 100.0;
  };
  const std::vector<double> bands = rows(0.0, 0.0);
  EXPECT_NEAR(depth(bands), 0.4, 0.01);
  int crossings = 0;
  for (std::size_t v = 1; v < bands.size(); ++v) {
    crossings += (bands[v - 1] < 100.0) != (bands[v] < 100.0);
  }
  EXPECT_NEAR(crossings, 4, 1);
  EXPECT_NE(bands, rows(0.0, 0.0033)) << "they move";
  EXPECT_NEAR(depth(rows(0.005, 0.0)), 0.4 * 2.0 / std::numbers::pi, 0.02) << "half a period";
  EXPECT_LT(depth(rows(0.01, 0.0)), 0.01) << "a whole period";
}

TEST(ImageSensor, PlacesDifferInLightAndAWindowGlares) {
  CameraRigOptions options = plain();
  options.effects.light = 0.3;
  const PinholeCamera& camera = options.stereo.left;
  const auto at = [&](double x, double yaw) {
    Pose pose;
    pose.position.x() = x;
    pose.yaw = yaw;
    return camera_pose(pose, CameraMount());
  };
  const WorldLight light(options.effects, 1);
  double sum = 0.0, squares = 0.0;
  constexpr int kPlaces = 2000;
  for (int n = 0; n < kPlaces; ++n) {
    const double b = std::log(light.brightness(at(0.37 * n, 2.399963 * n)));
    sum += b;
    squares += b * b;
  }
  EXPECT_NEAR(sum / kPlaces, 0.0, 0.03);
  EXPECT_NEAR(std::sqrt(squares / kPlaces), 0.3, 0.03);
  const ImageSensor lit(options, camera, 0);
  EXPECT_NEAR(mean(lit.image(grey_wall(camera, 60.0f), at(2.0, 1.0), {})),
              60.0 * WorldLight(options.effects, stream_seed(options.seed, NoiseStream::kLight))
                         .brightness(at(2.0, 1.0)),
              1.0);

  options.effects = scaled({}, 0.0);
  options.effects.glare = 50.0;
  const ImageSensor glaring(options, camera, 0);
  const Eigen::Vector3d window =
      WorldLight(options.effects, stream_seed(options.seed, NoiseStream::kLight)).window();
  const double azimuth = std::atan2(window.y(), window.x());
  const Image towards = glaring.image(grey_wall(camera, 60.0f), at(0.0, azimuth), {});
  EXPECT_NEAR(*std::max_element(towards.pixels.begin(), towards.pixels.end()), 110, 2);
  EXPECT_GT(towards.at(320, 100), towards.at(0, 400)) << "above the middle most";
  const Image away = glaring.image(grey_wall(camera, 60.0f), at(0.0, azimuth + M_PI), {});
  EXPECT_EQ(*std::max_element(away.pixels.begin(), away.pixels.end()), 60);
}

TEST(ImageSensor, DirtTakesItsShareAtPlacesOfItsOwnOnEachLens) {
  CameraRigOptions options = plain();
  options.effects.dirt = 0.3;
  const PinholeCamera& camera = options.stereo.left;
  const auto through = [&](std::uint64_t number, float grey) {
    return ImageSensor(options, camera, number).image(grey_wall(camera, grey), kAhead, {});
  };
  const Image left = through(0, 200.0f), right = through(1, 200.0f);
  EXPECT_NE(left.pixels, right.pixels);
  const auto darkest = *std::min_element(left.pixels.begin(), left.pixels.end());
  EXPECT_GE(darkest, 200 - 60);  // of spots that overlap less is left, and they seldom do
  EXPECT_LE(darkest, 200 - 25);
  const auto dirty =
      std::count_if(left.pixels.begin(), left.pixels.end(), [](std::uint8_t p) { return p < 199; });
  EXPECT_GT(dirty, 2000);
  EXPECT_LT(dirty, static_cast<std::ptrdiff_t>(left.pixels.size()) / 4);
  const Image veiled = through(0, 0.0f);
  EXPECT_GT(*std::max_element(veiled.pixels.begin(), veiled.pixels.end()), 20) << "stray light";
}

TEST(ImageSensor, WithoutEffectsItsMomentDoesNotMatter) {
  CameraRigOptions options;
  CameraRigOptions other = options;
  other.effects = scaled({.light = 1.0, .flicker = 1.0, .readout = 0.5, .dirt = 0.3}, 0.0);
  const PinholeCamera& camera = options.stereo.left;
  std::vector<float> grey = grey_wall(camera, 0.0f);
  for (std::size_t n = 0; n < grey.size(); ++n) grey[n] = static_cast<float>(n * 7919 % 251);
  const Image image = ImageSensor(options, camera, 1).image(grey, kAhead, {.frame = 5});
  EXPECT_EQ(image.pixels, ImageSensor(other, camera, 1)
                              .image(grey, kAhead, {.frame = 5, .stamp = 17.3, .yaw_rate = 0.7})
                              .pixels);
}

}  // namespace
}  // namespace prospect::image_sensor_test
