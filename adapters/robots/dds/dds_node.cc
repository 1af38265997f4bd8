// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_node.h"

#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"
#include "adapters/robots/dds/dds_names.h"
#include "adapters/robots/dds/discovered_endpoints.h"
#include "adapters/robots/dds/raw_type.h"
#include "adapters/robots/dds/type_hash.h"
#include "models/formatted.h"
#include "runtime/sample_judge.h"

#ifdef PROSPECT_WITH_CYCLONEDDS
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <stop_token>
#include <thread>
#endif

namespace prospect {

std::string dds_configuration(bool loopback) {
  // Fragments as large as UDP takes: with the library's 1300 bytes half of the images of a pair are
  // lost (docs/reference/dds.md).
  std::string text =
      "<CycloneDDS><Domain><General>"
      "<MaxMessageSize>65500B</MaxMessageSize><FragmentSize>60000B</FragmentSize>";
  if (loopback) {
    text +=
        "<Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/></Interfaces>"
        "<AllowMulticast>false</AllowMulticast>";
  }
  // A process that was killed counts as a publisher for so long; the library's is 10 s.
  text += "</General><Discovery><LeaseDuration>2s</LeaseDuration>";
  if (loopback) {
    text +=
        "<ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>20</MaxAutoParticipantIndex>"
        "<Peers><Peer address=\"127.0.0.1\"/></Peers>";
  }
  return text +
         "</Discovery><Internal><SocketReceiveBufferSize "
         "max=\"4MB\"/></Internal></Domain></CycloneDDS>";
}

#ifdef PROSPECT_WITH_CYCLONEDDS

namespace {

/// What ROS 2's middleware tells of a node and its topics (rmw_dds_common), since Iron.
struct Gid {
  static constexpr const char* kType = "rmw_dds_common/msg/Gid";
  std::array<std::uint8_t, 16> data{};

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("data", m.data);
  }
};
struct NodeEntitiesInfo {
  static constexpr const char* kType = "rmw_dds_common/msg/NodeEntitiesInfo";
  std::string node_namespace, node_name;
  std::vector<Gid> reader_gid_seq, writer_gid_seq;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("node_namespace", m.node_namespace);
    visit("node_name", m.node_name);
    visit("reader_gid_seq", m.reader_gid_seq);
    visit("writer_gid_seq", m.writer_gid_seq);
  }
};
struct ParticipantEntitiesInfo {
  static constexpr const char* kType = "rmw_dds_common/msg/ParticipantEntitiesInfo";
  Gid gid;
  std::vector<NodeEntitiesInfo> node_entities_info_seq;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("gid", m.gid);
    visit("node_entities_info_seq", m.node_entities_info_seq);
  }
};

[[noreturn]] void refuse(const std::string& what, dds_return_t code) {
  throw InputError("dds: " + what + ": " + dds_strretcode(code));
}
dds_entity_t made(dds_entity_t entity, const std::string& what) {
  if (entity < 0) refuse(what, entity);
  return entity;
}

Gid gid_of(dds_entity_t entity) {
  dds_guid_t guid{};
  dds_get_guid(entity, &guid);
  Gid gid;
  std::copy(std::begin(guid.v), std::end(guid.v), gid.data.begin());
  return gid;
}
std::string key_of(const dds_guid_t& guid) {
  return {reinterpret_cast<const char*>(guid.v), sizeof guid.v};
}
std::string key_of(const Gid& gid) {
  return {reinterpret_cast<const char*>(gid.data.data()), gid.data.size()};
}

/// What a participant calls itself: its name, or its process and where that runs; "": nothing.
std::string name_in(const dds_qos_t* qos) {
  const auto text = [&](auto get) -> std::string {
    char* value = nullptr;
    if (!get(&value) || !value) return "";
    const std::string copy = value;
    dds_free(value);
    return copy;
  };
  const auto property = [&](const char* key) {
    return text([&](char** value) { return dds_qget_prop(qos, key, value); });
  };
  const std::string process = property("__ProcessName");
  if (!process.empty()) {
    return "the process " + process + " (" + property("__Pid") + " on " + property("__Hostname") +
           ')';
  }
  return text([&](char** value) { return dds_qget_entity_name(qos, value); });
}

using Qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;
Qos make_qos() { return {dds_create_qos(), dds_delete_qos}; }
Qos make_qos(const DdsQos& wanted, const std::string& user_data) {
  Qos qos = make_qos();
  // Nobody waits for a slow reader.
  dds_qset_reliability(qos.get(),
                       wanted.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(
      qos.get(), wanted.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, wanted.depth);
  if (wanted.transient_local) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, wanted.depth, -1, -1, -1);
  }
  if (wanted.lease > 0.0) {
    dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC,
                        static_cast<dds_duration_t>(std::llround(1e9 * wanted.lease)));
  }
  dds_qset_writer_data_lifecycle(qos.get(), false);
  if (!user_data.empty()) dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  return qos;
}

const char* policy_name(std::uint32_t id) {
  switch (id) {
    case DDS_RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    case DDS_DURABILITY_QOS_POLICY_ID:
      return "durability";
    case DDS_DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case DDS_LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    case DDS_OWNERSHIP_QOS_POLICY_ID:
      return "ownership";
    default:
      return "a policy";
  }
}

std::string described(const DdsQos& qos) {
  std::string text = std::string(qos.reliable ? "reliable" : "best effort") + ", " +
                     (qos.transient_local ? "transient local" : "volatile");
  if (qos.lease > 0.0) text += formatted(", with a liveliness lease of %g s", qos.lease);
  return text;
}

}  // namespace

struct DdsNode::Impl {
  struct Topic {
    std::string name, type;
    Role role = Role::kTopic;
    DdsQos qos;
    dds_entity_t endpoint = 0;
    bool reads = false;
    PublisherHandler handler;
    std::string dds_name, dds_type;  // of both, in DDS
    SampleJudge messages;            // under `mutex`
    std::string bad_qos;             // likewise
  };

  explicit Impl(const DdsAddress& given) : address(given) {
    std::string text = address.configuration.empty() ? dds_configuration(address.loopback)
                                                     : read_whole_file(address.configuration);
    // Of a list the later entries count.
    if (!address.uri.empty()) text += ',' + address.uri;
    domain = dds_create_domain(static_cast<dds_domainid_t>(address.domain), text.c_str());
    if (domain < 0 && domain != DDS_RETCODE_PRECONDITION_NOT_MET) {
      refuse(!address.configuration.empty() ? address.configuration
             : !address.uri.empty()         ? "CYCLONEDDS_URI " + address.uri
                                            : "domain " + std::to_string(address.domain),
             domain);
    }
    try {
      const Qos qos = make_qos();
      const std::string enclave = "enclave=/;";
      dds_qset_userdata(qos.get(), enclave.data(), enclave.size());
      participant = made(
          dds_create_participant(static_cast<dds_domainid_t>(address.domain), qos.get(), nullptr),
          "no participant in domain " + std::to_string(address.domain));
      waits = made(dds_create_waitset(participant), "no wait set");
      others_writers =
          made(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
               "no discovery");
      others_readers =
          made(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
               "no discovery");
      others =
          made(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
               "no discovery");
      const auto of_nodes = ros::definition_of<ParticipantEntitiesInfo>();
      info = made_endpoint("ros_discovery_info", of_nodes, kLatchedQos, false);
      others_nodes = made_endpoint("ros_discovery_info", of_nodes, kDiscoveryQos, true);
      for (const dds_entity_t reader : {others, others_writers, others_readers, others_nodes}) {
        watch(reader);
      }
      own_key = key_of(gid_of(participant));
    } catch (...) {
      end();
      throw;
    }
  }
  ~Impl() {
    stop();
    end();
  }
  void stop() {
    if (!thread.joinable()) return;
    thread.request_stop();
    thread.join();
  }

  void end() {
    if (participant > 0) dds_delete(participant);
    if (domain > 0) dds_delete(domain);
  }

  void watch(dds_entity_t reader) {
    dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(waits, reader, reader);
  }

  dds_entity_t made_endpoint(const std::string& dds_name,
                             const std::vector<ros::MessageDefinition>& definition,
                             const DdsQos& wanted, bool reads) {
    ddsi_sertype* type = make_raw_type(dds_type(definition.front().name));
    const dds_entity_t topic =
        dds_create_topic_sertype(participant, dds_name.c_str(), &type, nullptr, nullptr, nullptr);
    if (topic < 0) {
      free_raw_type(type);
      refuse("topic " + dds_name, topic);
    }
    const Qos qos = make_qos(wanted, "typehash=" + type_hash(definition) + ";");
    const dds_entity_t endpoint = reads ? dds_create_reader(participant, topic, qos.get(), nullptr)
                                        : dds_create_writer(participant, topic, qos.get(), nullptr);
    dds_delete(topic);  // the endpoint keeps it
    return made(endpoint, "topic " + dds_name);
  }

