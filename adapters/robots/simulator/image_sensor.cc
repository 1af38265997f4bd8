// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/image_sensor.h"

#include <algorithm>
#include <cmath>

#include "adapters/robots/simulator/hashed_draws.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/pixel_noise.h"
#include "engine/support/worker_threads.h"

namespace prospect {
namespace {

constexpr int kImageBand = 32;  // rows that a thread takes at a time

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

// The share of light that spots on a lens leave, pixel by pixel.
std::vector<float> dirty_lens(double dirt, int width, int height, std::uint64_t seed) {
  if (dirt == 0.0) return {};
  std::vector<float> clean(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                           1.0f);
  constexpr int kSpots = 5;
  HashedDraws draws(seed);
  for (int n = 0; n < kSpots; ++n) {
    const double u0 = draws.uniform(0.0, width), v0 = draws.uniform(0.0, height);
    const double radius = width * draws.uniform(0.02, 0.06);
    std::size_t at = 0;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u, ++at) {
        const double r = std::hypot(u - u0, v - v0) / radius;
        if (r < 2.0) clean[at] *= static_cast<float>(1.0 - dirt * std::exp(-std::pow(r, 4)));
      }
    }
  }
  for (float& share : clean) share = std::max(share, 0.0f);
  return clean;
}

// exp(-(x - x0)^2 / 2 s^2) of whole x.
std::vector<float> bell(double x0, double s, int n) {
  std::vector<float> values;
  for (int x = 0; x < n; ++x) {
    values.push_back(static_cast<float>(std::exp(-0.5 * (x - x0) * (x - x0) / (s * s))));
  }
  return values;
}

}  // namespace

ImageSensor::ImageSensor(const CameraRigOptions& options, const PinholeCamera& camera,
                         std::uint64_t number)
    : options_(options),
      camera_(camera),
      number_(number),
      light_(options.effects, stream_seed(options.seed, NoiseStream::kLight)),
      clean_(dirty_lens(options.effects.dirt, static_cast<int>(camera.width),
                        static_cast<int>(camera.height),
                        stream_seed(options.seed, NoiseStream::kDirt) + number)) {}

double ImageSensor::control_time(const ImageMoment& moment) const {
  constexpr double kLongest = 0.02;
  return std::min(options_.effects.shutter * moment.exposure, kLongest);
}

double ImageSensor::motion_blur(const ImageMoment& moment) const {
  const double flow =
      camera_.fx * std::abs(moment.yaw_rate) * (options_.exposure_time + control_time(moment));
  return std::isfinite(flow) ? std::min(flow, camera_.width) : 0.0;
}

void ImageSensor::expose(std::vector<float>& grey, const Eigen::Isometry3d& T_WC,
                         const ImageMoment& moment) const {
  const int width = static_cast<int>(camera_.width), height = static_cast<int>(camera_.height);
  const auto stride = static_cast<std::size_t>(width);
  const CameraEffects& effects = options_.effects;
  std::vector<float> glare_u, glare_v;
  const Eigen::Vector3d window = T_WC.linear().transpose() * light_.window();
  if (effects.glare != 0.0 && window.z() > 0.05) {
    const Eigen::Vector2d at = camera_.project(window);
    glare_u = bell(at.x(), width / 3.0, width);
    glare_v = bell(at.y(), width / 3.0, height);
  }
  const double duration = options_.exposure_time + control_time(moment);
  const double gain = options_.exposure * moment.exposure * light_.brightness(T_WC);
  const double corner_x = std::max(camera_.cx, camera_.width - camera_.cx);
  const double corner_y = std::max(camera_.cy, camera_.height - camera_.cy);
  const auto loss =
      static_cast<float>(options_.vignetting / (corner_x * corner_x + corner_y * corner_y));
  const auto cx = static_cast<float>(camera_.cx), cy = static_cast<float>(camera_.cy);
  const std::vector<float> lens = gaussian_weights(options_.blur);
  const std::vector<float> motion = box_weights(motion_blur(moment));
  const int bands = (height + kImageBand - 1) / kImageBand;
  WorkerThreads(options_.threads).run(bands, [&](int band) {
    std::vector<float> padded, filtered(stride);
    for (int v = band * kImageBand; v < std::min(height, (band + 1) * kImageBand); ++v) {
      float* row = grey.data() + static_cast<std::size_t>(v) * stride;
      if (!glare_u.empty()) {
        const float stray =
            static_cast<float>(effects.glare) * glare_v[static_cast<std::size_t>(v)];
        for (std::size_t u = 0; u < stride; ++u) row[u] += stray * glare_u[u];
      }
      const double time = moment.stamp + effects.readout * v / height;
      const auto row_gain = static_cast<float>(gain * light_.lamps(time, duration));
      const float y = static_cast<float>(v) - cy;
      for (int u = 0; u < width; ++u) {
        const float x = static_cast<float>(u) - cx;
        row[u] *= row_gain * (1.0f - loss * (x * x + y * y));
      }
      if (!clean_.empty()) {
        const float veil = 100.0f * row_gain;
        const float* clean = clean_.data() + static_cast<std::size_t>(v) * stride;
        for (std::size_t u = 0; u < stride; ++u) row[u] = veil + clean[u] * (row[u] - veil);
      }
      for (const std::vector<float>* filter : {&lens, &motion}) {
        if (filter->size() < 2) continue;
        filter_row(row, width, *filter, padded, filtered.data());
        std::copy(filtered.begin(), filtered.end(), row);
      }
    }
  });
}

Image ImageSensor::image(std::vector<float> grey, const Eigen::Isometry3d& T_WC,
                         const ImageMoment& moment) const {
  expose(grey, T_WC, moment);
  const int width = static_cast<int>(camera_.width), height = static_cast<int>(camera_.height);
  const auto stride = static_cast<std::size_t>(width);
  // Down the columns: what needs the rows of neighbouring bands.
  const std::vector<float> lens = gaussian_weights(options_.blur);
  const double wanted = options_.effects.shutter * moment.exposure;
  const double amplified = wanted > 0.0 ? wanted / control_time(moment) : moment.exposure;
  Image image(width, height);
  const PixelNoise noise(options_.seed, moment.frame, number_);
  const auto read =
      static_cast<float>(options_.read_noise * options_.read_noise * amplified * amplified);
  const auto shot = static_cast<float>(options_.shot_noise * amplified);
  const int bands = (height + kImageBand - 1) / kImageBand;
  WorkerThreads(options_.threads).run(bands, [&](int band) {
    std::vector<float> sum(stride);
    const int reach = static_cast<int>(lens.size()) - 1;
    for (int v = band * kImageBand; v < std::min(height, (band + 1) * kImageBand); ++v) {
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
        // NOLINTNEXTLINE(bugprone-incorrect-roundings): it is not negative
        out[u] = static_cast<std::uint8_t>(
            // NOLINTNEXTLINE(bugprone-incorrect-roundings)
            static_cast<int>(std::min(std::max(noisy, 0.0f), 255.0f) + 0.5f));
      }
    }
  });
  return image;
}

}  // namespace prospect
