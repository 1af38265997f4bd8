// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "adapters/formats/files/not_built_in.h"
#include "adapters/robots/simulator/pixel_noise.h"

namespace prospect {

void GazeboImageNoise::add(GazeboPair& pair) const {
  if (!(sigma > 0.0)) return;
  const auto frame = static_cast<std::uint64_t>(std::llround(1e9 * pair.stamp));
  std::uint64_t camera = 0;
  for (Image* const image : {&pair.images.left, &pair.images.right}) {
    const PixelNoise noise(seed, frame, camera++);
    std::uint32_t number = 0;
    for (std::uint8_t& pixel : image->pixels) {
      const float noisy =
          static_cast<float>(pixel) + static_cast<float>(sigma) * noise.gaussian(number++);
      // NOLINTNEXTLINE(bugprone-incorrect-roundings): it is not negative
      pixel = static_cast<std::uint8_t>(std::clamp(noisy, 0.0f, 255.0f) + 0.5f);
    }
  }
}

const GazeboPoses::Named* GazeboPoses::find(std::string_view name) const {
  const Named* found = nullptr;
  for (const Named& pose : poses) {
    if (pose.name == name) found = &pose;
  }
  return found;
}

}  // namespace prospect

#ifdef PROSPECT_WITH_PROTOBUF

#include <bit>
#include <cstring>
#include <stdexcept>

#include "adapters/robots/gazebo/messages.pb.h"

static_assert(std::endian::native == std::endian::little, "depths are taken as they come");

namespace prospect {
namespace {

namespace msgs = gazebo::msgs;

constexpr std::uint32_t kMostPixels = 1u << 14;  // a side
constexpr double kFastestTurn = 3.0;             // [rad/s]

// Gazebo's Image::PixelFormat.
enum PixelFormat : std::uint32_t { kGrey = 1, kRgb = 3, kRgba = 4, kBgra = 5, kBgr = 8 };

double seconds(const msgs::Time& time) { return time.sec() + 1e-9 * time.nsec(); }

template <typename Message>
Message read(std::string_view bytes, const char* name) {
  Message message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    throw std::runtime_error(std::string("bytes that are no ") + name);
  }
  return message;
}

void check_size(const msgs::Image& image, std::size_t bytes_a_pixel) {
  const std::size_t row = image.width() * bytes_a_pixel;
  if (image.width() == 0 || image.height() == 0 || image.width() > kMostPixels ||
      image.height() > kMostPixels || image.data().size() != row * image.height()) {
    throw std::runtime_error("an image of " + std::to_string(image.width()) + " x " +
                             std::to_string(image.height()) + " pixels in " +
                             std::to_string(image.data().size()) + " bytes; expected " +
                             std::to_string(bytes_a_pixel) + " bytes a pixel");
  }
}

Image grey(const msgs::Image& image) {
  const std::uint32_t format = image.pixel_format();
  const bool four = format == kRgba || format == kBgra;
  const std::size_t channels = format == kGrey ? 1 : four ? 4 : 3;
  if (format != kGrey && format != kRgb && format != kBgr && !four) {
    throw std::runtime_error("an image of pixel format " + std::to_string(format) +
                             "; expected L8, R8G8B8, B8G8R8, or these with alpha");
  }
  check_size(image, channels);
  Image out(static_cast<int>(image.width()), static_cast<int>(image.height()));
  const auto* in = reinterpret_cast<const std::uint8_t*>(image.data().data());
  if (channels == 1) {
    std::copy(in, in + out.pixels.size(), out.pixels.begin());
    return out;
  }
  // In 65536ths, which sum to 1.
  const bool blue_first = format == kBgr || format == kBgra;
  const std::uint32_t first = blue_first ? 7471 : 19595, third = blue_first ? 19595 : 7471;
  for (std::uint8_t& pixel : out.pixels) {
    pixel =
        static_cast<std::uint8_t>((first * in[0] + 38470u * in[1] + third * in[2] + 32768u) >> 16);
    in += channels;
  }
  return out;
}

}  // namespace

