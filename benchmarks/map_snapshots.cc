// SPDX-License-Identifier: Apache-2.0
// What snapshots of a map cost, by how many of them are held: processor time and bytes allocated a
// scan, along a corridor of 40 m at 0.05 m.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <limits>
#include <new>
#include <utility>
#include <vector>

#include "engine/support/stopwatch.h"
#include "perception/mapping/occupancy_mapper.h"

namespace {
std::size_t allocated = 0;  // bytes
}

void* operator new(std::size_t size) {
  allocated += size;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace prospect {
namespace {

/// 4800 rays of a robot that turns while it drives along x.
DepthScan corridor_scan(int k) {
  const double low[3] = {-1e3, -3.0, 0.0}, high[3] = {1e3, 3.0, 2.4};
  DepthScan scan;
  scan.origin = {0.1 * k, 0.0, 0.5};
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 80; ++column) {
      const double a = 0.1 * k + 1.2 * (column / 80.0 - 0.5), e = 0.9 * (0.5 - row / 60.0);
      const Eigen::Vector3d d(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e));
      double range = std::numeric_limits<double>::infinity();
      for (int i = 0; i < 3; ++i) {
        if (d[i] != 0.0) {
          range = std::min(range, ((d[i] > 0.0 ? high : low)[i] - scan.origin[i]) / d[i]);
        }
      }
      (range < 4.0 ? scan.hits : scan.misses).push_back(scan.origin + std::min(range, 8.0) * d);
    }
  }
  return scan;
}

void measure(std::size_t held) {
  constexpr int kScans = 400, kMeasured = 100;  // the last ones
  OccupancyMapperOptions options;
  options.resolution = 0.05;
  OccupancyMapper mapper(options);
  std::deque<BeliefMaps> snapshots;
  std::vector<double> insert, snapshot;  // [ms]
  std::size_t insert_bytes = 0, snapshot_bytes = 0;
  for (int k = 0; k < kScans; ++k) {
    const DepthScan scan = corridor_scan(k);
    const std::size_t before = allocated;
    ProcessorStopwatch watch;
    mapper.insert(scan);
    const double inserted = watch.lap();
    const std::size_t between = allocated;
    BeliefMaps maps = mapper.snapshot();
    const double taken = watch.lap();
    if (k >= kScans - kMeasured) {
      insert.push_back(inserted);
      snapshot.push_back(taken);
      insert_bytes += between - before;
      snapshot_bytes += allocated - between;
    }
    snapshots.push_back(std::move(maps));
    while (snapshots.size() > held) snapshots.pop_front();
  }
  std::sort(insert.begin(), insert.end());
  std::sort(snapshot.begin(), snapshot.end());
  std::printf("%4zu %10.2f %10zu %10.2f %10zu\n", held, insert[kMeasured / 2],
              insert_bytes / kMeasured / 1024, snapshot[kMeasured / 2],
              snapshot_bytes / kMeasured / 1024);
}

}  // namespace
}  // namespace prospect

int main() {
  std::printf("%4s %10s %10s %10s %10s\n", "held", "insert ms", "kB", "snapshot", "kB");
  for (const std::size_t held : {0, 1, 2, 3}) prospect::measure(held);
}
