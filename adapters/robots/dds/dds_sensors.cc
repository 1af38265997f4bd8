// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_sensors.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "adapters/formats/datasets/depth_scale.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/raw_image.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/ros_scan_messages.h"
#include "adapters/formats/datasets/stereo_calibration.h"
#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/image_codec.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "models/robot_description.h"
#include "perception/odometry/rectification.h"

namespace prospect {
namespace {

/// kDepthCamera + n: of depth sensor n.
using Camera = std::size_t;
constexpr Camera kLeftCamera = 0, kRightCamera = 1, kDepthCamera = 2;
constexpr std::size_t kCameras = kDepthCamera + static_cast<std::size_t>(kMostDepthSensors);

struct ReceivedInfo {
  CameraInfo info;
  std::string frame;

  bool operator==(const ReceivedInfo&) const = default;
};

/// What images are read by, once it is known.
struct Reading {
  DdsCameras cameras;
  std::shared_ptr<const Rectification> rectification;  // null: they are rectified
  std::array<std::array<int, 2>, kCameras> sizes{};    // [px]
};

std::string size_text(double width, double height) {
  return number_text(width) + " x " + number_text(height);
}

}  // namespace

struct DdsSensors::Impl {
  Impl(const DdsOptions& given, DdsNode& its_node, DdsTransforms& its_transforms,
       ImageSink& its_sink)
      : options(given), node(its_node), transforms(its_transforms), sink(its_sink) {}

  /// Null: not known yet. Throws InputError if the camera's calibration is another one by now.
  std::shared_ptr<const Reading> reading(Camera camera, const std::string& name) const {
    const std::lock_guard lock(mutex);
    if (changed[camera]) {
      throw InputError(name + ": an image of another calibration; expected the one before");
    }
    return known;
  }

  void take_info(Camera camera, std::string_view cdr, const std::string& name) {
    ReceivedInfo info{read_ros_camera_info(cdr, name), read_ros_header(cdr, name).frame};
    const std::lock_guard lock(mutex);
    if (known) {
      // What is driven by was made of the first one.
      changed[camera] = infos[camera] && !(*infos[camera] == info);
      if (!changed[camera]) return;
      throw InputError(name +
                       ": another calibration than before; expected the one that the images "
                       "are read by, which are left out until it is back");
    }
    infos[camera] = std::move(info);
    came.notify_all();
  }

  void take_image(Camera camera, std::string_view cdr, const std::string& name) const {
    const std::shared_ptr<const Reading> by = reading(camera, name);
    if (!by) return;
    const RosHeader header = read_ros_header(cdr, name);
    check_frame(camera, header, name);
    const double stamp = header.stamp;
    const DdsOptions::Depth* const depth = depth_of(camera);
    const RawImage raw =
        read_ros_image(cdr, depth ? depth->compressed : options.stereo.compressed, name);
    const auto [width, height] = by->sizes[camera];
    if (raw.width != width || raw.height != height) {
      throw InputError(name + ": an image of " + size_text(raw.width, raw.height) +
                       " pixels; expected " + size_text(width, height) + " of its camera_info");
    }
    if (depth) {
      const bool floats = raw.kind == RawImage::Kind::kFloat;
      DepthImage image =
          scaled_depth(raw, floats ? 1.0 : depth->per_metre, {depth->min_range, depth->max_range});
      if (!image.whole()) throw InputError(name + ": no depths; expected encoding 16UC1 or 32FC1");
      return sink.observe(DepthFrame{stamp, std::make_shared<const DepthImage>(std::move(image)),
                                     static_cast<int>(camera - kDepthCamera)});
    }
    Image grey = grey_image(raw, raw.kind == RawImage::Kind::k16 ? 16 : 8, name);
    if (by->rectification) {
      grey = camera == kLeftCamera ? by->rectification->left(grey.view())
                                   : by->rectification->right(grey.view());
    }
    camera == kLeftCamera ? sink.left(stamp, std::move(grey)) : sink.right(stamp, std::move(grey));
  }

