// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/depth_scale.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/trajectory.h"
#include "perception/mapping/ground_plane.h"

namespace prospect {
namespace {

constexpr DepthRange kAnyDepth{0.05, 100.0};

std::string scale_text(double per_metre) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", per_metre);
  return text;
}

std::string percent_text(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
  return text;
}

/// |predicted - measured| / predicted depth, over pixels of each image moved to each later one:
/// what three quarters of them stay below (a camera that moves along a floor sees the floor alike
/// with any scale; what stands on it tells). NaN where too few meet.
double disagreement(const DepthPoses& poses, const PinholeCamera& camera,
                    const std::vector<std::size_t>& frames, const std::vector<RawImage>& raw,
                    double per_metre) {
  constexpr int kEvery = 8;  // pixels
  constexpr std::size_t kLeast = 200;
  std::vector<double> off;
  std::vector<DepthImage> images;
  for (const RawImage& image : raw) images.push_back(scaled_depth(image, per_metre, kAnyDepth));
  for (std::size_t pair = 0; pair < images.size() * images.size(); ++pair) {
    const std::size_t i = pair / images.size(), j = pair % images.size();
    if (i >= j) continue;
    const DepthImage& from = images[i];
    const DepthImage& to = images[j];
    const Eigen::Isometry3d T = poses[frames[j]].inverse() * poses[frames[i]];
    for (int v = 0; v < from.height; v += kEvery) {
      for (int u = 0; u < from.width; u += kEvery) {
        const float z = from.at(u, v);
        if (!kAnyDepth.holds(z)) continue;
        const Eigen::Vector3d p = T * (pixel_ray(camera, u, v) * static_cast<double>(z));
        if (!(p.z() > kAnyDepth.min)) continue;
        const long x = std::lround(camera.fx * p.x() / p.z() + camera.cx);
        const long y = std::lround(camera.fy * p.y() / p.z() + camera.cy);
        if (x < 0 || y < 0 || x >= to.width || y >= to.height) continue;
        const float there = to.at(static_cast<int>(x), static_cast<int>(y));
        if (kAnyDepth.holds(there)) off.push_back(std::abs(there - p.z()) / p.z());
      }
    }
  }
  if (off.size() < kLeast) return std::numeric_limits<double>::quiet_NaN();
  const auto quarter = off.begin() + static_cast<std::ptrdiff_t>(3 * off.size() / 4);
  std::nth_element(off.begin(), quarter, off.end());
  return *quarter;
}

/// The metre of depths that were measured by stereo is that of the baseline: there is nothing to
/// choose, but a wrong one shows.
DepthScale scale_of_stereo(const DepthSource& source, const PinholeCamera& camera,
                           const std::vector<std::size_t>& frames,
                           const std::vector<RawImage>& raw) {
  constexpr double kClearly = 0.5, kContradicts = 0.2;  // as of the others
  DepthScale out;
  out.per_metre = 1.0;
  out.note = "the metre is that of the calibration";
  const double off = disagreement(source.poses, camera, frames, raw, 1.0);
  double other = std::numeric_limits<double>::infinity();
  for (const double wrong : {0.5, 0.67, 0.8, 1.25, 1.5, 2.0}) {
    other = std::fmin(other, disagreement(source.poses, camera, frames, raw, wrong));
  }
  out.doubtful = off > kContradicts || other < kClearly * off;
  if (out.doubtful) {
    out.note += ", but images and poses disagree by " + percent_text(off) +
                ": the baseline, the focal length or the poses are wrong";
  } else if (off < kClearly * other) {
    out.note += ", and images and poses agree to " + percent_text(off);
  } else {
    out.note += "; the poses do not tell whether it is right";
  }
  return out;
}

/// disagreement() with each of the candidates.
std::vector<double> disagreements(const DepthPoses& poses, const PinholeCamera& camera,
                                  const std::vector<std::size_t>& frames,
                                  const std::vector<RawImage>& raw,
                                  const std::vector<double>& candidates) {
  std::vector<double> off;
  for (const double candidate : candidates) {
    off.push_back(disagreement(poses, camera, frames, raw, candidate));
  }
  return off;
}

/// Why poses with that disagreement do not tell the scale; empty if they hardly move.
std::string why_untold(double off, double fits) {
  if (std::isnan(off)) {
    return ", which the poses cannot tell: by them the images show nothing in common";
  }
  if (off < fits) return "";
  return ", which the poses cannot tell: images and poses disagree by " + percent_text(off) +
         ", with another scale by little less or more; poses, their frame or the lens may be wrong";
}

/// Where the least of them is.
std::size_t least(const std::vector<double>& off) {
  std::size_t best = 0;
  for (std::size_t c = 1; c < off.size(); ++c) {
    if (off[c] < off[best] || !std::isfinite(off[best])) best = c;
  }
  return best;
}

}  // namespace

DepthImage scaled_depth(const RawImage& raw, double per_metre, const DepthRange& range) {
  if (raw.channels != 1) return {};
  if (raw.kind == RawImage::Kind::k16) {
    std::vector<std::uint16_t> numbers(raw.bytes.size() / 2);
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = raw.number16(i);
    return depth_image(numbers.data(), raw.width, raw.height, raw.width, 1.0 / per_metre, range);
  }
  if (raw.kind != RawImage::Kind::kFloat) return {};
  std::vector<float> metres(raw.bytes.size() / 4);
  for (std::size_t i = 0; i < metres.size(); ++i) {
    metres[i] = static_cast<float>(raw.number_float(i) / per_metre);
  }
  return depth_image(metres.data(), raw.width, raw.height, raw.width, range);
}

