#include "engine/behaviour/monitors/low_yield_monitor.h"

#include <algorithm>

#include "models/parameter_check.h"

namespace prospect {
LowYieldMonitor::LowYieldMonitor(const Options& options) : options_(options) {
  const auto require = [](const char* name, double value, double most, const char* expected) {
    check_parameter(value >= 0.0 && value <= most, "low yield", name, value, expected);
  };
  require("share", options.share, 1000.0, "0 to 1000");
  require("least", options.least, 1e6, "0 to 1e6 s");
  require("growth", options.growth, 1000.0, "0 to 1000");
}

bool LowYieldMonitor::update(double stamp, double explored) {
  if (!started_at_) started_at_ = stamp;
  const bool grown = until_ && explored >= (1.0 + options_.growth) * area_;
  if (grown) {
    until_ = std::max(*until_, stamp + options_.least);
    area_ = explored;
  }
  return grown;
}

void LowYieldMonitor::begin(double stamp, double explored) {
  if (until_) return;
  const double took = started_at_ ? stamp - *started_at_ : 0.0;
  until_ = stamp + std::max(options_.least, options_.share * took);
  area_ = explored;
}

}  // namespace prospect