  /// Throws unless an image is of the frame that its place is known of: that of its camera_info
  /// where tf tells it; else that of the first one. Drivers give a pair's right images the left
  /// frame.
  void check_frame(Camera camera, const RosHeader& header, const std::string& name) const {
    const std::lock_guard lock(mutex);
    std::optional<std::string>& frame = frames[camera];
    const bool by_info = options.mounts_from_tf && camera != kRightCamera;
    if (!frame) frame = by_info ? infos[camera]->frame : header.frame;
    if (without_slash(header.frame).empty() ||
        without_slash(header.frame) == without_slash(*frame)) {
      return;
    }
    throw InputError(name + ": an image of frame '" + header.frame + "'; expected '" + *frame +
                     (by_info ? "' of its camera_info" : "' as before"));
  }

  /// Of a sensor's frame in B. Throws InputError if tf does not connect them then.
  Eigen::Isometry3d in_base(const RosHeader& header, const std::string& name) const {
    const auto T = transforms.find(options.frames.base, header.frame, header.stamp);
    if (!T) {
      throw InputError(name + ": no transform from '" + header.frame + "' to '" +
                       options.frames.base + "' at its stamp; expected it on " + options.tf_static +
                       " or " + options.tf);
    }
    return *T;
  }

  /// Null: a camera of the pair.
  const DdsOptions::Depth* depth_of(Camera camera) const {
    if (camera < kDepthCamera) return nullptr;
    return camera == kDepthCamera ? &options.depth
                                  : &options.more_depth[camera - kDepthCamera - 1].depth;
  }

  void take_rays(DepthScan rays, double stamp, const Eigen::Isometry3d& T, int sensor) const {
    rays.origin = T.translation();
    for (auto* points : {&rays.hits, &rays.misses}) {
      for (Eigen::Vector3d& p : *points) p = T * p;
    }
    sink.observe(
        ScanFrame{stamp, std::make_shared<const DepthScan>(std::move(rays)), nullptr, sensor});
  }

  void take_scan(std::string_view cdr, const std::string& name, int sensor) {
    const RosHeader header = read_ros_header(cdr, name);
    const RosLaserScan scan = read_ros_laser_scan(cdr, name);
    const Eigen::Isometry3d T = in_base(header, name);
    {
      const std::lock_guard lock(mutex);
      if (!scan.ranges.empty()) lidars.try_emplace(sensor, lidar_of(scan, T));
      came.notify_all();
    }
    take_rays(rays_of(scan), header.stamp, T, sensor);
  }

  void take_imu(std::string_view cdr, const std::string& name) const {
    RosImu told = read_ros_imu(cdr, name);
    if (without_slash(told.header.frame) != options.frames.base) {
      told.sample.R_BS = Eigen::Quaterniond(in_base(told.header, name).linear());
    }
    sink.observe(told.sample);
  }

  static DdsLidar lidar_of(const RosLaserScan& scan, const Eigen::Isometry3d& T) {
    const double span = scan.angle_increment * static_cast<double>(scan.ranges.size());
    const double middle = scan.angle_min + 0.5 * (span - scan.angle_increment);
    const Eigen::Vector3d along =
        T.linear() * Eigen::Vector3d(std::cos(middle), std::sin(middle), 0.0);
    return {std::min(std::abs(span), 2.0 * M_PI), scan.range_min, scan.range_max,
            CameraMount{
                CameraMount::forward_facing(T.translation(), std::atan2(along.y(), along.x()))}};
  }
  /// Whether it is the lidar whose view the planner counts on.
  bool sees_by_scan() const { return !options.scan.empty() && options.depth.image.empty(); }

  /// The lines of what has not come; empty: all is there.
  std::vector<std::string> missing() const {
    std::array<std::pair<std::string, const char*>, kCameras> wanted = {
        {{options.stereo.left_info, "the left camera's calibration"},
         {options.stereo.right_info, "the right camera's calibration"},
         {options.depth.info, "the depth camera's calibration"}}};
    std::map<int, std::string> scans;
    if (sees_by_scan()) scans[0] = options.scan;
    for (std::size_t n = 0; n < options.more_depth.size(); ++n) {
      wanted[kDepthCamera + 1 + n] = {options.more_depth[n].depth.info,
                                      "the depth camera's calibration"};
      if (!options.more_depth[n].scan.empty()) {
        scans[static_cast<int>(n) + 1] = options.more_depth[n].scan;
      }
    }
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < kCameras; ++k) {
      if (wanted[k].first.empty() || infos[k]) continue;
      const std::string fault = node.fault(wanted[k].first);
      lines.push_back(fault.empty() ? wanted[k].first + ": no message within " +
                                          number_text(options.timeout) + " s; expected " +
                                          wanted[k].second + " (sensor_msgs/msg/CameraInfo)"
                                    : fault);
    }
    for (const auto& [sensor, topic] : scans) {
      if (lidars.contains(sensor)) continue;
      const std::string fault = node.fault(topic);
      lines.push_back(fault.empty()
                          ? topic + ": no message within " + number_text(options.timeout) +
                                " s; expected scans (sensor_msgs/msg/LaserScan)"
                          : fault);
    }
    if (!lines.empty() || !options.mounts_from_tf) return lines;
    for (Camera camera = 0; camera < kCameras; ++camera) {
      if (camera == kRightCamera || wanted[camera].first.empty() ||
          transforms.newest(options.frames.base, infos[camera]->frame)) {
        continue;
      }
      lines.push_back(options.tf_static + ", " + options.tf + ": no transform from '" +
                      infos[camera]->frame + "' to '" + options.frames.base + "' within " +
                      number_text(options.timeout) +
                      " s; expected where the camera is (or mounts: robot)");
    }
    return lines;
  }

