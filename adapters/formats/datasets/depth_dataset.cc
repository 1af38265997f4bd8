// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/depth_dataset.h"

#include <algorithm>
#include <utility>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/stereo_calibration.h"
#include "adapters/formats/datasets/trajectory.h"

namespace prospect {

namespace {

/// Its size is that of the images. Throws InputError if it states another.
PinholeCamera of_images(PinholeCamera camera, const std::string& from, const ImageStream& images) {
  const RawImage first = first_readable(images);
  if (camera.width != 0.0 && (camera.width != first.width || camera.height != first.height)) {
    throw InputError(from + ": is for images of " + number_text(camera.width) + " x " +
                     number_text(camera.height) + " pixels, these have " +
                     std::to_string(first.width) + " x " + std::to_string(first.height) +
                     "; expected the same");
  }
  camera.width = first.width;
  camera.height = first.height;
  check_principal_point(from, camera);
  return camera;
}

}  // namespace

DepthDataset DepthDataset::open(const std::string& path, const DepthDatasetOptions& options) {
  return open(open_depth_source(path, options), options);
}

DepthDataset DepthDataset::open(DepthSource source, const DepthDatasetOptions& options) {
  if (!source.missing.empty()) throw InputError(source.missing[0]);
  DepthDataset dataset;
  dataset.layout_ = source.layout;
  dataset.stereo_ = source.stereo;
  dataset.range_ = source.stereo ? source.stereo->range : options.range;
  dataset.times_assumed_ = source.times_assumed;
  dataset.without_pose_ = source.without_pose;
  dataset.images_ = source.images;
  dataset.sensors_.assign(source.images.size(), 0);
  dataset.cameras_ = {{of_images(*source.camera, source.camera_from, source.images)}};
  const PinholeCamera& camera = dataset.cameras_[0].camera;
  dataset.scale_ = choose_depth_scale(source, options, camera,
                                      [&](std::size_t i) { return dataset.read_raw(i); });
  if (dataset.scale_.w_first) {
    for (Eigen::Isometry3d& pose : source.poses) pose = with_w_first(pose);
  }
  dataset.poses_ = std::move(source.poses);
  dataset.add(std::move(source.more));
  dataset.notes_ = std::move(source.notes);
  dataset.notes_.push_back(dataset.scale_.note);
  return dataset;
}

void DepthDataset::add(std::vector<MoreDepthImages> more) {
  if (more.empty()) return;
  struct Place {
    double stamp;
    int sensor;
    std::size_t at;  // in its stream
  };
  std::vector<Place> order;
  std::vector<ImageStream> streams = {std::move(images_)};
  std::vector<DepthPoses> poses = {std::move(poses_)};
  for (MoreDepthImages& one : more) {
    cameras_.push_back({of_images(one.camera, one.camera_from, one.images), one.T_FC});
    streams.push_back(std::move(one.images));
    poses.push_back(std::move(one.poses));
  }
  for (std::size_t sensor = 0; sensor < streams.size(); ++sensor) {
    for (std::size_t at = 0; at < streams[sensor].size(); ++at) {
      order.push_back({streams[sensor].stamps[at], static_cast<int>(sensor), at});
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Place& a, const Place& b) { return a.stamp < b.stamp; });
  images_ = {};
  images_.name = streams[0].name;
  poses_.clear();
  sensors_.clear();
  for (const Place& place : order) {
    const auto sensor = static_cast<std::size_t>(place.sensor);
    images_.stamps.push_back(place.stamp);
    images_.names.push_back(streams[sensor].names[place.at]);
    poses_.push_back(poses[sensor][place.at]);
    sensors_.push_back(place.sensor);
  }
  images_.read = [order = std::move(order), streams = std::move(streams)](std::size_t i) {
    const Place& place = order.at(i);
    return streams[static_cast<std::size_t>(place.sensor)].read(place.at);
  };
}

RawImage DepthDataset::read_raw(std::size_t i) const {
  RawImage raw = images_.read(i);
  const std::string& name = images_.names[i];
  if (raw.kind == RawImage::Kind::k8 || raw.channels != 1) {
    throw InputError(name +
                     ": not of 16 bits a pixel; expected a depth image, 16-bit grey or floats");
  }
  const PinholeCamera& camera = cameras_[as_index(sensors_[i])].camera;
  if (raw.width != camera.width || raw.height != camera.height) {
    throw InputError(name + ": has " + std::to_string(raw.width) + " x " +
                     std::to_string(raw.height) + " pixels, the first image " +
                     number_text(camera.width) + " x " + number_text(camera.height) +
                     "; expected the same");
  }
  return raw;
}

DepthImage DepthDataset::read(int i) const {
  return scaled_depth(read_raw(static_cast<std::size_t>(i)), scale_.per_metre, range_);
}

}  // namespace prospect
