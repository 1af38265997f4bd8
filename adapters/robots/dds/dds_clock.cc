// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_clock.h"

#include <atomic>
#include <memory>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/rosgraph_msgs.h"

namespace prospect {
namespace {

DdsAddress clock_address(DdsAddress address) {
  address.node += "_clock";
  return address;
}

}  // namespace

DdsClock::DdsClock(const DdsAddress& address, const std::string& topic, double timeout)
    : clock_(machine_), node_(clock_address(address)) {
  const auto ticked = std::make_shared<std::atomic<bool>>(false);
  node_.subscribe<ros::Clock>(topic, DdsQos{false, false, 1}, [this, ticked](const ros::Clock& m) {
    clock_.tick(ros::seconds(m.clock));
    *ticked = true;
  });
  node_.start();
  const double end = machine_.now() + timeout;
  while (!*ticked && machine_.now() < end) machine_.wait_until(machine_.now() + 0.02, {});
  if (!*ticked) {
    const std::string fault = node_.fault(topic);
    throw InputError(!fault.empty() ? fault
                                    : topic + ": no message within " + number_text(timeout) +
                                          " s; expected the time of the simulation "
                                          "(rosgraph_msgs/msg/Clock), as use_sim_time says");
  }
}

}  // namespace prospect
