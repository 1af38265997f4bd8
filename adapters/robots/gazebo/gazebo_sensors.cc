// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_sensors.h"

#include <utility>

#include "adapters/robots/gazebo/gazebo_messages.h"
#include "adapters/robots/gazebo/gazebo_receiver.h"

namespace prospect {

struct GazeboSensors::Impl {
  Impl(const GazeboOptions& options, SimulationClock& clock, FrameSink& frames)
      : receiver(options) {
    const std::string prefix = options.model + "/" + options.link + "/";
    receiver.subscribe(
        prefix + options.stereo + "/images", "gazebo.msgs.ImagesStamped",
        [&frames, &clock,
         noise = GazeboImageNoise{options.image_noise, options.seed}](std::string_view message) {
          GazeboPair pair = read_gazebo_pair(message);
          noise.add(pair);
          clock.tick(pair.stamp);
          frames.observe(StereoFrame{pair.stamp, pair.stamp,
                                     std::make_shared<const Image>(std::move(pair.images.left)),
                                     std::make_shared<const Image>(std::move(pair.images.right))});
        });
    int number = 0;
    for (const std::string& name : gazebo_depth_names(options)) {
      receiver.subscribe(
          prefix + name + "/image", "gazebo.msgs.ImageStamped",
          [&frames, &clock, range = options.depth_range,
           sensor = number++](std::string_view message) {
            GazeboDepth image = read_gazebo_depth(message, range);
            clock.tick(image.stamp);
            frames.observe(DepthFrame{
                image.stamp, std::make_shared<const DepthImage>(std::move(image.image)), sensor});
          });
    }
    if (!options.imu.empty()) {
      receiver.subscribe(prefix + options.imu + "/imu", "gazebo.msgs.IMU",
                         [&frames, &clock](std::string_view message) {
                           const ImuSample sample = read_gazebo_imu(message);
                           clock.tick(sample.stamp);
                           frames.observe(sample);
                         });
    }
    receiver.start();
  }

  GazeboReceiver receiver;  // its thread ends first
};

GazeboSensors::GazeboSensors(const GazeboOptions& options, SimulationClock& clock,
                             FrameSink& frames)
    : impl_(std::make_unique<Impl>(options, clock, frames)) {}
GazeboSensors::~GazeboSensors() = default;

bool GazeboSensors::connected() const { return impl_->receiver.connected(); }

std::vector<std::string> GazeboSensors::faults() const { return impl_->receiver.faults(); }

}  // namespace prospect
