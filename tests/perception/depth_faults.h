// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "perception/mapping/depth_mapper.h"

namespace prospect::test {

/// What reaches the mapper as one frame.
struct DepthFrame {
  double stamp = 0.0;
  DepthImage image;
  Eigen::Isometry3d T_WC = Eigen::Isometry3d::Identity();
};

/// A fault of camera, driver or localization, injected into a few frames of a sequence.
struct DepthFault {
  std::string name;
  Mapping state;       ///< that each faulty frame must have, or a worse one
  std::string reason;  ///< that it must give
  /// The frame as it arrives, from the true one and the one before the fault; null: never arrives.
  std::function<void(DepthFrame& frame, const DepthFrame& before)> apply;
  bool of_moving = false;  ///< only of a camera that has moved since the frame before the fault
};

inline constexpr int kFaultFrames = 4;

inline std::vector<DepthFault> depth_faults() {
  using F = DepthFrame&;
  using B = const DepthFrame&;
  const float inf = std::numeric_limits<float>::infinity();
  const auto fill = [](float z) {
    return [z](F f, B) { std::fill(f.image.depth.begin(), f.image.depth.end(), z); };
  };
  const auto in_half = [](bool left) {
    return [left](F f, B) {
      for (int v = 0; v < f.image.height; ++v) {
        for (int u = 0; u < f.image.width; ++u) {
          if ((2 * u < f.image.width) == left) f.image.at(u, v) = 0.0F;
        }
      }
    };
  };
  return {
      {"blank: 0", Mapping::kRejected, "no depth", fill(0.0F)},
      {"blank: NaN", Mapping::kRejected, "no depth", fill(DepthImage::kInvalid)},
      {"blank: 65535 mm", Mapping::kRejected, "no depth", fill(65.535F)},
      {"infinite", Mapping::kRejected, "no depth", fill(inf)},
      {"negative", Mapping::kRejected, "no depth", fill(-1.0F)},
      {"1 m everywhere", Mapping::kRejected, "everywhere the same", fill(1.0F)},
      {"frozen", Mapping::kRejected, "frozen", [](F f, B before) { f.image = before.image; }, true},
      {"left half black", Mapping::kDegraded, "left half", in_half(true)},
      {"right half black", Mapping::kDegraded, "right half", in_half(false)},
      {"nine tenths NaN", Mapping::kDegraded, "little depth",
       [](F f, B) {
         std::mt19937 generator(1);
         for (float& z : f.image.depth) {
           if (generator() % 10 != 0) z = DepthImage::kInvalid;
         }
       }},
      {"noise", Mapping::kRejected, "noise",
       [](F f, B) {
         std::mt19937 generator(static_cast<std::uint32_t>(1e3 * f.stamp));
         for (float& z : f.image.depth) z = 0.5F + 1e-3F * static_cast<float>(generator() % 4000);
       }},
      {"2.5 times too far", Mapping::kRejected, "below the floor",
       [](F f, B) {
         for (float& z : f.image.depth) z *= 2.5F;
       }},
      {"half the size", Mapping::kRejected, "wrong size",
       [](F f, B) { f.image = DepthImage(f.image.width / 2, f.image.height / 2, 1.0F); }},
      {"no image", Mapping::kRejected, "wrong size", [](F f, B) { f.image = DepthImage(); }},
      {"time NaN", Mapping::kRejected, "not a number",
       [](F f, B) { f.stamp = std::numeric_limits<double>::quiet_NaN(); }},
      {"time goes back", Mapping::kRejected, "not increase", [](F f, B) { f.stamp -= 100.0; }},
      {"pose NaN", Mapping::kRejected, "no rotation",
       [](F f, B) { f.T_WC.translation().x() = std::numeric_limits<double>::quiet_NaN(); }},
      {"pose no rotation", Mapping::kRejected, "no rotation",
       [](F f, B) { f.T_WC.linear() *= 1.1; }},
      {"pose jumps by 3 m", Mapping::kRejected, "jumps",
       [](F f, B) { f.T_WC.translation().y() += 3.0; }},
      {"frames dropped", Mapping::kDegraded, "missing", nullptr},
  };
}

/// Runs a sequence with the fault in frames [first, first + kFaultFrames): each faulty frame has
/// the state and the reason (of dropped ones the next tells), a rejected one leaves the map as it
/// was, and the first frame after the fault is as it would have been without. Prints a row of a
/// table.
inline void expect_fault_noticed(const DepthFault& fault, DepthMapper& mapper, int frames,
                                 int first, const std::function<DepthFrame(int)>& read,
                                 const std::function<Mapping(int)>& without) {
  SCOPED_TRACE(fault.name);
  const int after = first + kFaultFrames;
  DepthFrame before;
  std::string reason;
  Mapping worst = Mapping::kOk;
  for (int k = 0; k < frames; ++k) {
    DepthFrame frame = read(k);
    const bool faulty = k >= first && k < after;
    if (faulty && !fault.apply) continue;
    if (k == first - 1) before = frame;
    if (faulty) fault.apply(frame, before);
    const std::uint64_t revision = mapper.map().ground()->revision();
    const std::uint64_t surface = mapper.map().surface_voxels();
    MappedFrame out;
    ASSERT_NO_THROW(out = mapper.process(frame.stamp, frame.image, frame.T_WC));
    ASSERT_TRUE(out.T_WC.matrix().allFinite());
    if (out.state == Mapping::kRejected) {
      EXPECT_EQ(mapper.map().ground()->revision(), revision);
      EXPECT_EQ(mapper.map().surface_voxels(), surface);
    }
    // An image that comes again is a fault once the camera is elsewhere (repeated_content.h).
    const Eigen::Isometry3d moved = before.T_WC.inverse() * frame.T_WC;
    const bool stands = faulty && fault.of_moving && moved.translation().norm() < 0.021 &&
                        Eigen::AngleAxisd(moved.linear()).angle() < 0.021;
    if (stands) continue;
    if (faulty || (!fault.apply && k == after)) {
      EXPECT_GE(out.state, fault.state) << k << " " << out.reason;
      if (k == first || !fault.apply) {  // later the image may be frozen as well
        EXPECT_NE(out.reason.find(fault.reason), std::string::npos) << k << " " << out.reason;
      }
      worst = std::max(worst, out.state);
      if (reason.empty()) reason = out.reason;
    } else if (k >= after) {
      // A frame without a sound time is as one that never arrived.
      const bool missed = k == after && out.reason.find("missing") != std::string::npos;
      EXPECT_EQ(out.state, missed ? Mapping::kDegraded : without(k)) << k << " " << out.reason;
    }
  }
  std::printf("%-20s %-9s %s\n", fault.name.c_str(), std::string(to_string(worst)).c_str(),
              reason.c_str());
}

}  // namespace prospect::test