  void add(Topic topic, const std::vector<ros::MessageDefinition>& definition) {
    const std::string problem = topic_problem(topic.name);
    if (!problem.empty()) throw InputError("dds: topic " + problem);
    topic.type = definition.front().name;
    topic.dds_name = topic.role == Role::kRequests  ? dds_requests(topic.name)
                     : topic.role == Role::kReplies ? dds_replies(topic.name)
                                                    : dds_topic(topic.name);
    topic.dds_type = dds_type(topic.type);
    topic.endpoint = made_endpoint(topic.dds_name, definition, topic.qos, topic.reads);
    looked_at.insert(topic.dds_name);
    if (topic.reads) watch(topic.endpoint);
    topics.push_back(std::move(topic));
  }

  void announce() {
    ParticipantEntitiesInfo message;
    message.gid = gid_of(participant);
    NodeEntitiesInfo node{
        address.its_namespace.empty() ? "/" : address.its_namespace, address.node, {}, {}};
    for (const Topic& topic : topics) {
      (topic.reads ? node.reader_gid_seq : node.writer_gid_seq).push_back(gid_of(topic.endpoint));
    }
    message.node_entities_info_seq.push_back(std::move(node));
    const std::string bytes = ros::to_cdr(message);
    dds_write(info, &bytes);
  }

  void run(const std::stop_token& stop) noexcept {
    while (!stop.stop_requested()) {
      std::array<dds_attach_t, 8> ready{};
      dds_waitset_wait(waits, ready.data(), ready.size(), kPeriod);
      try {
        look_at_participants();
        look_at_nodes();
        look_at_endpoints(others_writers, true);
        look_at_endpoints(others_readers, false);
        for (Topic& topic : topics) {
          if (stop.stop_requested()) return;
          if (topic.reads) take(topic);
          look_at_qos(topic);
        }
        send_answers();
      } catch (...) {
        // Memory is used up: what could not be taken is lost, and stamps tell that it did not come.
      }
    }
  }

  void take(Topic& topic) {
    for (;;) {
      ddsi_serdata* sample = nullptr;
      dds_sample_info_t sample_info{};
      if (dds_takecdr(topic.endpoint, &sample, 1, &sample_info, DDS_ANY_STATE) != 1) return;
      const std::unique_ptr<ddsi_serdata, void (*)(ddsi_serdata*)> held(
          sample, [](ddsi_serdata* s) { ddsi_serdata_unref(s); });
      if (!sample_info.valid_data) continue;
      std::string problem;
      try {
        topic.handler(bytes_of(sample), topic.name, sample_info.publication_handle);
      } catch (const std::exception& error) {
        problem = error.what();
      }
      const std::lock_guard lock(mutex);
      problem.empty() ? topic.messages.good() : topic.messages.bad(problem);
    }
  }

