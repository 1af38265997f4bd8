// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

struct Vector3 {
  static constexpr const char* kType = "geometry_msgs/msg/Vector3";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
  }
};

struct Point {
  static constexpr const char* kType = "geometry_msgs/msg/Point";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
  }
};

struct Quaternion {
  static constexpr const char* kType = "geometry_msgs/msg/Quaternion";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double w = 1.0;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
    visit("w", m.w);
  }
};

struct Pose {
  static constexpr const char* kType = "geometry_msgs/msg/Pose";
  Point position;
  Quaternion orientation;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("position", m.position);
    visit("orientation", m.orientation);
  }
};

struct PoseStamped {
  static constexpr const char* kType = "geometry_msgs/msg/PoseStamped";
  Header header;
  Pose pose;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("pose", m.pose);
  }
};

/// Covariance of x, y, z and the turns about them, by rows.
struct PoseWithCovariance {
  static constexpr const char* kType = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose;
  std::array<double, 36> covariance = {};

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("pose", m.pose);
    visit("covariance", m.covariance);
  }
};

struct PoseWithCovarianceStamped {
  static constexpr const char* kType = "geometry_msgs/msg/PoseWithCovarianceStamped";
  Header header;
  PoseWithCovariance pose;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("pose", m.pose);
  }
};

struct Twist {
  static constexpr const char* kType = "geometry_msgs/msg/Twist";
  Vector3 linear;
  Vector3 angular;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("linear", m.linear);
    visit("angular", m.angular);
  }
};

struct TwistStamped {
  static constexpr const char* kType = "geometry_msgs/msg/TwistStamped";
  Header header;
  Twist twist;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("twist", m.twist);
  }
};

/// As PoseWithCovariance.
struct TwistWithCovariance {
  static constexpr const char* kType = "geometry_msgs/msg/TwistWithCovariance";
  Twist twist;
  std::array<double, 36> covariance = {};

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("twist", m.twist);
    visit("covariance", m.covariance);
  }
};

struct TwistWithCovarianceStamped {
  static constexpr const char* kType = "geometry_msgs/msg/TwistWithCovarianceStamped";
  Header header;
  TwistWithCovariance twist;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("twist", m.twist);
  }
};

struct Transform {
  static constexpr const char* kType = "geometry_msgs/msg/Transform";
  Vector3 translation;
  Quaternion rotation;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("translation", m.translation);
    visit("rotation", m.rotation);
  }
};

/// Coordinates of child_frame_id to those of the header's frame.
struct TransformStamped {
  static constexpr const char* kType = "geometry_msgs/msg/TransformStamped";
  Header header;
  std::string child_frame_id;
  Transform transform;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("child_frame_id", m.child_frame_id);
    visit("transform", m.transform);
  }
};

}  // namespace prospect::ros
