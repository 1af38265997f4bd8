// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/camera_rig.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/pixel_noise.h"
#include "engine/support/worker_threads.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr int kRowBand = 32;  // rows that a thread takes at a time
enum Camera : std::uint64_t { kLeft, kRight, kDepth, kDropout };

// Weights of a symmetric filter, from its middle outwards.
std::vector<float> gaussian_weights(double sigma) {
  std::vector<float> weights{1.0f};
  double sum = 1.0;
  for (int k = 1; sigma > 0.0 && k <= std::ceil(3.0 * sigma); ++k) {
    weights.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma * sigma))));
    sum += 2.0 * weights.back();
  }
  for (float& w : weights) w = static_cast<float>(w / sum);
  return weights;
}

// A box `length` pixels long, its ends in parts of a pixel.
std::vector<float> box_weights(double length) {
  std::vector<float> weights;
  length = std::max(length, 1.0);
  for (int k = 0; k == 0 || k - 0.5 < 0.5 * length; ++k) {
    const double covered = std::clamp(0.5 * length - (k - 0.5), 0.0, 1.0);
    weights.push_back(static_cast<float>((k == 0 ? 1.0 : covered) / length));
  }
  return weights;
}

// Filters a row of `n` with symmetric weights; it goes on beyond its ends as it ends. `padded` is
// scratch.
void filter_row(const float* row, int n, const std::vector<float>& weights,
                std::vector<float>& padded, float* out) {
  const int reach = static_cast<int>(weights.size()) - 1;
  padded.resize(static_cast<std::size_t>(n + 2 * reach));
  std::fill_n(padded.begin(), reach, row[0]);
  std::copy_n(row, n, padded.begin() + reach);
  std::fill_n(padded.begin() + reach + n, reach, row[n - 1]);
  const float* centre = padded.data() + reach;
  for (int u = 0; u < n; ++u) out[u] = weights[0] * centre[u];
  for (int k = 1; k <= reach; ++k) {
    const float w = weights[static_cast<std::size_t>(k)];
    for (int u = 0; u < n; ++u) out[u] += w * (centre[u - k] + centre[u + k]);
  }
}

}  // namespace

bool is_rendered(const RgbdFootprint& footprint) {
  constexpr double kDegree = M_PI / 180.0;
  const auto fits = [](double angle) { return angle >= kDegree && angle <= 170.0 * kDegree; };
  return fits(footprint.horizontal_fov) && fits(footprint.vertical_fov);
}

PinholeCamera depth_camera(const RgbdFootprint& footprint, int width, int height) {
  PinholeCamera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = 0.5 * width / std::tan(0.5 * footprint.horizontal_fov);
  camera.fy = 0.5 * height / std::tan(0.5 * footprint.vertical_fov);
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return camera;
}

CameraRig::CameraRig(std::shared_ptr<const SceneRenderer> scene, const CameraRigOptions& options)
    : scene_(std::move(scene)), options_(options) {
  constexpr std::string_view kOwner = "camera rig";
  if (!scene_) throw std::invalid_argument("camera rig: expected a scene, got none");
  validate(options.stereo);
  validate(options.stereo_mount);
  validate(options.footprint);
  validate(options.depth_mount);
  const auto within = [&](std::string_view name, double value, double low, double high,
                          std::string_view expected) {
    check_parameter(value >= low && value <= high, kOwner, name, value, expected);
  };
  // A depth image is in perspective here, as that of a depth camera.
  constexpr double kDegree = M_PI / 180.0;
  for (const auto& [name, angle] : {std::pair{"horizontal_fov", options.footprint.horizontal_fov},
                                    {"vertical_fov", options.footprint.vertical_fov}}) {
    within(std::string("depth.") + name, angle / kDegree, 1.0 - 1e-9, 170.0 + 1e-9,
           "1..170 degrees, as rendered depth is an image in perspective; sensors: model takes all "
           "sensors");
  }
  check_knobs(kOwner, options);
  within("depth_noise_constant", options.depth_noise_constant, 0.0, 1.0, "0..1 m");
  within("depth_noise_quadratic", options.depth_noise_quadratic, 0.0, 1.0, "0..1 per m");
  within("depth_dropout", options.depth_dropout, 0.0, 1.0, "a probability");
  depth_camera_ =
      prospect::depth_camera(options.footprint, options.depth_width, options.depth_height);
}