  /// Hands each sample of a topic of discovery on, and whether what it tells of is there.
  template <typename Sample, typename Take>
  void look_at(dds_entity_t reader, const Take& take) {
    for (;;) {
      void* sample = nullptr;
      dds_sample_info_t sample_info{};
      if (dds_take(reader, &sample, &sample_info, 1, 1) != 1) return;
      {
        const std::lock_guard lock(mutex);
        take(*static_cast<const Sample*>(sample),
             sample_info.valid_data && sample_info.instance_state == DDS_IST_ALIVE);
      }
      dds_return_loan(reader, &sample, 1);
    }
  }
  void look_at_participants() {
    look_at<dds_builtintopic_participant_t>(others, [&](const auto& other, bool there) {
      there ? discovered.set_participant(key_of(other.key), name_in(other.qos))
            : discovered.remove_participant(key_of(other.key));
    });
  }
  void look_at_endpoints(dds_entity_t reader, bool they_write) {
    look_at<dds_builtintopic_endpoint_t>(reader, [&](const auto& other, bool there) {
      const std::string key = key_of(other.key), from = key_of(other.participant_key);
      if (!there) {
        discovered.remove(key);
      } else if (from != own_key && looked_at.contains(other.topic_name)) {
        discovered.add(key, {other.topic_name, other.type_name, from, they_write});
      }
    });
  }
  /// Which node of ROS 2 an endpoint belongs to. What is no such message names nobody.
  void look_at_nodes() {
    for (;;) {
      ddsi_serdata* sample = nullptr;
      dds_sample_info_t sample_info{};
      if (dds_takecdr(others_nodes, &sample, 1, &sample_info, DDS_ANY_STATE) != 1) return;
      const std::unique_ptr<ddsi_serdata, void (*)(ddsi_serdata*)> held(
          sample, [](ddsi_serdata* s) { ddsi_serdata_unref(s); });
      if (!sample_info.valid_data) continue;
      ParticipantEntitiesInfo told;
      try {
        told = ros::from_cdr<ParticipantEntitiesInfo>(bytes_of(sample), "ros_discovery_info");
      } catch (const InputError&) {
        continue;
      }
      std::map<std::string, std::string> names;
      for (const NodeEntitiesInfo& node : told.node_entities_info_seq) {
        const std::string name = full_name(node.node_namespace, node.node_name);
        for (const Gid& gid : node.writer_gid_seq) names[key_of(gid)] = name;
      }
      const std::lock_guard lock(mutex);
      discovered.set_nodes(key_of(told.gid), std::move(names));
    }
  }
  static std::string full_name(const std::string& its_namespace, const std::string& name) {
    return (its_namespace == "/" ? "" : its_namespace) + "/" + name;
  }

  /// Of one who publishes on or listens to a topic here; "": not known.
  static std::string participant_of(dds_builtintopic_endpoint_t* endpoint) {
    if (!endpoint) return "";
    const std::string key = key_of(endpoint->participant_key);
    dds_delete_qos(endpoint->qos);
    dds_free(endpoint->topic_name);
    dds_free(endpoint->type_name);
    dds_free(endpoint);
    return key;
  }
  bool listens(const Topic& topic, const std::string& participant) const {
    std::array<dds_instance_handle_t, 100> readers{};
    const dds_return_t count =
        dds_get_matched_subscriptions(topic.endpoint, readers.data(), readers.size());
    for (dds_return_t n = 0; n < std::min<dds_return_t>(count, readers.size()); ++n) {
      const auto reader = readers[static_cast<std::size_t>(n)];
      if (participant_of(dds_get_matched_subscription_data(topic.endpoint, reader)) ==
          participant) {
        return true;
      }
    }
    return false;
  }
  void send_answers() {
    const std::lock_guard lock(answers_mutex);
    const auto now = std::chrono::steady_clock::now();
    std::erase_if(answers, [&](const Answer& answer) {
      const Topic& topic = topics[static_cast<std::size_t>(answer.topic)];
      if (!listens(topic, answer.participant)) return now > answer.until;
      dds_write(topic.endpoint, &answer.cdr);
      return true;
    });
  }

  void look_at_qos(Topic& topic) {
    std::uint32_t policy = 0, count = 0;
    if (topic.reads) {
      dds_requested_incompatible_qos_status_t status{};
      dds_get_requested_incompatible_qos_status(topic.endpoint, &status);
      count = status.total_count, policy = status.last_policy_id;
    } else {
      dds_offered_incompatible_qos_status_t status{};
      dds_get_offered_incompatible_qos_status(topic.endpoint, &status);
      count = status.total_count, policy = status.last_policy_id;
    }
    if (count == 0) return;
    const std::string text =
        topic.name + ": " + policy_name(policy) + " of another node's " +
        (topic.reads ? "publisher" : "subscription") + " does not fit; expected one that fits " +
        (topic.reads ? "a subscription" : "a publisher") + " that is " + described(topic.qos);
    const std::lock_guard lock(mutex);
    topic.bad_qos = text;
  }

