// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/stereo_matcher.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/stereo_odometry.h"
#include "tests/images/image_file.h"
#include "tests/perception/rendered_room.h"

namespace prospect::stereo_matcher_test {
namespace {

using test::RenderedRoom;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// Mean normalised error squared of triangulated points, over the pairs whose disparity is right to
/// 1 px: what is farther off is a wrong match, which no covariance means to describe.
struct Accuracy {
  std::vector<double> errors;      // of the disparity [px], all matches
  std::vector<double> row_errors;  // [px]
  double normalised = 0.0;         // mean of e^T Sigma^-1 e / 3 over the right ones
  int right = 0;
};
Accuracy accuracy(const StereoCamera& camera, const std::vector<Eigen::Vector2f>& corners,
                  const std::vector<StereoMatch>& matches, const std::vector<double>& truth) {
  // The odometry's own noise, as it uses it.
  StereoCamera noise = camera;
  noise.sigma_u = noise.sigma_v = StereoOdometryOptions{}.sigma_corner;
  Accuracy a;
  for (const StereoMatch& m : matches) {
    const double d = truth[m.index];
    if (!std::isfinite(d)) continue;
    a.errors.push_back(std::abs(m.disparity - d));
    a.row_errors.push_back(m.row_error);
    if (a.errors.back() > 1.0) continue;
    const double u = corners[m.index].x(), v = corners[m.index].y();
    const Eigen::Vector3d error = noise.triangulate(u, v, m.disparity) - noise.triangulate(u, v, d);
    // Along the ray only: the corner is by definition where its patch was taken.
    const Eigen::Vector3d ray = noise.triangulate(u, v, d).normalized();
    const double along = ray.dot(error);
    const StereoOdometryOptions options;
    noise.sigma_d = std::sqrt(options.sigma_disparity * options.sigma_disparity +
                              options.texture_noise * m.variance);
    const Eigen::Matrix3d covariance = noise.triangulation_covariance(u, v, m.disparity);
    a.normalised += along * along / ray.dot(covariance * ray);
    ++a.right;
  }
  a.normalised /= std::max(1, a.right);
  return a;
}

TEST(StereoMatcher, SubpixelDisparitiesOfARenderedRoom) {
  const StereoCamera camera;
  const RenderedRoom room;
  Accuracy all;
  for (const double yaw : {0.3, 1.7, 3.5}) {
    const Eigen::Isometry3d T = RenderedRoom::looking(0.4, 0.2, 1.1, yaw);
    const auto pair = room.render(camera, T, 2.0, 5);
    const auto corners = detect_corners(pair.left.view());
    const auto matches = match_stereo(ImagePyramid(pair.left.view(), 1),
                                      ImagePyramid(pair.right.view(), 1), corners);
    EXPECT_GT(matches.size(), 0.6 * corners.size());
    EXPECT_GT(matches.size(), 100u);
    std::vector<double> truth;
    for (const auto& c : corners) {
      truth.push_back(camera.left.fx * camera.baseline / room.depth(camera.left, T, c.x(), c.y()));
    }
    const Accuracy a = accuracy(camera, corners, matches, truth);
    EXPECT_LT(median(a.errors), 0.1);
    EXPECT_NEAR(median(a.row_errors), 0.0, 0.03);
    const auto wrong =
        std::count_if(a.errors.begin(), a.errors.end(), [](double e) { return e > 1.0; });
    EXPECT_LE(wrong, 0.05 * a.errors.size());
  }
}

TEST(StereoMatcher, RefusesRepetitionAndWhatIsNotThere) {
  // Dots every 24 px: each fits many.
  Image dots(640, 480, 90);
  for (int v = 12; v < 470; v += 24) {
    for (int u = 12; u < 630; u += 24) {
      for (int y = -2; y <= 2; ++y) {
        for (int x = -2; x <= 2; ++x) dots.at(u + x, v + y) = 190;
      }
    }
  }
  const auto corners = detect_corners(dots.view());
  ASSERT_GT(corners.size(), 100u);
  const ImagePyramid pyramid(dots.view(), 1);
  const auto repeated = match_stereo(pyramid, pyramid, corners);
  EXPECT_LE(repeated.size(), corners.size() / 10);
  const ImagePyramid blank(Image(640, 480, 90).view(), 1);
  EXPECT_TRUE(match_stereo(pyramid, blank, corners).empty());
  // Left and right exchanged: what would be negative disparities is hardly ever accepted.
  const StereoCamera camera;
  const RenderedRoom room;
  const auto pair = room.render(camera, RenderedRoom::looking(0.4, 0.2, 1.1, 0.3), 2.0, 5);
  const auto points = detect_corners(pair.right.view());
  const auto swapped =
      match_stereo(ImagePyramid(pair.right.view(), 1), ImagePyramid(pair.left.view(), 1), points);
  EXPECT_LE(swapped.size(), points.size() / 20);
}

/// The single float32 array of a NumPy .npz with one deflated entry.
std::vector<float> read_npz(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  const auto u16 = [&](std::size_t at) {
    return static_cast<unsigned char>(bytes.at(at)) +
           256u * static_cast<unsigned char>(bytes.at(at + 1));
  };
  const std::size_t begin = 30 + u16(26) + u16(28);
  std::vector<unsigned char> out(1 << 23);
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + begin));
  stream.avail_in = static_cast<uInt>(bytes.size() - begin);
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = inflate(&stream, Z_FINISH);
  const std::size_t size = stream.total_out;
  inflateEnd(&stream);
  if (status != Z_STREAM_END) return {};
  const std::size_t header = 10 + out[8] + 256u * out[9];
  std::vector<float> values((size - header) / sizeof(float));
  std::memcpy(values.data(), out.data() + header, values.size() * sizeof(float));
  return values;
}

