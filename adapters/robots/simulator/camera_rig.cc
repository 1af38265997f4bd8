// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/camera_rig.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/hashed_draws.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/pixel_noise.h"
#include "engine/support/worker_threads.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr int kDepthBand = 32;  // rows that a thread takes at a time
enum Camera : std::uint64_t { kLeft, kRight, kDepth, kDropout };

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
    : scene_(std::move(scene)),
      options_(options),
      depth_camera_(
          prospect::depth_camera(options.footprint, options.depth_width, options.depth_height)),
      stereo_(true_stereo(options.stereo, options.effects,
                          stream_seed(options.seed, NoiseStream::kTrueStereo))),
      stereo_mount_(true_mount(options.stereo_mount, options.effects,
                               stream_seed(options.seed, NoiseStream::kStereoMount))),
      depth_mount_(true_mount(options.depth_mount, options.effects,
                              stream_seed(options.seed, NoiseStream::kDepthMount))),
      true_depth_(true_camera(depth_camera_, options.effects,
                              stream_seed(options.seed, NoiseStream::kTrueDepth))),
      left_(options, stereo_.camera, kLeft),
      right_(options, stereo_.camera, kRight) {
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
  HashedDraws draws(stream_seed(options.seed, NoiseStream::kDepthMount) + 1);
  depth_scale_ = static_cast<float>(1.0 + options.effects.baseline * draws.normal());
}

ImagePair CameraRig::stereo(const Pose& true_pose, const ImageMoment& moment,
                            std::span<const Person> people) const {
  const Eigen::Isometry3d left = camera_pose(true_pose, stereo_mount_);
  Eigen::Isometry3d right = left;
  right.translation() += left.linear().col(0) * stereo_.T_LR.translation().x();
  if (options_.effects.rotation != 0.0) right.linear() *= stereo_.T_LR.linear();
  const auto image = [&](const ImageSensor& sensor, const Eigen::Isometry3d& T_WC) {
    std::vector<float> grey = scene_->intensity(stereo_.camera, T_WC, options_.threads);
    draw_people(people, *scene_, stereo_.camera, T_WC, options_.threads, grey);
    return sensor.image(std::move(grey), T_WC, moment);
  };
  return {image(left_, left), image(right_, right)};
}

DepthImage CameraRig::depth(const Pose& true_pose, std::uint64_t frame,
                            std::span<const Person> people) const {
  std::vector<float> incidence;
  const Eigen::Isometry3d T_WC = camera_pose(true_pose, depth_mount_);
  DepthImage image = scene_->depth(true_depth_, T_WC, options_.threads, &incidence);
  draw_people(people, true_depth_, T_WC, options_.threads, image, incidence);
  const PixelNoise noise(options_.seed, frame, kDepth);
  const PixelNoise dropout(options_.seed, frame, kDropout);
  // Of 24 random bits, which floats and integers hold exactly.
  const auto dropped = static_cast<std::uint32_t>(std::lround(options_.depth_dropout * 0x1p24));
  const auto grazing = static_cast<float>(std::cos(options_.max_incidence));
  const auto constant = static_cast<float>(options_.depth_noise_constant);
  const auto quadratic = static_cast<float>(options_.depth_noise_quadratic);
  const auto min_range = static_cast<float>(options_.footprint.min_range);
  const auto max_range = static_cast<float>(options_.footprint.max_range);
  const auto inverse_fx = static_cast<float>(1.0 / true_depth_.fx);
  const auto inverse_fy = static_cast<float>(1.0 / true_depth_.fy);
  const auto cx = static_cast<float>(true_depth_.cx), cy = static_cast<float>(true_depth_.cy);
  const int bands = (image.height + kDepthBand - 1) / kDepthBand;
  WorkerThreads(options_.threads).run(bands, [&](int band) {
    for (int v = band * kDepthBand; v < std::min(image.height, (band + 1) * kDepthBand); ++v) {
      const float y = (static_cast<float>(v) - cy) * inverse_fy;
      const auto first = static_cast<std::uint32_t>(v) * static_cast<std::uint32_t>(image.width);
      for (int u = 0; u < image.width; ++u) {
        const std::uint32_t pixel = first + static_cast<std::uint32_t>(u);
        float& z = image.depth[pixel];
        const float x = (static_cast<float>(u) - cx) * inverse_fx;
        const float stretch = std::sqrt(x * x + y * y + 1.0f);  // range / z
        const float measured =
            depth_scale_ * z + (constant + quadratic * z * z) * noise.gaussian(pixel);
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