  const Topic* find(const std::string& name, bool reads) const {
    for (const Topic& topic : topics) {
      if (topic.role == Role::kTopic && topic.name == name && topic.reads == reads) return &topic;
    }
    return nullptr;
  }
  std::string fault(const Topic& topic) const {
    {
      const std::lock_guard lock(mutex);
      if (std::string bad = topic.messages.fault(); !bad.empty()) return bad;
    }
    if (connected(topic) > 0) return "";
    const std::string other = other_type(topic);
    const std::lock_guard lock(mutex);
    return other.empty() ? topic.bad_qos : other;
  }
  /// Another's endpoint of the topic with another type: DDS does not connect it. Where one is
  /// connected that fits, that is no fault: neither hears the other.
  std::string other_type(const Topic& topic) const {
    const std::lock_guard lock(mutex);
    const std::string other = discovered.other_type(topic.dds_name, topic.dds_type, topic.reads);
    if (other.empty()) return "";
    return topic.name + ": another node " + (topic.reads ? "publishes " : "expects ") +
           ros_type(other) + "; expected " + topic.type;
  }
  static int connected(const Topic& topic) {
    if (topic.reads) {
      dds_subscription_matched_status_t status{};
      dds_get_subscription_matched_status(topic.endpoint, &status);
      return static_cast<int>(status.current_count);
    }
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(topic.endpoint, &status);
    return static_cast<int>(status.current_count);
  }

  static constexpr dds_duration_t kPeriod = DDS_MSECS(20);
  static constexpr DdsQos kDiscoveryQos{true, true, 1000};  // of many participants, one topic
  DdsAddress address;
  dds_entity_t domain = 0, participant = 0, waits = 0, info = 0;
  dds_entity_t others = 0, others_writers = 0, others_readers = 0, others_nodes = 0;
  std::string own_key;
  std::deque<Topic> topics;  // none is added once the thread runs
  mutable std::mutex mutex;
  std::set<std::string> looked_at;  // names of topics in DDS; as `topics`
  DiscoveredEndpoints discovered;   // under `mutex`
  struct Answer {
    int topic;
    std::string participant, cdr;
    std::chrono::steady_clock::time_point until;
  };
  static constexpr std::size_t kMostAnswers = 100;
  std::mutex answers_mutex;
  std::vector<Answer> answers;  // that wait for who asked
  std::jthread thread;
};

DdsNode::DdsNode(const DdsAddress& address) : impl_(std::make_unique<Impl>(address)) {}
DdsNode::~DdsNode() = default;

void DdsNode::subscribe(const std::string& topic,
                        const std::vector<ros::MessageDefinition>& definition, const DdsQos& qos,
                        PublisherHandler handler, Role role) {
  Impl::Topic added;
  added.name = topic;
  added.role = role;
  added.qos = qos;
  added.reads = true;
  added.handler = std::move(handler);
  impl_->add(std::move(added), definition);
}

void DdsNode::subscribe(const std::string& topic,
                        const std::vector<ros::MessageDefinition>& definition, const DdsQos& qos,
                        Handler handler) {
  subscribe(
      topic, definition, qos,
      PublisherHandler([handler = std::move(handler)](std::string_view cdr, const std::string& name,
                                                      std::uint64_t) { handler(cdr, name); }));
}

int DdsNode::advertise(const std::string& topic,
                       const std::vector<ros::MessageDefinition>& definition, const DdsQos& qos,
                       Role role) {
  Impl::Topic added;
  added.name = topic;
  added.role = role;
  added.qos = qos;
  impl_->add(std::move(added), definition);
  return static_cast<int>(impl_->topics.size()) - 1;
}

void DdsNode::watch(const std::string& topic) { impl_->looked_at.insert(dds_topic(topic)); }

void DdsNode::start() {
  impl_->announce();
  impl_->thread = std::jthread([this](const std::stop_token& stop) { impl_->run(stop); });
}

void DdsNode::stop() { impl_->stop(); }

bool DdsNode::publish(int topic, const std::string& cdr) noexcept {
  if (topic < 0 || topic >= static_cast<int>(impl_->topics.size())) return false;
  const Impl::Topic& to = impl_->topics[static_cast<std::size_t>(topic)];
  return !to.reads && dds_write(to.endpoint, &cdr) == DDS_RETCODE_OK;
}