GazeboPoses read_gazebo_poses(std::string_view message) {
  const auto in = read<msgs::PosesStamped>(message, "PosesStamped");
  GazeboPoses out;
  out.stamp = seconds(in.time());
  out.poses.reserve(static_cast<std::size_t>(in.pose_size()));
  for (const msgs::Pose& p : in.pose()) {
    const msgs::Vector3d& t = p.position();
    const msgs::Quaternion& q = p.orientation();
    out.poses.push_back({p.name(), {t.x(), t.y(), t.z()}, {q.w(), q.x(), q.y(), q.z()}});
    const double size = out.poses.back().orientation.norm();
    if (!out.poses.back().position.allFinite() || !(std::abs(size - 1.0) < 1e-3)) {
      throw std::runtime_error("the pose of " + p.name() + " is no pose");
    }
  }
  return out;
}

GazeboPair read_gazebo_pair(std::string_view message) {
  const auto in = read<msgs::ImagesStamped>(message, "ImagesStamped");
  if (in.image_size() != 2) {
    throw std::runtime_error(std::to_string(in.image_size()) + " images; expected left and right");
  }
  GazeboPair out{seconds(in.time()), {grey(in.image(0)), grey(in.image(1))}};
  if (out.images.left.width != out.images.right.width ||
      out.images.left.height != out.images.right.height) {
    throw std::runtime_error("images of two sizes; expected a pair of one");
  }
  return out;
}

GazeboDepth read_gazebo_depth(std::string_view message, const DepthRange& range) {
  const auto in = read<msgs::ImageStamped>(message, "ImageStamped");
  const msgs::Image& image = in.image();
  // Its pixel format says what the colours would be.
  check_size(image, sizeof(float));
  std::vector<float> metres(image.data().size() / sizeof(float));
  std::memcpy(metres.data(), image.data().data(), image.data().size());
  const auto width = static_cast<int>(image.width());
  return {seconds(in.time()),
          depth_image(metres.data(), width, static_cast<int>(image.height()), width, range)};
}

ImuSample read_gazebo_imu(std::string_view message) {
  const auto in = read<msgs::IMU>(message, "IMU");
  const auto vector = [](const msgs::Vector3d& v) { return Eigen::Vector3d(v.x(), v.y(), v.z()); };
  ImuSample out;
  out.stamp = seconds(in.stamp());
  out.angular_velocity = vector(in.angular_velocity());
  out.linear_acceleration = vector(in.linear_acceleration());
  if (!out.finite()) throw std::runtime_error("a sample of an IMU that is not finite");
  return out;
}

std::string gazebo_velocity(const Twist& velocity, bool turned_yaw) {
  const double turn = std::clamp(velocity.yaw_rate, -kFastestTurn, kFastestTurn);
  const double half = 0.5 * (turned_yaw ? -turn : turn);
  msgs::Pose out;
  out.mutable_position()->set_x(velocity.linear.x());
  out.mutable_position()->set_y(0.0);
  out.mutable_position()->set_z(0.0);
  out.mutable_orientation()->set_x(0.0);
  out.mutable_orientation()->set_y(0.0);
  out.mutable_orientation()->set_z(std::sin(half));
  out.mutable_orientation()->set_w(std::cos(half));
  return out.SerializeAsString();
}

}  // namespace prospect

#else

namespace prospect {
namespace {
[[noreturn]] void absent() {
  throw NotBuiltIn("the transport of Gazebo", "libprotobuf-dev and protobuf-compiler");
}
}  // namespace
GazeboPoses read_gazebo_poses(std::string_view) { absent(); }
GazeboPair read_gazebo_pair(std::string_view) { absent(); }
GazeboDepth read_gazebo_depth(std::string_view, const DepthRange&) { absent(); }
ImuSample read_gazebo_imu(std::string_view) { absent(); }
std::string gazebo_velocity(const Twist&, bool) { absent(); }
}  // namespace prospect

#endif
