// SPDX-License-Identifier: Apache-2.0
// What becomes of a robot's stereo images on their way over DDS: one process publishes them, as a
// camera driver does, another one reads them into a sensor inbox, as `prospect drive` does. Prints
// how many came, and how long each took from its stamp until it was grey and in the inbox.
//
//   dds_images [--frames N] [--rate HZ] [--width PX] [--height PX] [--configuration FILE.xml]
//
// Over loopback; with --configuration over whatever the file says, by both sides.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_sensors.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "runtime/clock.h"
#include "runtime/latency_histogram.h"
#include "runtime/sensor_inbox.h"

namespace prospect {
namespace {

struct Setting {
  int frames = 150, width = 640, height = 480;
  double rate = 15.0;
  DdsOptions dds;
};

double processor_time() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

ros::CameraInfo camera_info(const Setting& s, double baseline) {
  ros::CameraInfo m;
  m.width = static_cast<std::uint32_t>(s.width);
  m.height = static_cast<std::uint32_t>(s.height);
  const double f = 0.7 * s.width, cx = 0.5 * s.width, cy = 0.5 * s.height;
  m.k = {f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0};
  m.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  m.p = {f, 0.0, cx, -f * baseline, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return m;
}

/// The camera driver: publishes until all frames are out.
void publish(const Setting& s) {
  DdsNode node(s.dds.address);
  const DdsOptions::Stereo& o = s.dds.stereo;
  const std::array<int, 2> infos = {node.advertise<ros::CameraInfo>(o.left_info, kSensorQos),
                                    node.advertise<ros::CameraInfo>(o.right_info, kSensorQos)};
  const std::array<int, 2> images = {node.advertise<ros::Image>(o.left, kSensorQos),
                                     node.advertise<ros::Image>(o.right, kSensorQos)};
  node.start();
  const SteadyClock clock;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(s.width * s.height * 3));
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(7 * i);
  ros::Image m;
  m.width = static_cast<std::uint32_t>(s.width);
  m.height = static_cast<std::uint32_t>(s.height);
  m.encoding = "rgb8";
  m.step = m.width * 3;
  m.data = pixels;
  const double give_up = clock.now() + s.dds.timeout;
  while (node.subscribers(o.left) == 0 || node.subscribers(o.right) == 0) {
    if (clock.now() > give_up) return;
    clock.wait_until(clock.now() + 0.02, {});
  }
  // Calibrations first, for a second.
  for (int n = 0; n < 20; ++n) {
    node.publish(infos[0], camera_info(s, 0.0));
    node.publish(infos[1], camera_info(s, 0.12));
    clock.wait_until(clock.now() + 0.05, {});
  }
  double next = clock.now();
  for (int n = 0; n < s.frames; ++n) {
    m.header.stamp = ros::time_of(clock.now());
    for (const int topic : images) node.publish(topic, m, pixels.size());
    next += 1.0 / s.rate;
    clock.wait_until(next, {});
  }
  std::printf("  publisher     %.2f s of processor time\n", processor_time());
  std::fflush(stdout);
  clock.wait_until(clock.now() + 0.5, {});
}

/// What came, and how long each pair took.
void receive(const Setting& s) {
  const SteadyClock clock;
  SensorInboxOptions options;
  options.cameras_in_runtime_clock = true;
  options.capacity = 64;
  SensorInbox inbox(clock, options);
  DdsNode node(s.dds.address);
  DdsTransforms transforms(node, s.dds.tf, s.dds.tf_static);
  const DdsSensors sensors(s.dds, node, transforms, inbox);
  node.start();
  sensors.wait();
  LatencyHistogram pairs;
  const double end = clock.now() + s.frames / s.rate + 3.0;
  while (clock.now() < end && pairs.count() < static_cast<std::uint64_t>(s.frames)) {
    if (!inbox.wait(0.2, {})) continue;
    while (const std::optional<SensorFrame> frame = inbox.take()) {
      pairs.add(clock.now() - stamp_of(*frame));
    }
  }
  for (const SensorStream stream : {SensorStream::kLeft, SensorStream::kRight}) {
    std::printf("  %-13s %llu of %d images\n", std::string(to_string(stream)).c_str(),
                static_cast<unsigned long long>(inbox.count(stream).received), s.frames);
  }
  std::printf("  pairs         %s\n", pairs.to_text().c_str());
  std::printf("  subscriber    %.2f s of processor time\n", processor_time());
  for (const std::string& fault : node.faults()) std::printf("  fault: %s\n", fault.c_str());
}

int run(int argc, char** argv) {
  Setting s;
  ProgramOptions program("Stereo images over DDS: losses and latencies");
  program.add("--frames", s.frames, "Pairs to publish", {.least = 1, .most = 1e6});
  program.add("--rate", s.rate, "Pairs a second [Hz]", {.least = 0.1, .most = 1000.0});
  program.add("--width", s.width, "Of an image [px]", {.least = 16, .most = 8192});
  program.add("--height", s.height, "Of an image [px]", {.least = 16, .most = 8192});
  program.add("--configuration", s.dds.address.configuration, "File of CycloneDDS's XML");
  if (const std::optional<int> code = program.parse(argc, argv)) return *code;
  s.dds.address.domain = 91;
  s.dds.address.loopback = true;
  s.dds.timeout = 20.0;
  s.dds.depth.image.clear();
  s.dds.depth.info.clear();
  std::printf("%d pairs of %d x %d rgb8 at %g Hz\n", s.frames, s.width, s.height, s.rate);
  std::fflush(stdout);
  const pid_t child = ::fork();  // before there are threads
  if (child == 0) {
    publish(s);
    return 0;
  }
  receive(s);
  ::waitpid(child, nullptr, 0);
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("dds_images", prospect::run, argc, argv);
}
