// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <algorithm>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adapters/robots/dds/dds_names.h"
#include "adapters/robots/dds/dds_node.h"

namespace prospect::test {

namespace fast = eprosima::fastdds;
namespace rtps = eprosima::fastrtps::rtps;

/// A node of Fast DDS, which most robots with ROS 2 speak, on this machine alone: its own
/// discovery, its own protocol. What DdsNode is with CycloneDDS, as far as the other side of a test
/// needs it: over the wire, as two vendors share no memory.
class FastNode {
 public:
  explicit FastNode(const DdsAddress& address) {
    fast::dds::DomainParticipantQos qos;
    qos.name(address.node.c_str());
    qos.transport().use_builtin_transports = false;
    const auto udp = std::make_shared<fast::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    udp->sendBufferSize = udp->receiveBufferSize = 4 << 20;
    qos.transport().user_transports.push_back(udp);
    for (int n = 0; n < 4; ++n) {  // where Cyclone's participants listen
      rtps::Locator_t peer;
      rtps::IPLocator::setIPv4(peer, 127, 0, 0, 1);
      peer.port = static_cast<std::uint32_t>(7400 + 250 * address.domain + 10 + 2 * n);
      qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    }
    participant_ = fast::dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(address.domain), qos);
    publisher_ = participant_->create_publisher(fast::dds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(fast::dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~FastNode() {
    participant_->delete_contained_entities();
    fast::dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  FastNode(const FastNode&) = delete;
  FastNode& operator=(const FastNode&) = delete;

  /// dds_name: in DDS; empty: dds_topic().
  template <ros::Message T>
  int advertise(const std::string& topic, const DdsQos& asked, const std::string& dds_name = "") {
    writers_.push_back(publisher_->create_datawriter(topic_of<T>(topic, dds_name),
                                                     made<fast::dds::DataWriterQos>(asked)));
    return static_cast<int>(writers_.size()) - 1;
  }
  /// bytes: CDR with its header of four bytes.
  void publish(int topic, std::string bytes) {
    writers_[static_cast<std::size_t>(topic)]->write(&bytes);
  }
  template <ros::Message T>
  void publish(int topic, const T& message) {
    publish(topic, ros::to_cdr(message));
  }
  /// `take` is called on a thread of Fast DDS, with CDR and its header.
  template <ros::Message T>
  void subscribe_bytes(const std::string& topic, const DdsQos& asked,
                       std::function<void(const std::string&)> take,
                       const std::string& dds_name = "") {
    listeners_.push_back(std::make_unique<Listener>(std::move(take)));
    readers_.push_back(subscriber_->create_datareader(topic_of<T>(topic, dds_name),
                                                      made<fast::dds::DataReaderQos>(asked),
                                                      listeners_.back().get()));
  }
  /// The same with the message.
  template <ros::Message T, typename Handle>
  void subscribe(const std::string& topic, const DdsQos& asked, Handle handle) {
    subscribe_bytes<T>(topic, asked, [handle = std::move(handle), topic](const std::string& cdr) {
      handle(ros::from_cdr<T>(cdr, topic));
    });
  }
  /// Whether each writer has a reader and each reader a writer, as this side knows it: what a
  /// client of ROS 2 waits for before it asks a service. A sample of a writer it does not know is
  /// lost.
  bool connected() const {
    const auto heard = [](fast::dds::DataWriter* writer) {
      fast::dds::PublicationMatchedStatus status;
      writer->get_publication_matched_status(status);
      return status.current_count > 0;
    };
    const auto hears = [](fast::dds::DataReader* reader) {
      fast::dds::SubscriptionMatchedStatus status;
      reader->get_subscription_matched_status(status);
      return status.current_count > 0;
    };
    return std::all_of(writers_.begin(), writers_.end(), heard) &&
           std::all_of(readers_.begin(), readers_.end(), hears);
  }

 private:
  /// A type whose samples are CDR that somebody else has written or reads, with its header.
  class Cdr final : public fast::dds::TopicDataType {
   public:
    explicit Cdr(const std::string& name) {
      setName(name.c_str());
      m_typeSize = 1 << 20;
      m_isGetKeyDefined = false;
      auto_fill_type_object(false);
      auto_fill_type_information(false);
    }
    bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
      const auto& bytes = *static_cast<const std::string*>(data);
      payload->encapsulation = CDR_LE;
      payload->length = static_cast<std::uint32_t>(bytes.size());
      std::copy(bytes.begin(), bytes.end(), payload->data);
      return true;
    }
    bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
      static_cast<std::string*>(data)->assign(payload->data, payload->data + payload->length);
      return true;
    }
    std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
      const auto size = static_cast<std::uint32_t>(static_cast<const std::string*>(data)->size());
      return [size] { return size; };
    }
    void* createData() override { return new std::string(); }
    void deleteData(void* data) override { delete static_cast<std::string*>(data); }
    bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
  };

  class Listener final : public fast::dds::DataReaderListener {
   public:
    explicit Listener(std::function<void(const std::string&)> take) : take_(std::move(take)) {}
    void on_data_available(fast::dds::DataReader* reader) override {
      std::string bytes;
      fast::dds::SampleInfo info;
      while (reader->take_next_sample(&bytes, &info) ==
             eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
        if (info.valid_data) take_(bytes);
      }
    }

   private:
    std::function<void(const std::string&)> take_;
  };

  /// Qos: of a writer or a reader.
  template <typename Qos>
  static Qos made(const DdsQos& asked) {
    Qos qos;
    qos.reliability().kind = asked.reliable ? fast::dds::RELIABLE_RELIABILITY_QOS
                                            : fast::dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.history().depth = asked.depth;
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    qos.data_sharing().off();
    return qos;
  }
  template <ros::Message T>
  fast::dds::Topic* topic_of(const std::string& name, const std::string& dds_name) {
    const std::string type = dds_type(ros::definition_of<T>().front().name);
    fast::dds::TypeSupport support(new Cdr(type));
    support.register_type(participant_);
    return participant_->create_topic(dds_name.empty() ? dds_topic(name) : dds_name, type,
                                      fast::dds::TOPIC_QOS_DEFAULT);
  }

  fast::dds::DomainParticipant* participant_ = nullptr;
  fast::dds::Publisher* publisher_ = nullptr;
  fast::dds::Subscriber* subscriber_ = nullptr;
  std::vector<fast::dds::DataWriter*> writers_;
  std::vector<fast::dds::DataReader*> readers_;
  std::vector<std::unique_ptr<Listener>> listeners_;
};

}  // namespace prospect::test
