#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/datasets/ros_messages.h"
#include "adapters/files/input_error.h"

namespace prospect {

/// OMG's Common Data Representation, as ROS 2 writes it: numbers aligned to their size, counted
/// from behind the four bytes of the head. `name` stands for the message in errors: InputError, one
/// line. Bytes and name must outlive the reader.
class CdrReader {
 public:
  CdrReader(std::string_view bytes, const std::string& name) : name_(name) {
    if (bytes.size() < 4 || bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1)) {
      throw InputError(name + ": no message in CDR; expected one of ROS 2");
    }
    swap_ = bytes[1] == 0;  // (this machine is little-endian, as all that Prospect is built for)
    bytes_ = bytes.substr(4);
  }

  template <typename Number>
  Number number() {
    at_ = (at_ + sizeof(Number) - 1) / sizeof(Number) * sizeof(Number);
    char raw[sizeof(Number)];
    std::memcpy(raw, take(sizeof(Number)).data(), sizeof(Number));
    if (swap_) std::reverse(std::begin(raw), std::end(raw));
    Number value;
    std::memcpy(&value, raw, sizeof(Number));
    return value;
  }
  std::string text() {
    const auto size = number<std::uint32_t>();  // with the zero at its end
    const std::string_view all = take(size);
    return std::string(all.substr(0, size > 0 ? size - 1 : 0));
  }
  std::string_view bytes() { return take(number<std::uint32_t>()); }
  std::vector<double> doubles(std::size_t size) {
    if (size > bytes_.size() / 8) ends_early();
    std::vector<double> out(size);
    for (double& value : out) value = number<double>();
    return out;
  }
  std::vector<float> floats(std::size_t size) {
    if (size > bytes_.size() / 4) ends_early();
    std::vector<float> out(size);
    for (float& value : out) value = number<float>();
    return out;
  }
  std::uint32_t count() { return number<std::uint32_t>(); }
  RosHeader header() {
    RosHeader header;
    const auto seconds = number<std::int32_t>();
    const auto nanoseconds = number<std::uint32_t>();
    header.stamp = static_cast<double>(std::int64_t{seconds} * 1'000'000'000 + nanoseconds) * 1e-9;
    header.frame = text();
    return header;
  }
  /// Position and quaternion, x y z w.
  Eigen::Isometry3d pose() {
    const auto n = doubles(7);
    const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
    if (!(std::abs(q.norm() - 1.0) < 0.01) || !std::isfinite(n[0] + n[1] + n[2])) {
      throw InputError(name_ + ": not a pose; expected finite numbers and a unit quaternion");
    }
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = q.normalized().toRotationMatrix();
    T.translation() << n[0], n[1], n[2];
    return T;
  }

 private:
  std::string_view take(std::size_t size) {
    if (at_ > bytes_.size() || size > bytes_.size() - at_) ends_early();
    const std::string_view out = bytes_.substr(at_, size);
    at_ += size;
    return out;
  }
  [[noreturn]] void ends_early() const {
    throw InputError(name_ + ": the message ends early; expected all of it");
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  bool swap_ = false;
  const std::string& name_;
};

}  // namespace prospect