void DdsNode::answer(int topic, std::uint64_t publisher, std::string cdr) {
  const Impl::Topic& replies = impl_->topics.at(static_cast<std::size_t>(topic));
  const Impl::Topic* requests = nullptr;
  for (const Impl::Topic& one : impl_->topics) {
    if (one.role == Role::kRequests && one.name == replies.name) requests = &one;
  }
  if (!requests) return;
  std::string participant =
      Impl::participant_of(dds_get_matched_publication_data(requests->endpoint, publisher));
  const std::lock_guard lock(impl_->answers_mutex);
  if (participant.empty() || impl_->answers.size() == Impl::kMostAnswers) return;
  impl_->answers.push_back({topic, std::move(participant), std::move(cdr),
                            std::chrono::steady_clock::now() + std::chrono::seconds(1)});
}

int DdsNode::publishers(const std::string& topic) const {
  const Impl::Topic* found = impl_->find(topic, true);
  return found ? Impl::connected(*found) : 0;
}
int DdsNode::subscribers(const std::string& topic) const {
  const Impl::Topic* found = impl_->find(topic, false);
  return found ? Impl::connected(*found) : 0;
}

std::vector<std::string> DdsNode::publisher_names(const std::string& topic) const {
  const Impl::Topic *heard = impl_->find(topic, true), *spoken = impl_->find(topic, false);
  std::vector<std::string> names;
  {
    const std::lock_guard lock(impl_->mutex);
    names = impl_->discovered.writers(dds_topic(topic), heard ? heard->dds_type : "");
  }
  if (heard) {
    names.resize(std::max(names.size(), static_cast<std::size_t>(Impl::connected(*heard))),
                 "one that says no name");
  }
  std::sort(names.begin(), names.end());
  if (spoken) {
    const std::string own = impl_->address.its_namespace + "/" + impl_->address.node;
    names.insert(names.begin(), own + " (this program)");
  }
  return names;
}

std::vector<std::uint64_t> DdsNode::live_publishers(const std::string& topic) const {
  const Impl::Topic* found = impl_->find(topic, true);
  if (!found) return {};
  constexpr std::size_t kMost = 100;
  std::vector<std::uint64_t> all(kMost);
  const dds_return_t count = dds_get_matched_publications(found->endpoint, all.data(), all.size());
  dds_liveliness_changed_status_t status{};
  dds_get_liveliness_changed_status(found->endpoint, &status);
  if (count < 0 || static_cast<dds_return_t>(status.alive_count) < count) return {};
  all.resize(std::min(all.size(), static_cast<std::size_t>(count)));
  return all;
}

std::string DdsNode::fault(const std::string& topic) const {
  for (const Impl::Topic& one : impl_->topics) {
    if (one.name != topic) continue;
    const std::string text = impl_->fault(one);
    if (!text.empty()) return text;
  }
  return "";
}

std::vector<std::string> DdsNode::faults() const {
  std::vector<std::string> all;
  std::set<std::string> said;
  for (const Impl::Topic& one : impl_->topics) {
    for (const std::string& text : {impl_->fault(one), impl_->other_type(one)}) {
      if (!text.empty() && said.insert(text).second) all.push_back(text);
    }
  }
  return all;
}

#else

struct DdsNode::Impl {};

DdsNode::DdsNode(const DdsAddress&) {
  throw NotBuiltIn("ROS 2 over DDS", "cyclonedds-dev and libssl-dev");
}
DdsNode::~DdsNode() = default;
void DdsNode::subscribe(const std::string&, const std::vector<ros::MessageDefinition>&,
                        const DdsQos&, PublisherHandler, Role) {}
void DdsNode::subscribe(const std::string&, const std::vector<ros::MessageDefinition>&,
                        const DdsQos&, Handler) {}
int DdsNode::advertise(const std::string&, const std::vector<ros::MessageDefinition>&,
                       const DdsQos&, Role) {
  return -1;
}
void DdsNode::answer(int, std::uint64_t, std::string) {}
void DdsNode::watch(const std::string&) {}
void DdsNode::start() {}
void DdsNode::stop() {}
bool DdsNode::publish(int, const std::string&) noexcept { return false; }
int DdsNode::publishers(const std::string&) const { return 0; }
std::vector<std::uint64_t> DdsNode::live_publishers(const std::string&) const { return {}; }
std::vector<std::string> DdsNode::publisher_names(const std::string&) const { return {}; }
int DdsNode::subscribers(const std::string&) const { return 0; }
std::string DdsNode::fault(const std::string&) const { return ""; }
std::vector<std::string> DdsNode::faults() const { return {}; }

#endif

}  // namespace prospect
