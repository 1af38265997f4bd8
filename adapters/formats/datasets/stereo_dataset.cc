// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/stereo_dataset.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/files/input_error.h"
#include "perception/odometry/stereo_check.h"

namespace prospect {
namespace {

constexpr int kEnoughMatches = 20;  // to say on which side the right camera is

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

StereoDataset StereoDataset::open(const std::string& path, const StereoDatasetOptions& options) {
  return open(open_stereo_source(path, options), options);
}

StereoDataset StereoDataset::open(StereoSource source, const StereoDatasetOptions& options) {
  if (!source.missing.empty()) throw InputError(source.missing[0]);
  StereoDataset dataset;
  dataset.layout_ = source.layout;
  dataset.times_assumed_ = source.times_assumed;
  dataset.notes_ = std::move(source.notes);
  dataset.calibration_from_ = source.calibration->from;
  for (const std::string& note : source.calibration->notes) dataset.notes_.push_back(note);
  const FramePairs pairs = pair_frames(source.left, source.right, options.sync);
  const std::string problem = pairing_problem(pairs, source.left, source.right);
  if (!problem.empty()) throw InputError(problem);
  for (const std::string& note : pairing_notes(pairs, source.left, source.right)) {
    dataset.notes_.push_back(note);
  }
  dataset.pairs_ = pairs.pairs;
  dataset.unpaired_ = pairs.left_alone + pairs.right_alone;
  for (const auto& [l, r] : pairs.pairs) dataset.stamps_.push_back(source.left.stamps[l]);
  dataset.left_ = std::move(source.left);
  dataset.right_ = std::move(source.right);
  const bool raw = !source.calibration->rectified;
  const Eigen::Isometry3d T_BC_own = source.calibration->left.T_BC;
  const Eigen::Isometry3d T_BC =
      raw && !source.truth_of_body ? source.calibration->left.T_BC : Eigen::Isometry3d::Identity();
  const auto [left, right] = dataset.first_readable_pair();
  if (left.width != right.width || left.height != right.height) {
    throw InputError(dataset.right_.names[pairs.pairs[0].second] + ": has " +
                     size_text(right.width, right.height) + " pixels, the left image " +
                     size_text(left.width, left.height) + "; expected the same");
  }
  const std::string wrong_side = source.calibration->wrong_side;
  dataset.rectify(std::move(*source.calibration), left);
  dataset.find_bits();
  dataset.check_pairs(wrong_side);
  dataset.ground_truth_ = std::move(source.truth);
  if (source.truth_of_quaternions) {
    for (const TimedPose& pose : dataset.ground_truth_) {
      dataset.ground_truth_w_first_.push_back({pose.stamp, with_w_first(pose.T)});
    }
  }
  if (raw) {
    // To the rectified left camera: from the body, or from the left camera as it is.
    for (Trajectory* truth : {&dataset.ground_truth_, &dataset.ground_truth_w_first_}) {
      for (TimedPose& pose : *truth) {
        if (!source.truth_of_body) pose.T = pose.T * T_BC.inverse();
        pose.T = pose.T * dataset.rectification_->T_BC();
      }
    }
  }
  dataset.imu_ = std::move(source.imu);
  if (raw) {
    const Eigen::Isometry3d T_BR = dataset.rectification_->T_BC();
    const Eigen::Quaterniond R(
        (T_BR.inverse() * (source.imu_in_body ? Eigen::Isometry3d::Identity() : T_BC_own))
            .linear());
    for (ImuSample& sample : dataset.imu_.samples) sample.R_BS = R * sample.R_BS;
  }
  return dataset;
}

/// The first pair of which both images can be read.
std::pair<RawImage, RawImage> StereoDataset::first_readable_pair() const {
  std::pair<RawImage, RawImage> images;
  Elements pairs("pairs");
  for (const auto& [l, r] : pairs_) {
    if (pairs.read([&, l = l, r = r] { images = {left_.read(l), right_.read(r)}; })) return images;
  }
  throw InputError(pairs.first());
}

void StereoDataset::rectify(StereoCalibration calibration, const RawImage& first) {
  if (calibration.rectified) {
    camera_ = calibration.camera;
    if (camera_.left.width == 0.0) {  // calib.txt does not say the size
      camera_.left.width = first.width;
      camera_.left.height = first.height;
      check_principal_point(calibration_from_, camera_.left);
    }
  } else {
    for (CalibratedCamera* camera : {&calibration.left, &calibration.right}) {
      if (camera->pinhole.width != 0.0) continue;
      camera->pinhole.width = first.width;
      camera->pinhole.height = first.height;
      check_principal_point(calibration_from_, camera->pinhole);
    }
    try {
      rectification_ = std::make_shared<const Rectification>(calibration.left, calibration.right);
    } catch (const std::invalid_argument& problem) {
      throw InputError(calibration_from_ + ": " + problem.what());
    }
    camera_ = rectification_->camera();
  }
  check_baseline(calibration_from_, camera_.baseline);
  if (first.width != camera_.left.width || first.height != camera_.left.height) {
    throw InputError(left_.names[pairs_[0].first] + ": has " +
                     size_text(first.width, first.height) + " pixels, the calibration is for " +
                     number_text(camera_.left.width) + " x " + number_text(camera_.left.height) +
                     "; expected the same");
  }
}

void StereoDataset::find_bits() {
  // One answer for all images, from some of them: the odometry compares their grey levels.
  constexpr std::size_t kSamples = 8;
  const std::size_t step = std::max<std::size_t>(1, pairs_.size() / kSamples);
  bool wide = false;
  Elements samples("pairs");
  for (std::size_t k = 0; k < pairs_.size(); k += step) {
    RawImage left, right;
    if (!samples.read([&] {
          left = left_.read(pairs_[k].first);
          right = right_.read(pairs_[k].second);
        })) {
      continue;
    }
    if (left.kind != RawImage::Kind::k16) break;
    wide = true;
    bits_ = std::max({bits_, significant_bits(left), significant_bits(right)});
  }
  if (wide) {
    notes_.push_back("16-bit images whose numbers have " + std::to_string(bits_) +
                     " bits: the upper 8 of these are used");
  }
}

void StereoDataset::check_pairs(const std::string& wrong_side) {
  // What the images themselves say. A pair that is dark, blurred or cannot be read says nothing:
  // ask a few along the recording.
  const std::string& name = right_.names[pairs_[0].second];
  std::string complaint;
  Elements samples("pairs");
  for (const int i : {0, size() / 2, size() - 1}) {
    StereoCheck check;
    if (!samples.read([&] {
          const Pair pair = read(i);
          check = check_stereo(pair.left.view(), pair.right.view());
        })) {
      continue;
    }
    complaint = stereo_complaint(check);
    if (!complaint.empty()) continue;
    if (wrong_side.empty()) return;
    if (check.matches >= kEnoughMatches && check.matches > 2 * check.matches_swapped) {
      notes_.push_back(wrong_side + ": taken for the right camera being " +
                       number_text(camera_.baseline) + " m to the right, as the images say (" +
                       std::to_string(check.matches) + " matches)");
      return;
    }
  }
  if (!complaint.empty()) throw InputError(name + ": " + complaint);
  if (samples.bad() == samples.all()) throw InputError(samples.first());
  if (!wrong_side.empty()) {
    throw InputError(wrong_side +
                     ", and the images have too little texture to say on which side the right "
                     "camera is; expected it to be negative");
  }
}

Image StereoDataset::read_grey(const ImageStream& camera, std::size_t i) const {
  const RawImage raw = camera.read(i);
  if (raw.width != camera_.left.width || raw.height != camera_.left.height) {
    throw InputError(camera.names[i] + ": has " + size_text(raw.width, raw.height) +
                     " pixels, the first image " + number_text(camera_.left.width) + " x " +
                     number_text(camera_.left.height) + "; expected the same");
  }
  return grey_image(raw, bits_, camera.names[i]);
}

StereoDataset::Pair StereoDataset::read(int i) const {
  const auto& [l, r] = pairs_[static_cast<std::size_t>(i)];
  Pair pair{read_grey(left_, l), read_grey(right_, r)};
  return rectification_ ? rectification_->pair(pair.left.view(), pair.right.view()) : pair;
}

}  // namespace prospect
