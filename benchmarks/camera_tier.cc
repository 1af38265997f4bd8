// SPDX-License-Identifier: Apache-2.0
// What the simulated cameras see and what that costs: pictures of each sensor, and times of a
// stereo pair and a depth image along a turn in place, on one and two threads.
//
//   camera_tier WORLD [--start X Y YAW] [--quality Q] [--frames N] [--realism X] [--out DIR]
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/robots/simulator/camera_effects.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/exposure_control.h"
#include "adapters/robots/simulator/feature_field.h"
#include "adapters/robots/simulator/people.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "adapters/robots/simulator/world_mesh.h"
#include "benchmarks/program_options.h"

namespace {

using namespace prospect;

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_time() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Times of what has been since the last call, of the clock and of the processor.
class Stopwatch {
 public:
  struct Lap {
    double wall, processor;  // [ms]
  };
  Lap lap() {
    const double wall = wall_time(), processor = processor_time();
    const Lap lap{1e3 * (wall - wall_), 1e3 * (processor - processor_)};
    wall_ = wall_time();
    processor_ = processor_time();
    return lap;
  }

 private:
  double wall_ = wall_time(), processor_ = processor_time();
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void write(const std::filesystem::path& path, int width, int height, const std::uint8_t* pixels) {
  const cv::Mat image(height, width, CV_8UC1, const_cast<std::uint8_t*>(pixels));
  cv::imwrite(path.string(), image, {cv::IMWRITE_JPEG_QUALITY, 88});
}

void write(const std::filesystem::path& path, const Image& image) {
  write(path, image.width, image.height, image.pixels.data());
}

/// Near is bright; no measurement is black.
void write(const std::filesystem::path& path, const DepthImage& depth, double farthest) {
  Image image(depth.width, depth.height);
  for (std::size_t n = 0; n < depth.depth.size(); ++n) {
    const double z = depth.depth[n];
    if (!std::isfinite(z)) continue;
    image.pixels[n] = static_cast<std::uint8_t>(
        std::lround(std::clamp(255.0 - 215.0 * z / farthest, 40.0, 255.0)));
  }
  write(path, image);
}

int run(int argc, char** argv) {
  ProgramOptions options("Pictures and times of the simulated cameras");
  std::string name = "office";
  std::string out;
  std::vector<double> start;
  WorldMeshOptions mesh_options;
  int frames = 40;
  double realism = CameraSensorsOptions{}.realism;
  options.add("world", name, "as for `prospect explore`");
  options.add("--start", start, "X Y YAW [m, rad]", {.count = 3});
  options.add("--quality", mesh_options.texture_quality, "contrast of the texture, 0..1");
  options.add("--frames", frames, "timed views", {.least = 1, .most = 10000});
  options.add("--realism", realism, "as simulator.camera.realism", {.least = 0.0, .most = 3.0});
  options.add("--out", out, "writes left.jpg, right.jpg and depth.jpg there");
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;

  Stopwatch watch;
  WorldOptions world_options;
  if (!start.empty()) {
    Pose pose;
    pose.position = {start[0], start[1], 0.0};
    pose.yaw = start[2];
    world_options.start = pose;
  }
  const World world = load_world(name, world_options);
  const auto loading = watch.lap();
  constexpr std::uint64_t kSeed = 1;
  constexpr double kTurning = 0.8;  // [rad/s], for motion blur with realism
  const FeatureField field(
      world, [&](int i, int j, int k) { return texture_density(world, i, j, k, kSeed); }, kSeed);
  const TexturedMesh mesh =
      world.mesh != nullptr ? *world.mesh : world_mesh(world, field, mesh_options);
  const auto meshing = watch.lap();
  std::size_t texels = 0;
  for (const Image& texture : mesh.textures) texels += texture.pixels.size();
  SceneRendererOptions scene_options;
  const CameraEffects effects = scaled({}, realism);
  scene_options.floor_shine = effects.floor_shine;
  if (world.mesh != nullptr) scene_options.texture_contrast = mesh_options.texture_quality;
  const auto scene = std::make_shared<const SceneRenderer>(mesh, scene_options);
  const auto building = watch.lap();
  std::printf(
      "%s: %zu triangles, %zu textures of %.1f Mpx; loaded in %.0f ms, meshed in %.0f ms, "
      "scene built in %.0f ms\n",
      world.name.c_str(), mesh.triangles.size(), mesh.textures.size(),
      1e-6 * static_cast<double>(texels), loading.wall, meshing.wall, building.wall);

  for (const int threads : {1, 2}) {
    CameraRigOptions options;
    options.threads = threads;
    options.effects = effects;
    const CameraRig rig(scene, options);
    Walkers walkers(world, {}, effects.people, world.start, kSeed);
    People people(kSeed);
    ExposureControl control(effects.exposure_lag);
    std::vector<double> stereo_wall, stereo_processor, depth_wall, depth_processor;
    for (int n = 0; n < frames; ++n) {
      Pose pose = world.start;
      pose.yaw += 2.0 * std::numbers::pi * n / frames;
      const auto frame = static_cast<std::uint64_t>(n);
      const double stamp = 0.1 * n;
      walkers.advance(stamp, pose);
      watch.lap();
      const ImagePair pair = rig.stereo(pose, {frame, stamp, control.exposure(), kTurning},
                                        people.of(walkers.walkers()));
      const auto stereo = watch.lap();
      const DepthImage depth = rig.depth(pose, frame, people.of(walkers.walkers()));
      const auto ranging = watch.lap();
      control.measured(stamp, pair.left);
      stereo_wall.push_back(stereo.wall);
      stereo_processor.push_back(stereo.processor);
      depth_wall.push_back(ranging.wall);
      depth_processor.push_back(ranging.processor);
      if (n == 0 && threads == 1 && !out.empty()) {
        std::filesystem::create_directories(out);
        write(std::filesystem::path(out) / "left.jpg", pair.left);
        write(std::filesystem::path(out) / "right.jpg", pair.right);
        write(std::filesystem::path(out) / "depth.jpg", depth, options.footprint.max_range);
      }
    }
    std::printf(
        "%d thread%s: stereo pair %.1f ms (processor %.1f ms), depth %.1f ms (processor "
        "%.1f ms); medians of %d views of 640 x 480\n",
        threads, threads == 1 ? "" : "s", median(stereo_wall), median(stereo_processor),
        median(depth_wall), median(depth_processor), frames);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "camera_tier: %s\n", error.what());
    return 2;
  }
}
