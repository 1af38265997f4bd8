// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/discovered_endpoints.h"

#include <cstdio>
#include <utility>

namespace prospect {
namespace {

constexpr std::size_t kMost = 1000;

template <typename Value>
void put(std::map<std::string, Value>& into, const std::string& key, Value value) {
  if (into.size() < kMost || into.contains(key)) into[key] = std::move(value);
}

}  // namespace

void DiscoveredEndpoints::add(const std::string& key, DiscoveredEndpoint endpoint) {
  put(endpoints_, key, std::move(endpoint));
}

void DiscoveredEndpoints::set_participant(const std::string& key, const std::string& name) {
  if (!name.empty()) put(participants_, key, name);
}

void DiscoveredEndpoints::remove_participant(const std::string& key) {
  participants_.erase(key);
  nodes_.erase(key);
}

void DiscoveredEndpoints::set_nodes(const std::string& participant,
                                    std::map<std::string, std::string> node_of_endpoint) {
  if (node_of_endpoint.size() <= kMost) put(nodes_, participant, std::move(node_of_endpoint));
}

std::string DiscoveredEndpoints::name_of(const std::string& key,
                                         const std::string& participant) const {
  if (const auto its = nodes_.find(participant); its != nodes_.end()) {
    if (const auto node = its->second.find(key); node != its->second.end()) return node->second;
  }
  if (const auto its = participants_.find(participant); its != participants_.end()) {
    return its->second;
  }
  std::string hex;
  for (const char byte : key) {
    char text[3];
    std::snprintf(text, sizeof text, "%02x", static_cast<unsigned char>(byte));
    hex += text;
  }
  return hex;
}

std::vector<std::string> DiscoveredEndpoints::writers(std::string_view topic,
                                                      std::string_view type) const {
  std::vector<std::string> names;
  for (const auto& [key, one] : endpoints_) {
    if (!one.writes || one.topic != topic || (!type.empty() && one.type != type)) continue;
    names.push_back(name_of(key, one.participant));
  }
  return names;
}

std::string DiscoveredEndpoints::other_type(std::string_view topic, std::string_view type,
                                            bool writes) const {
  for (const auto& [key, one] : endpoints_) {
    if (one.writes == writes && one.topic == topic && one.type != type) return one.type;
  }
  return "";
}

}  // namespace prospect
