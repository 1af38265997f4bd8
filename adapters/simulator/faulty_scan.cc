#include "adapters/simulator/faulty_scan.h"

#include <algorithm>
#include <random>
#include <utility>

namespace prospect {

std::function<void(double, DepthScan&)> faulty_scans(const std::vector<InjectedFault>& faults,
                                                     double nearest, double farthest,
                                                     std::uint64_t seed) {
  const bool any = std::any_of(faults.begin(), faults.end(), [](const InjectedFault& fault) {
    return fault.source == FaultSource::kDepth &&
           (fault.verb == FaultVerb::kGarbage || fault.verb == FaultVerb::kWrong);
  });
  if (!any) return {};
  return [faults, nearest, farthest, draw = std::mt19937_64(seed)](double time,
                                                                   DepthScan& scan) mutable {
    if (fault_at(faults, FaultSource::kDepth, FaultVerb::kGarbage, time)) {
      std::vector<Eigen::Vector3d> rays = std::move(scan.hits);
      rays.insert(rays.end(), scan.misses.begin(), scan.misses.end());
      scan.misses.clear();
      for (Eigen::Vector3d& end : rays) {
        const double share = static_cast<double>(draw() >> 11) * 0x1p-53;  // [0, 1)
        const double distance = nearest + share * (farthest - nearest);
        end = scan.origin + distance * (end - scan.origin).normalized();
      }
      scan.hits = std::move(rays);
    } else if (fault_at(faults, FaultSource::kDepth, FaultVerb::kWrong, time)) {
      for (Eigen::Vector3d& hit : scan.hits) hit = scan.origin + kDepthScale * (hit - scan.origin);
    }
  };
}

}  // namespace prospect
