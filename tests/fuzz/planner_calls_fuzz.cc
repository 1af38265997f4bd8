// SPDX-License-Identifier: Apache-2.0
// Calls of a planner, one after another, each with its length in two bytes before it, as a log
// keeps them. The beliefs that are read are written and read again: the same.
#include <cstring>

#include "adapters/formats/ros/cdr.h"
#include "adapters/missions/log/planner_calls.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

namespace {

bool same_maps(const Belief& a, const Belief& b) {
  const auto both = [](const auto& x, const auto& y, const auto& same) {
    return (x == nullptr) == (y == nullptr) && (!x || same(*x, *y));
  };
  return both(a.voxels, b.voxels,
              [](const VoxelGrid& x, const VoxelGrid& y) {
                return x.frame() == y.frame() && x.k0() == y.k0() && x.depth() == y.depth() &&
                       x.data() == y.data();
              }) &&
         both(a.ground, b.ground,
              [](const GroundMap& x, const GroundMap& y) {
                return x.frame() == y.frame() && x.cells().data == y.cells().data &&
                       x.sights().data == y.sights().data;
              }) &&
         both(a.landmarks, b.landmarks, [](const LandmarkMap& x, const LandmarkMap& y) {
           // Numbers may be no numbers, which equal nothing.
           const auto same = [](const Landmark& l, const Landmark& m) {
             return l.id == m.id && std::memcmp(&l.position, &m.position, sizeof l.position) == 0;
           };
           return std::equal(x.landmarks.begin(), x.landmarks.end(), y.landmarks.begin(),
                             y.landmarks.end(), same);
         });
}

/// A log's calls, and the same once more.
struct Readers {
  PlannerCallReader first, again;
  PlannerCallWriter writer;

  void read(std::string_view bytes) {
    const PlannerCall call = ros::from_cdr<PlannerCall>(bytes, "call");
    if (call.kind == PlannerCall::kTask) {
      task_of(call, "call");
      return;
    }
    if (call.kind == PlannerCall::kPlanned) return;
    const Belief belief = first.belief(call, "call");
    const std::string written = ros::to_cdr(writer.plan(belief));
    if (same_maps(belief, again.belief(ros::from_cdr<PlannerCall>(written, "written"), "written")))
      return;
    std::fputs("written and read again it is another belief\n", stderr);
    std::abort();
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view bytes = fuzz::text_of(data, size);
  fuzz::read_or_refuse([&] {
    Readers readers;
    while (bytes.size() >= 2) {
      const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); };
      const std::size_t length = std::min<std::size_t>(byte(0) | byte(1) << 8, bytes.size() - 2);
      readers.read(bytes.substr(2, length));
      bytes.remove_prefix(2 + length);
    }
  });
  return 0;
}