Image CameraRig::image(const Eigen::Isometry3d& T_WC, const Twist& twist, std::uint64_t frame,
                       std::uint64_t camera_number) const {
  const PinholeCamera& camera = options_.stereo.left;
  std::vector<float> grey = scene_->intensity(camera, T_WC, options_.threads);
  const int width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
  const auto stride = static_cast<std::size_t>(width);
  const int bands = (height + kRowBand - 1) / kRowBand;
  WorkerThreads workers(options_.threads);

  // Across the rows, then down the columns: the second needs the rows of neighbouring bands.
  const std::vector<float> lens = gaussian_weights(options_.blur);
  double flow = camera.fx * std::abs(twist.yaw_rate) * options_.exposure_time;
  flow = std::isfinite(flow) ? std::min(flow, camera.width) : 0.0;
  const std::vector<float> motion = box_weights(flow);
  const double corner_x = std::max(camera.cx, camera.width - camera.cx);
  const double corner_y = std::max(camera.cy, camera.height - camera.cy);
  const auto loss =
      static_cast<float>(options_.vignetting / (corner_x * corner_x + corner_y * corner_y));
  const auto gain = static_cast<float>(options_.exposure);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  workers.run(bands, [&](int band) {
    std::vector<float> padded, filtered(stride);
    for (int v = band * kRowBand; v < std::min(height, (band + 1) * kRowBand); ++v) {
      float* row = grey.data() + static_cast<std::size_t>(v) * stride;
      const float y = static_cast<float>(v) - cy;
      for (int u = 0; u < width; ++u) {
        const float x = static_cast<float>(u) - cx;
        row[u] *= gain * (1.0f - loss * (x * x + y * y));
      }
      if (lens.size() > 1) {
        filter_row(row, width, lens, padded, filtered.data());
        std::copy(filtered.begin(), filtered.end(), row);
      }
      if (motion.size() > 1) {
        filter_row(row, width, motion, padded, filtered.data());
        std::copy(filtered.begin(), filtered.end(), row);
      }
    }
  });

  Image image(width, height);
  const PixelNoise noise(options_.seed, frame, camera_number);
  const auto read = static_cast<float>(options_.read_noise * options_.read_noise);
  const auto shot = static_cast<float>(options_.shot_noise);
  workers.run(bands, [&](int band) {
    std::vector<float> sum(stride);
    const int reach = static_cast<int>(lens.size()) - 1;
    for (int v = band * kRowBand; v < std::min(height, (band + 1) * kRowBand); ++v) {
      const auto row = [&](int r) {
        return grey.data() + static_cast<std::size_t>(std::clamp(r, 0, height - 1)) * stride;
      };
      const float* middle = row(v);
      for (std::size_t u = 0; u < stride; ++u) sum[u] = lens[0] * middle[u];
      for (int k = 1; k <= reach; ++k) {
        const float w = lens[static_cast<std::size_t>(k)];
        const float *above = row(v - k), *below = row(v + k);
        for (std::size_t u = 0; u < stride; ++u) sum[u] += w * (above[u] + below[u]);
      }
      const auto first = static_cast<std::uint32_t>(v) * static_cast<std::uint32_t>(width);
      std::uint8_t* out = image.pixels.data() + static_cast<std::size_t>(v) * stride;
      for (int u = 0; u < width; ++u) {
        const float g = sum[static_cast<std::size_t>(u)];
        const float sigma = std::sqrt(read + shot * g);
        const float noisy = g + sigma * noise.gaussian(first + static_cast<std::uint32_t>(u));
        out[u] = static_cast<std::uint8_t>(
            static_cast<int>(std::min(std::max(noisy, 0.0f), 255.0f) + 0.5f));
      }
    }
  });
  return image;
}

ImagePair CameraRig::stereo(const Pose& true_pose, const Twist& twist, std::uint64_t frame) const {
  const Eigen::Isometry3d left = camera_pose(true_pose, options_.stereo_mount);
  Eigen::Isometry3d right = left;
  right.translation() += left.linear().col(0) * options_.stereo.baseline;
  return {image(left, twist, frame, kLeft), image(right, twist, frame, kRight)};
}

DepthImage CameraRig::depth(const Pose& true_pose, std::uint64_t frame) const {
  std::vector<float> incidence;
  DepthImage image = scene_->depth(depth_camera_, camera_pose(true_pose, options_.depth_mount),
                                   options_.threads, &incidence);
  const PixelNoise noise(options_.seed, frame, kDepth);
  const PixelNoise dropout(options_.seed, frame, kDropout);
  // Of 24 random bits, which floats and integers hold exactly.
  const auto dropped = static_cast<std::uint32_t>(std::lround(options_.depth_dropout * 0x1p24));
  const auto grazing = static_cast<float>(std::cos(options_.max_incidence));
  const auto constant = static_cast<float>(options_.depth_noise_constant);
  const auto quadratic = static_cast<float>(options_.depth_noise_quadratic);
  const auto min_range = static_cast<float>(options_.footprint.min_range);
  const auto max_range = static_cast<float>(options_.footprint.max_range);
  const auto inverse_fx = static_cast<float>(1.0 / depth_camera_.fx);
  const auto inverse_fy = static_cast<float>(1.0 / depth_camera_.fy);
  const auto cx = static_cast<float>(depth_camera_.cx), cy = static_cast<float>(depth_camera_.cy);
  const int bands = (image.height + kRowBand - 1) / kRowBand;
  WorkerThreads(options_.threads).run(bands, [&](int band) {
    for (int v = band * kRowBand; v < std::min(image.height, (band + 1) * kRowBand); ++v) {
      const float y = (static_cast<float>(v) - cy) * inverse_fy;
      const auto first = static_cast<std::uint32_t>(v) * static_cast<std::uint32_t>(image.width);
      for (int u = 0; u < image.width; ++u) {
        const std::uint32_t pixel = first + static_cast<std::uint32_t>(u);
        float& z = image.depth[pixel];
        const float x = (static_cast<float>(u) - cx) * inverse_fx;
        const float stretch = std::sqrt(x * x + y * y + 1.0f);  // range / z
        const float measured = z + (constant + quadratic * z * z) * noise.gaussian(pixel);
        // Comparisons with NaN are false: what was not hit stays so.
        const bool valid = z * stretch >= min_range && measured > 0.0f &&
                           measured * stretch <= max_range && incidence[pixel] >= grazing &&
                           (dropout.bits(pixel) >> 8) >= dropped;
        z = valid ? measured : DepthImage::kInvalid;
      }
    }
  });
  return image;
}

}  // namespace prospect