  Reading make_reading() const {
    Reading out;
    const auto size = [&](Camera camera, const std::string& topic) {
      const CameraInfo& info = infos[camera]->info;
      if (!(info.width >= 1.0 && info.height >= 1.0)) {
        throw InputError(topic + ": an image of " + size_text(info.width, info.height) +
                         " pixels; expected a size");
      }
      out.sizes[camera] = {static_cast<int>(info.width), static_cast<int>(info.height)};
    };
    Eigen::Isometry3d T_left = Eigen::Isometry3d::Identity();  // of the rectified left camera
    if (!options.stereo.left_info.empty()) {
      const DdsOptions::Stereo& stereo = options.stereo;
      size(kLeftCamera, stereo.left_info);
      size(kRightCamera, stereo.right_info);
      const StereoCalibration calibration =
          calibration_of(infos[kLeftCamera]->info, infos[kRightCamera]->info, stereo.left_info,
                         stereo.right_info, stereo.rectified);
      if (calibration.rectified) {
        out.cameras.stereo = calibration.camera;
        T_left = rectified_axes(infos[kLeftCamera]->info);
      } else {
        try {
          out.rectification =
              std::make_shared<const Rectification>(calibration.left, calibration.right);
        } catch (const std::invalid_argument& problem) {
          throw InputError(stereo.right_info + ": " + problem.what());
        }
        out.cameras.stereo = out.rectification->camera();
        T_left = calibration.left.T_BC.inverse() * out.rectification->T_BC();
      }
    }
    if (sees_by_scan()) out.cameras.lidar = lidars.at(0);
    for (std::size_t n = 0; n < options.more_depth.size(); ++n) {
      const auto sensor = static_cast<int>(n) + 1;
      if (const auto lidar = lidars.find(sensor); lidar != lidars.end()) {
        out.cameras.more_lidars.insert(*lidar);
      }
    }
    const auto mount = [&](Camera camera) {
      transforms.hold(options.frames.base, infos[camera]->frame);
      return *transforms.newest(options.frames.base, infos[camera]->frame);
    };
    if (options.mounts_from_tf && out.cameras.stereo) {
      out.cameras.stereo_mount = CameraMount{mount(kLeftCamera) * T_left};
    }
    for (int sensor = 0; sensor <= static_cast<int>(options.more_depth.size()); ++sensor) {
      const Camera camera = kDepthCamera + static_cast<Camera>(sensor);
      const DdsOptions::Depth& depth = *depth_of(camera);
      if (depth.info.empty()) continue;
      size(camera, depth.info);
      const CameraInfo& info = infos[camera]->info;
      std::vector<std::string> notes;  // of a lens that moves pixels a little
      const PinholeCamera model = depth_camera_of(info, depth.rectified, depth.info, notes);
      try {
        validate(model);
      } catch (const std::invalid_argument& problem) {
        throw InputError(depth.info + ": " + problem.what());
      }
      std::optional<CameraMount> place;
      if (options.mounts_from_tf) {
        const Eigen::Isometry3d turn =
            depth.rectified ? rectified_axes(info) : Eigen::Isometry3d::Identity();
        place = CameraMount{mount(camera) * turn};
      }
      if (sensor == 0) {
        out.cameras.depth = model;
        out.cameras.depth_mount = place;
      } else {
        out.cameras.more_depth[sensor] = model;
        if (place) out.cameras.more_mounts[sensor] = *place;
      }
    }
    return out;
  }

