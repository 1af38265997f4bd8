// Fast DDS, which most robots with ROS 2 speak, as the other side: its own bytes (Fast CDR), its
// own discovery. Over the wire, as two vendors share no memory.
#include <gtest/gtest.h>

#ifdef PROSPECT_WITH_FASTDDS

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adapters/dds/dds_node.h"
#include "adapters/ros/geometry_msgs.h"
#include "adapters/ros/sensor_msgs.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_vendors_test {
namespace {

namespace fast = eprosima::fastdds;
namespace rtps = eprosima::fastrtps::rtps;
using test::kPatience;
using test::within;

/// A type of Fast DDS whose samples are bytes that Fast CDR has written or reads.
class Bytes final : public fast::dds::TopicDataType {
 public:
  explicit Bytes(const char* name) {
    setName(name);
    m_typeSize = 1 << 20;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const std::vector<char>*>(data);
    payload->encapsulation = CDR_LE;
    payload->length = static_cast<std::uint32_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), payload->data);
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<std::vector<char>*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size =
        static_cast<std::uint32_t>(static_cast<const std::vector<char>*>(data)->size());
    return [size] { return size; };
  }
  void* createData() override { return new std::vector<char>(); }
  void deleteData(void* data) override { delete static_cast<std::vector<char>*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// Of one topic of Fast DDS, on this machine alone.
class FastNode {
 public:
  FastNode(const char* topic, const char* type, bool writes) {
    fast::dds::DomainParticipantQos qos;
    qos.transport().use_builtin_transports = false;
    const auto udp = std::make_shared<fast::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    qos.transport().user_transports.push_back(udp);
    const int domain = test::dds_test_address().domain;
    for (int n = 0; n < 4; ++n) {  // where Cyclone's participants listen
      rtps::Locator_t peer;
      rtps::IPLocator::setIPv4(peer, 127, 0, 0, 1);
      peer.port = static_cast<std::uint32_t>(7400 + 250 * domain + 10 + 2 * n);
      qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    }
    participant_ = fast::dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(domain), qos);
    fast::dds::TypeSupport support(new Bytes(type));
    support.register_type(participant_);
    fast::dds::Topic* const made =
        participant_->create_topic(topic, type, fast::dds::TOPIC_QOS_DEFAULT);
    if (writes) {
      fast::dds::DataWriterQos writer_qos;
      writer_qos.reliability().kind = fast::dds::RELIABLE_RELIABILITY_QOS;
      writer_qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
      writer_qos.data_sharing().off();
      writer_ = participant_->create_publisher(fast::dds::PUBLISHER_QOS_DEFAULT)
                    ->create_datawriter(made, writer_qos);
    } else {
      fast::dds::DataReaderQos reader_qos;
      reader_qos.reliability().kind = fast::dds::RELIABLE_RELIABILITY_QOS;
      reader_qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
      reader_qos.data_sharing().off();
      reader_ = participant_->create_subscriber(fast::dds::SUBSCRIBER_QOS_DEFAULT)
                    ->create_datareader(made, reader_qos);
    }
  }
  ~FastNode() {
    participant_->delete_contained_entities();
    fast::dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  void write(std::vector<char>& bytes) { writer_->write(&bytes); }
  bool take(std::vector<char>& bytes) {
    fast::dds::SampleInfo info;
    return reader_->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK && info.valid_data;
  }

 private:
  using ReturnCode_t = eprosima::fastrtps::types::ReturnCode_t;
  fast::dds::DomainParticipant* participant_ = nullptr;
  fast::dds::DataWriter* writer_ = nullptr;
  fast::dds::DataReader* reader_ = nullptr;
};

TEST(DdsVendors, AnImageThatFastDdsWritesIsReadWhole) {
  DdsNode ours(test::dds_test_address());
  std::atomic<int> came = 0;
  std::vector<std::uint8_t> pixels(320 * 240 * 3);  // larger than a datagram
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(7 * i);
  ours.subscribe<ros::Image>("/left/image_raw", kSensorQos, [&](const ros::Image& m) {
    came += m.header.stamp.sec == 12 && m.header.stamp.nanosec == 34 &&
            m.header.frame_id == "left_optical" && m.width == 320 && m.height == 240 &&
            m.encoding == "rgb8" && m.step == 960 &&
            std::equal(m.data.begin(), m.data.end(), pixels.begin(), pixels.end());
  });
  ours.start();

  FastNode theirs("rt/left/image_raw", "sensor_msgs::msg::dds_::Image_", true);
  eprosima::fastcdr::FastBuffer buffer;
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  cdr << std::int32_t{12} << std::uint32_t{34} << std::string("left_optical") << std::uint32_t{240}
      << std::uint32_t{320} << std::string("rgb8") << std::uint8_t{0} << std::uint32_t{960}
      << pixels;
  std::vector<char> bytes(buffer.getBuffer(), buffer.getBuffer() + cdr.getSerializedDataLength());
  ASSERT_TRUE(within(kPatience, [&] { return ours.publishers("/left/image_raw") == 1; }));
  EXPECT_TRUE(within(
      kPatience, [&] { return came > 0; }, [&] { theirs.write(bytes); }));
  EXPECT_TRUE(ours.faults().empty());
}

TEST(DdsVendors, FastDdsReadsOurCommands) {
  DdsNode ours(test::dds_test_address());
  const int command = ours.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos);
  ours.start();
  FastNode theirs("rt/cmd_vel", "geometry_msgs::msg::dds_::TwistStamped_", false);
  ros::TwistStamped m;
  m.header = {{12, 34}, "base_link"};
  m.twist.linear.x = 0.25;
  m.twist.angular.z = -0.5;
  std::vector<char> bytes;
  ASSERT_TRUE(within(
      kPatience, [&] { return theirs.take(bytes); }, [&] { ours.publish(command, m); }));
  eprosima::fastcdr::FastBuffer buffer(bytes.data(), bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.read_encapsulation();
  std::int32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::string frame;
  double twist[6] = {};
  cdr >> seconds >> nanoseconds >> frame;
  for (double& value : twist) cdr >> value;
  EXPECT_EQ(seconds, 12);
  EXPECT_EQ(nanoseconds, 34u);
  EXPECT_EQ(frame, "base_link");
  EXPECT_EQ(twist[0], 0.25);
  EXPECT_EQ(twist[5], -0.5);
}

}  // namespace
}  // namespace prospect::dds_vendors_test

#else

TEST(DdsVendors, AnotherVendorIsUnderstood) {
  GTEST_SKIP() << "Fast DDS is not installed (libfastrtps-dev)";
}

#endif
