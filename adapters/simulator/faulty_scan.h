#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "adapters/simulator/injected_fault.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

/// What `depth:garbage` and `depth:wrong` make of a scan taken `time` [s] after the start, for
/// SimulatorOptions::distort_scan. Garbage: each ray ends at a random distance between `nearest`
/// and `farthest` [m]. Wrong: each hit is kDepthScale times as far. Empty if there is no such
/// fault.
std::function<void(double time, DepthScan& scan)> faulty_scans(
    const std::vector<InjectedFault>& faults, double nearest, double farthest, std::uint64_t seed);

}  // namespace prospect