DepthScale choose_depth_scale(const DepthSource& source, const DepthDatasetOptions& options,
                              const PinholeCamera& camera,
                              const std::function<RawImage(std::size_t)>& read) {
  constexpr std::size_t kSamples = 6;
  constexpr double kFits = 0.05;        // of the depth: poses and depths agree
  constexpr double kAgrees = 0.01;      // of the depth: so well that nothing else is tried
  constexpr double kClearly = 0.5;      // of the other scale's disagreement
  constexpr double kContradicts = 0.2;  // of the depth
  std::vector<std::size_t> frames;
  std::vector<RawImage> raw;
  Elements samples("images");
  const std::size_t n = source.images.size();
  for (std::size_t k = 0; k < std::min(kSamples, n); ++k) {
    // Neighbours show the same; of a long recording not the same as the last one.
    const std::size_t i = n <= 8 * kSamples
                              ? k * (n - 1) / std::max<std::size_t>(1, std::min(kSamples, n) - 1)
                              : 8 * k;
    if (samples.read([&] { raw.push_back(read(i)); })) frames.push_back(i);
  }
  if (2 * samples.bad() > samples.all()) throw InputError(samples.first());
  if (source.stereo) return scale_of_stereo(source, camera, frames, raw);
  const bool floats = !raw.empty() && raw[0].kind == RawImage::Kind::kFloat;
  const double rule = floats ? 1.0 : source.depth_scale;
  DepthScale out;
  out.per_metre = options.depth_scale.value_or(rule);
  std::vector<double> candidates = {out.per_metre};
  for (const double other : {1.0, 1000.0, 5000.0}) {
    if ((floats || other > 1.0) && other != out.per_metre) candidates.push_back(other);
  }
  const std::string given = options.depth_scale ? "given" : "by the layout's rule";
  out.note = "depth scale " + scale_text(out.per_metre) + " a metre, " + given;
  std::string unchecked;  // why the poses do not tell
  if (!source.poses.empty()) {
    std::vector<double> off = disagreements(source.poses, camera, frames, raw, candidates);
    std::size_t best = least(off);
    std::string order;
    if (source.poses_of_quaternions && !(off[best] < kAgrees)) {
      DepthPoses again;
      for (const Eigen::Isometry3d& pose : source.poses) again.push_back(with_w_first(pose));
      const std::vector<double> off_again = disagreements(again, camera, frames, raw, candidates);
      const std::size_t best_again = least(off_again);
      if (off_again[best_again] < kFits && off_again[best_again] < kClearly * off[best]) {
        order = "; the poses' quaternions have w first: read so they agree to " +
                percent_text(off_again[best_again]) + ", with w last they are off by " +
                percent_text(off[best]) + " at least";
        out.w_first = true;
        off = off_again;
        best = best_again;
      }
    }
    const bool clear =
        best != 0 && off[best] < kFits && (!std::isfinite(off[0]) || off[best] < kClearly * off[0]);
    if (clear) {
      const std::string facts = "images and poses disagree by " + percent_text(off[best]) +
                                " with " + scale_text(candidates[best]) + " a metre" +
                                (std::isfinite(off[0]) ? ", by " + percent_text(off[0]) + " with " +
                                                             scale_text(candidates[0])
                                                       : "");
      if (options.depth_scale) {
        out.note += ", but " + facts;
        out.doubtful = true;
      } else {
        out.per_metre = candidates[best];
        out.note = "depth scale " + scale_text(out.per_metre) + " a metre, not " +
                   scale_text(candidates[0]) + " as the layout's rule is: " + facts;
      }
      out.note += order;
      return out;
    }
    double next = std::numeric_limits<double>::infinity();
    for (std::size_t c = 1; c < candidates.size(); ++c) next = std::fmin(next, off[c]);
    if (off[0] < kFits && off[0] < kClearly * next) {
      out.note += ", and by the poses: images and poses agree to " + percent_text(off[0]) + order;
      return out;
    }
    out.note += order;
    unchecked = why_untold(off[0], kFits);
    if (off[0] > kContradicts) {
      out.note += ", but images and poses disagree by " + percent_text(off[0]) +
                  ": --depth-scale states another, if the poses and the lens are right";
      out.doubtful = true;
      return out;
    }
  }
  if (options.camera_height > 0.0) {
    const GroundPrior prior = ground_prior(options.camera_height, 0.35, 0.0, 0.15, 0.61);
    std::vector<int> found;
    for (const double candidate : candidates) {
      int count = 0;
      for (const RawImage& image : raw) {
        count +=
            find_ground(camera, scaled_depth(image, candidate, options.range), prior, {}).found;
      }
      found.push_back(count);
    }
    const auto best = std::max_element(found.begin(), found.end()) - found.begin();
    const std::string height = scale_text(options.camera_height) + " m below the camera";
    if (best != 0 && found[0] == 0 && !options.depth_scale) {
      out.per_metre = candidates[static_cast<std::size_t>(best)];
      out.note = "depth scale " + scale_text(out.per_metre) + " a metre, not " +
                 scale_text(candidates[0]) + " as the layout's rule is: the ground is " + height +
                 " so";
    } else if (found[0] > 0) {
      out.note += ", and the ground is " + height;
    } else {
      out.note += ", but no ground is " + height;
      out.doubtful = true;
    }
    return out;
  }
  if (!options.depth_scale) {
    out.note += unchecked.empty() ? "; neither poses that move nor --camera-height to check it with"
                                  : unchecked;
  }
  return out;
}

}  // namespace prospect
