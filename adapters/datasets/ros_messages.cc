#include "adapters/datasets/ros_messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "adapters/datasets/cdr_reader.h"
#include "adapters/files/input_error.h"

namespace prospect {
namespace {

struct RosEncoding {
  const char* name;
  int type;        ///< of OpenCV
  int conversion;  ///< of OpenCV, to blue, green, red or grey; -1: none
};
constexpr RosEncoding kRosEncodings[] = {
    {"mono8", CV_8UC1, -1},
    {"8UC1", CV_8UC1, -1},
    {"mono16", CV_16UC1, -1},
    {"16UC1", CV_16UC1, -1},
    {"32FC1", CV_32FC1, -1},
    {"bgr8", CV_8UC3, -1},
    {"8UC3", CV_8UC3, -1},
    {"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
    {"bgra8", CV_8UC4, -1},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGRA},
    {"bgr16", CV_16UC3, -1},
    {"rgb16", CV_16UC3, cv::COLOR_RGB2BGR},
    // OpenCV names a pattern by its second row's second and third pixel.
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2BGR},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2BGR},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2BGR},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2BGR},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    {"uyvy", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
    {"yuyv", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2}};

}  // namespace

RosHeader read_ros_header(std::string_view cdr, const std::string& name) {
  return CdrReader(cdr, name).header();
}

RawImage read_ros_image(std::string_view cdr, bool compressed, const std::string& name) {
  CdrReader r(cdr, name);
  r.header();
  if (compressed) {
    const std::string format = r.text();
    std::string_view data = r.bytes();
    // compressed_depth_image_transport puts a head of twelve bytes before the PNG.
    if (format.find("compressedDepth") != std::string::npos) {
      if (format.find("rvl") != std::string::npos) {
        throw InputError(name + ": depth compressed by RVL; expected PNG");
      }
      if (format.find("32FC1") != std::string::npos) {
        throw InputError(name + ": compressed depth of floats; expected 16UC1");
      }
      data = data.substr(std::min<std::size_t>(12, data.size()));
    }
    return decode_image(data, name);
  }
  const auto height = r.number<std::uint32_t>(), width = r.number<std::uint32_t>();
  const std::string encoding = r.text();
  const bool big_endian = r.number<std::uint8_t>() != 0;
  const auto step = r.number<std::uint32_t>();
  const std::string_view data = r.bytes();
  const RosEncoding* known = nullptr;
  std::string names;
  for (const RosEncoding& one : kRosEncodings) {
    if (encoding == one.name) known = &one;
    names += (names.empty() ? "" : ", ") + std::string(one.name);
  }
  if (known == nullptr) {
    throw InputError(name + ": images in encoding '" + encoding + "'; expected one of: " + names);
  }
  const auto pixel = static_cast<std::uint64_t>(CV_ELEM_SIZE(known->type));
  if (width < 1 || height < 1 || width > 100'000 || height > 100'000 || step < width * pixel ||
      data.size() < std::uint64_t{step} * (height - 1) + width * pixel) {
    throw InputError(name + ": an image of " + std::to_string(width) + " x " +
                     std::to_string(height) + " pixels in " + std::to_string(data.size()) +
                     " bytes; expected all of its rows");
  }
  cv::Mat image(static_cast<int>(height), static_cast<int>(width), known->type,
                const_cast<char*>(data.data()), step);
  if (known->conversion >= 0) {
    cv::Mat converted;
    cv::cvtColor(image, converted, known->conversion);
    image = converted;
  }
  RawImage raw;
  raw.width = image.cols;
  raw.height = image.rows;
  raw.channels = image.channels();
  raw.kind = image.depth() == CV_8U    ? RawImage::Kind::k8
             : image.depth() == CV_16U ? RawImage::Kind::k16
                                       : RawImage::Kind::kFloat;
  const std::size_t row = image.elemSize() * static_cast<std::size_t>(image.cols);
  raw.bytes.resize(row * static_cast<std::size_t>(image.rows));
  for (int v = 0; v < image.rows; ++v) {
    std::memcpy(raw.bytes.data() + static_cast<std::size_t>(v) * row, image.ptr(v), row);
  }
  if (big_endian && raw.kind != RawImage::Kind::k8) {
    const auto size = static_cast<std::size_t>(raw.bytes_per_number());
    for (std::size_t i = 0; i + size <= raw.bytes.size(); i += size) {
      std::reverse(raw.bytes.begin() + static_cast<std::ptrdiff_t>(i),
                   raw.bytes.begin() + static_cast<std::ptrdiff_t>(i + size));
    }
  }
  return raw;
}

CameraInfo read_ros_camera_info(std::string_view cdr, const std::string& name) {
  CdrReader r(cdr, name);
  r.header();
  CameraInfo info;
  info.height = r.number<std::uint32_t>();
  info.width = r.number<std::uint32_t>();
  info.model = r.text();
  info.D = r.doubles(r.count());
  info.K = r.doubles(9);
  info.R = r.doubles(9);
  info.P = r.doubles(12);
  for (const auto* numbers : {&info.D, &info.K, &info.R, &info.P}) {
    for (const double value : *numbers) {
      if (!std::isfinite(value)) {
        throw InputError(name + ": a calibration that is not finite; expected numbers");
      }
    }
  }
  return info;
}

std::vector<RosTransform> read_ros_transforms(std::string_view cdr, const std::string& name) {
  CdrReader r(cdr, name);
  std::vector<RosTransform> out;
  for (std::uint32_t left = r.count(); left > 0; --left) {
    const RosHeader header = r.header();
    RosTransform transform;
    transform.stamp = header.stamp;
    transform.parent = header.frame;
    transform.child = r.text();
    transform.T = r.pose();
    out.push_back(transform);
  }
  return out;
}

bool is_ros_pose(const std::string& type) {
  return type == "nav_msgs/msg/Odometry" || type == "geometry_msgs/msg/PoseStamped" ||
         type == "geometry_msgs/msg/TransformStamped";
}

RosTransform read_ros_pose(std::string_view cdr, const std::string& type, const std::string& name) {
  CdrReader r(cdr, name);
  const RosHeader header = r.header();
  RosTransform out;
  out.stamp = header.stamp;
  out.parent = header.frame;
  if (type != "geometry_msgs/msg/PoseStamped") out.child = r.text();
  out.T = r.pose();
  return out;
}

}  // namespace prospect