  const DdsOptions options;
  DdsNode& node;
  DdsTransforms& transforms;
  ImageSink& sink;
  mutable std::mutex mutex;
  mutable std::condition_variable came;
  std::array<std::optional<ReceivedInfo>, kCameras> infos;
  mutable std::array<std::optional<std::string>, kCameras> frames;  // of the images
  std::map<int, DdsLidar> lidars;        // of each depth sensor, by its first scan
  std::array<bool, kCameras> changed{};  // the newest calibration is not that of `known`
  mutable std::shared_ptr<const Reading> known;
};

DdsSensors::DdsSensors(const DdsOptions& options, DdsNode& node, DdsTransforms& transforms,
                       ImageSink& frames)
    : impl_(std::make_shared<Impl>(options, node, transforms, frames)) {
  const auto impl = impl_;
  const auto info = [&](const std::string& topic, Camera camera) {
    if (topic.empty()) return;
    node.subscribe(topic, ros::definition_of<ros::CameraInfo>(), kSensorQos,
                   [impl, camera](std::string_view cdr, const std::string& name) {
                     impl->take_info(camera, cdr, name);
                   });
  };
  const auto images = [&](const std::string& topic, bool compressed, Camera camera) {
    if (topic.empty()) return;
    if (compressed) load_image_codecs();
    node.subscribe(
        topic,
        compressed ? ros::definition_of<ros::CompressedImage>() : ros::definition_of<ros::Image>(),
        kSensorQos, [impl, camera](std::string_view cdr, const std::string& name) {
          impl->take_image(camera, cdr, name);
        });
  };
  info(options.stereo.left_info, kLeftCamera);
  info(options.stereo.right_info, kRightCamera);
  info(options.depth.info, kDepthCamera);
  images(options.stereo.left, options.stereo.compressed, kLeftCamera);
  images(options.stereo.right, options.stereo.compressed, kRightCamera);
  images(options.depth.image, options.depth.compressed, kDepthCamera);
  const auto scans = [&](const std::string& topic, int sensor) {
    if (topic.empty()) return;
    node.subscribe(topic, ros::definition_of<ros::LaserScan>(), kSensorQos,
                   [impl, sensor](std::string_view cdr, const std::string& name) {
                     impl->take_scan(cdr, name, sensor);
                   });
  };
  const auto clouds = [&](const std::string& topic, int sensor) {
    if (topic.empty()) return;
    node.subscribe(topic, ros::definition_of<ros::PointCloud2>(), kSensorQos,
                   [impl, sensor](std::string_view cdr, const std::string& name) {
                     const RosHeader header = read_ros_header(cdr, name);
                     DepthScan rays;
                     rays.hits = read_ros_point_cloud(cdr, name);
                     impl->take_rays(std::move(rays), header.stamp, impl->in_base(header, name),
                                     sensor);
                   });
  };
  if (!options.imu.empty()) {
    constexpr DdsQos kImuQos{false, false, 50};
    node.subscribe(
        options.imu, ros::definition_of<ros::Imu>(), kImuQos,
        [impl](std::string_view cdr, const std::string& name) { impl->take_imu(cdr, name); });
  }
  scans(options.scan, 0);
  clouds(options.point_cloud, 0);
  for (std::size_t n = 0; n < options.more_depth.size(); ++n) {
    const DdsOptions::MoreDepth& more = options.more_depth[n];
    const auto sensor = static_cast<int>(n) + 1;
    info(more.depth.info, kDepthCamera + n + 1);
    images(more.depth.image, more.depth.compressed, kDepthCamera + n + 1);
    scans(more.scan, sensor);
    clouds(more.point_cloud, sensor);
  }
}
DdsSensors::~DdsSensors() = default;

DdsCameras DdsSensors::wait() const {
  std::unique_lock lock(impl_->mutex);
  // What tf tells is looked for again and again.
  constexpr std::chrono::milliseconds kLook(20);
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(impl_->options.timeout);
  std::vector<std::string> missing = impl_->missing();
  while (!missing.empty() && std::chrono::steady_clock::now() < end) {
    impl_->came.wait_for(lock, kLook);
    missing = impl_->missing();
  }
  if (!missing.empty()) throw InputError(missing);
  impl_->known = std::make_shared<const Reading>(impl_->make_reading());
  return impl_->known->cameras;
}

}  // namespace prospect
