#include "adapters/gazebo/gazebo_sensors.h"

#include <utility>

#include "adapters/gazebo/gazebo_messages.h"
#include "adapters/gazebo/gazebo_receiver.h"

namespace prospect {

struct GazeboSensors::Impl {
  Impl(const GazeboOptions& options, SimulationClock& clock, SensorInbox& inbox)
      : receiver(options) {
    const std::string prefix = options.model + "/" + options.link + "/";
    receiver.subscribe(prefix + options.stereo + "/images", "gazebo.msgs.ImagesStamped",
                       [&clock, &inbox](std::string_view message) {
                         GazeboPair pair = read_gazebo_pair(message);
                         clock.tick(pair.stamp);
                         inbox.pair(pair.stamp, pair.stamp, std::move(pair.images));
                       });
    if (!options.depth.empty()) {
      receiver.subscribe(prefix + options.depth + "/image", "gazebo.msgs.ImageStamped",
                         [&clock, &inbox, range = options.depth_range](std::string_view message) {
                           GazeboDepth image = read_gazebo_depth(message, range);
                           clock.tick(image.stamp);
                           inbox.depth(image.stamp, std::move(image.image));
                         });
    }
    receiver.start();
  }

  GazeboReceiver receiver;
};

GazeboSensors::GazeboSensors(const GazeboOptions& options, SimulationClock& clock,
                             SensorInbox& inbox)
    : impl_(std::make_unique<Impl>(options, clock, inbox)) {}
GazeboSensors::~GazeboSensors() = default;

bool GazeboSensors::connected() const { return impl_->receiver.connected(); }

std::vector<std::string> GazeboSensors::faults() const { return impl_->receiver.faults(); }

}  // namespace prospect
