// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "adapters/formats/ros/cdr.h"
#include "adapters/robots/dds/dds_node.h"

namespace prospect {

/// A request or a response as rmw_cyclonedds sends it: who asked, and which of his questions it is,
/// then the body. Other middlewares of ROS 2 send these otherwise, so that their clients do not
/// reach a service here.
template <ros::Message T>
struct ServiceCall {
  static constexpr const char* kType = T::kType;
  std::uint64_t client = 0;
  std::int64_t number = 0;
  T body;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("client", m.client);
    visit("number", m.number);
    T::fields(m.body, visit);
  }
};

/// Answers a request, once, from any thread while the node is there.
template <ros::Message Response>
using ServiceReply = std::function<void(const Response&)>;

/// Offers a service of ROS 2. handle(request, reply) is called by the node's thread; it may keep
/// the reply for later. Call it before DdsNode::start().
template <ros::Message Request, ros::Message Response, typename Handle>
void serve(DdsNode& node, const std::string& service, Handle handle) {
  const int replies = node.advertise(service, ros::definition_of<Response>(), kReliableQos,
                                     DdsNode::Role::kReplies);
  node.subscribe(service, ros::definition_of<Request>(), kReliableQos,
                 DdsNode::PublisherHandler([&node, replies, handle = std::move(handle)](
                                               std::string_view cdr, const std::string& name,
                                               std::uint64_t publisher) {
                   const auto request = ros::from_cdr<ServiceCall<Request>>(cdr, name);
                   const std::uint64_t client = request.client;
                   const std::int64_t number = request.number;
                   handle(request.body, ServiceReply<Response>([&node, replies, publisher, client,
                                                                number](const Response& body) {
                            node.answer(replies, publisher,
                                        ros::to_cdr(ServiceCall<Response>{client, number, body}));
                          }));
                 }),
                 DdsNode::Role::kRequests);
}

}  // namespace prospect
