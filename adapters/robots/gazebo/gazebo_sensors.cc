#include "adapters/robots/gazebo/gazebo_sensors.h"

#include <utility>

#include "adapters/robots/gazebo/gazebo_messages.h"
#include "adapters/robots/gazebo/gazebo_receiver.h"

namespace prospect {

struct GazeboSensors::Impl {
  Impl(const GazeboOptions& options, SimulationClock& clock, GazeboFrames its_frames)
      : frames(std::move(its_frames)), receiver(options) {
    const std::string prefix = options.model + "/" + options.link + "/";
    receiver.subscribe(prefix + options.stereo + "/images", "gazebo.msgs.ImagesStamped",
                       [this, &clock](std::string_view message) {
                         GazeboPair pair = read_gazebo_pair(message);
                         clock.tick(pair.stamp);
                         frames.pair(pair.stamp, std::move(pair.images));
                       });
    if (!options.depth.empty()) {
      receiver.subscribe(prefix + options.depth + "/image", "gazebo.msgs.ImageStamped",
                         [this, &clock, range = options.depth_range](std::string_view message) {
                           GazeboDepth image = read_gazebo_depth(message, range);
                           clock.tick(image.stamp);
                           frames.depth(image.stamp, std::move(image.image));
                         });
    }
    receiver.start();
  }

  const GazeboFrames frames;
  GazeboReceiver receiver;  // its thread ends first
};

GazeboFrames frames_into(SensorInbox& inbox) {
  return {[&inbox](double stamp, ImagePair images) { inbox.pair(stamp, stamp, std::move(images)); },
          [&inbox](double stamp, DepthImage image) { inbox.depth(stamp, std::move(image)); }};
}

GazeboSensors::GazeboSensors(const GazeboOptions& options, SimulationClock& clock,
                             GazeboFrames frames)
    : impl_(std::make_unique<Impl>(options, clock, std::move(frames))) {}
GazeboSensors::~GazeboSensors() = default;

bool GazeboSensors::connected() const { return impl_->receiver.connected(); }

std::vector<std::string> GazeboSensors::faults() const { return impl_->receiver.faults(); }

}  // namespace prospect