TEST(StereoMatcher, MiddleburyMotorcycle) {
  const std::string folder =
      std::string(PROSPECT_SHARED_DATA) + "/stereo_pairs/middlebury2014_motorcycle/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  const cv::Mat left = test::read_image(folder + "motorcycle_left.png", cv::IMREAD_GRAYSCALE);
  const cv::Mat right = test::read_image(folder + "motorcycle_right.png", cv::IMREAD_GRAYSCALE);
  const std::vector<float> disparity = read_npz(folder + "motorcycle_disp.npz");
  ASSERT_EQ(disparity.size(), left.total());
  const ImageView l{left.data, left.cols, left.rows, static_cast<std::ptrdiff_t>(left.step)};
  const ImageView r{right.data, right.cols, right.rows, static_cast<std::ptrdiff_t>(right.step)};
  CornerDetectorOptions options;
  options.cells = 1600;  // more than the odometry uses, for the statistics
  const auto corners = detect_corners(l, {}, options);
  const auto matches = match_stereo(ImagePyramid(l, 1), ImagePyramid(r, 1), corners);
  std::vector<double> truth;
  for (const auto& c : corners) {
    truth.push_back(
        disparity[static_cast<std::size_t>(c.y()) * left.cols + static_cast<std::size_t>(c.x())]);
  }
  // The pair's own numbers at this size: f 994.978 px, baseline 193.001 mm (Scharstein et al.
  // 2014); ground truth already contains the offset of the principal points.
  StereoCamera camera;
  camera.left = {994.978, 994.978, 311.193, 254.877, 741.0, 500.0};
  camera.baseline = 0.193001;
  const Accuracy a = accuracy(camera, corners, matches, truth);
  const auto wrong =
      std::count_if(a.errors.begin(), a.errors.end(), [](double e) { return e > 1.0; });
  std::printf(
      "Middlebury motorcycle: %zu matches of %zu corners, median %.3f px, %.1f %% off by more "
      "than 1 px, normalised error squared %.2f, row error %.3f px\n",
      a.errors.size(), corners.size(), median(a.errors), 100.0 * wrong / a.errors.size(),
      a.normalised, median(a.row_errors));
  EXPECT_GT(a.errors.size(), 500u);
  EXPECT_LE(median(a.errors), 0.3);
  EXPECT_GE(a.normalised, 0.5);
  EXPECT_LE(a.normalised, 2.0);
  EXPECT_LE(wrong, 0.15 * a.errors.size());
}

}  // namespace
}  // namespace prospect::stereo_matcher_test
