// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/imu_recording.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

#include "adapters/formats/datasets/bag_poses.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/strict_yaml.h"
#include "adapters/formats/ros/sensor_msgs.h"

namespace prospect {
namespace {

bool is_imu_topic(const BagTopic& topic) { return is_of_type(topic, ros::Imu::kType); }

/// The axes of the sensor in the body, by T_BS.
Eigen::Quaterniond read_axes(const std::string& path) {
  std::string text = read_whole_file(path);
  if (!text.empty() && text[0] == '%') text.insert(0, "#");
  StrictYaml yaml = StrictYaml::from_text(text, path);
  YamlMap root = yaml.root();
  root.choice("sensor_type", "imu", {"imu"}, "kind of sensor");
  YamlMap T = root.map("T_BS");
  T.integer("cols", 4, 4, 4, "1", "columns");
  T.integer("rows", 4, 4, 4, "1", "rows");
  const auto data = T.required_numbers("data", 16, -1000, 1000, "1", "sensor to body, by rows");
  T.leave_rest();
  root.leave_rest();
  yaml.finish();
  Eigen::Matrix3d R;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = data[static_cast<std::size_t>(i / 3 * 4 + i % 3)];
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 0.01 || R.determinant() < 0.0) {
    throw InputError(path + ": T_BS is not a rotation and translation; expected one");
  }
  return Eigen::Quaterniond(R).normalized();
}

void leave_out(ImuRecording& imu, const InputError& error, std::vector<std::string>& notes) {
  imu.samples.clear();
  notes.push_back(error.lines()[0] + "; the IMU is left out");
}

}  // namespace

ImuRecording read_euroc_imu(const std::string& root, double unit, std::vector<std::string>& notes) {
  ImuRecording imu;
  const std::string csv = root + "/imu0/data.csv";
  std::error_code none;
  if (!std::filesystem::exists(csv, none)) return imu;
  imu.from = csv;
  try {
    const Eigen::Quaterniond R_BS = read_axes(root + "/imu0/sensor.yaml");
    Elements samples("samples of " + csv);
    std::istringstream lines(read_whole_file(csv));
    std::string line;
    std::vector<double> n;
    for (int k = 1; std::getline(lines, line); ++k) {
      if (line.empty() || line[0] == '#' || line == "\r" ||
          (k == 1 && !parse_any_numbers(line, n))) {
        continue;
      }
      samples.read([&] {
        ImuSample sample;
        if (parse_any_numbers(line, n) && n.size() >= 7) {
          sample = {n[0] * unit, {n[1], n[2], n[3]}, {n[4], n[5], n[6]}, R_BS};
        }
        if (!(sample.stamp > 0.0) || !std::isfinite(sample.stamp) || !sample.finite() ||
            (!imu.samples.empty() && !(sample.stamp > imu.samples.back().stamp))) {
          throw InputError(csv + ":" + std::to_string(k) +
                           ": not a sample; expected time [ns], angular velocity [rad/s], specific "
                           "force [m/s2], times that increase");
        }
        imu.samples.push_back(sample);
      });
    }
    samples.finish(notes);
  } catch (const InputError& error) {
    leave_out(imu, error, notes);
  }
  return imu;
}

ImuRecording read_bag_imu(const BagFile& bag, const std::string& path, const TopicChoice& topics,
                          const std::string& camera, std::vector<std::string>& notes) {
  ImuRecording imu;
  const BagTopic* topic = given_topic(bag, path, topics, "imu", is_imu_topic);
  const bool given = topic != nullptr;
  std::string others;
  if (!given) {
    for (const BagTopic& one : bag.topics()) {
      if (!is_imu_topic(one) || one.messages.empty()) continue;
      if (topic == nullptr || one.messages.size() > topic->messages.size()) topic = &one;
    }
    if (topic == nullptr) return imu;
    for (const BagTopic& one : bag.topics()) {
      if (&one == topic || !is_imu_topic(one) || one.messages.empty()) continue;
      others += (others.empty() ? "; not used: " : ", ") + one.name;
    }
  }
  imu.from = topic->name;
  try {
    const std::string frame = frame_of(bag, *topic);
    std::vector<std::string> of_transforms;  // which who reads poses says, too
    const auto tree = read_transforms(bag, of_transforms);
    const auto T_CS =
        frame.empty() || camera.empty() ? std::nullopt : tree->find(camera, frame, 0.0);
    if (!T_CS) {
      throw InputError(topic->name + ": no static transform leads from its frame '" + frame +
                       "' to the camera's, '" + camera + "'");
    }
    const Eigen::Quaterniond R_CS = Eigen::Quaterniond(T_CS->linear()).normalized();
    Elements samples("samples of " + topic->name);
    for (const auto& [stamp, i] : stamped_messages(bag, *topic, "samples", notes)) {
      samples.read([&, stamp = stamp, i = i] {
        ImuSample sample =
            read_ros_imu(read_message(bag, *topic, i), message_name(*topic, i)).sample;
        sample.stamp = stamp;
        sample.R_BS = R_CS;
        imu.samples.push_back(sample);
      });
    }
    samples.finish(notes);
    if (!given) notes.push_back("topic imu=" + topic->name + ", by its type" + others);
  } catch (const InputError& error) {
    leave_out(imu, error, notes);
  }
  return imu;
}

}  // namespace prospect
