// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/page_show.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "adapters/formats/images/image_codec.h"

namespace prospect {
namespace {

constexpr std::size_t kShownEvents = 50;
constexpr std::size_t kPortion = 200;  // steps in a message

}  // namespace

class PageViewer final : public Viewer {
 public:
  PageViewer(PageShow& show, bool may_command) : show_(show), may_command_(may_command) {}

  std::optional<LiveMessage> next() override {
    if (!answers_.empty()) {
      LiveMessage answer{std::make_shared<std::string>(std::move(answers_.front()))};
      answers_.pop_front();
      return answer;
    }
    if (!welcomed_) {
      welcomed_ = true;
      return LiveMessage{
          std::make_shared<std::string>(welcome_message({may_command_, show_.real_time_}))};
    }
    // In turn, so that none waits for ever behind another.
    for (std::size_t k = 0; k < kKinds; ++k) {
      const std::size_t kind = turn_++ % kKinds;
      if (auto message = kind == 0 ? steps() : newest(kind - 1)) return message;
    }
    return std::nullopt;
  }

  bool message(std::string_view bytes, bool text) override {
    if (!text) return false;
    const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
    if (!json.is_object() || json.value("op", nlohmann::json()) != "command") return false;
    const auto name = json.find("name");
    if (name == json.end() || !name->is_string()) return false;
    answer(name->get<std::string>(), command(name->get<std::string>(), json));
    return answers_.size() <= kMostAnswers;
  }

  std::uint64_t dropped() const override { return dropped_; }

 private:
  static constexpr std::size_t kNewest = 4, kKinds = kNewest + 1;
  static constexpr std::size_t kMostAnswers = 100;  // that wait for somebody who does not read

  std::optional<LiveMessage> steps() {
    if (show_.history_.newest() <= shown_) return std::nullopt;
    if (show_.portion_after_ != shown_ || show_.portion_to_ != show_.history_.newest()) {
      const auto portion = show_.history_.since(shown_, kPortion);
      show_.portion_ = std::make_shared<std::string>(steps_message(portion, show_.resolution_));
      show_.portion_after_ = shown_;
      show_.portion_to_ = portion.back()->step;
    }
    shown_ = show_.portion_to_;
    return LiveMessage{show_.portion_};
  }

  std::optional<LiveMessage> newest(std::size_t kind) {
    PageShow::Newest& newest =
        *std::array{&show_.status_, &show_.pose_, &show_.picture_, &show_.end_}[kind];
    std::uint64_t& seen = seen_[kind];
    if (newest.number == seen) return std::nullopt;
    // What was there before it came is not what it missed.
    if (seen > 0) dropped_ += newest.number - seen - 1;
    seen = newest.number;
    return LiveMessage{newest.get()};
  }

  /// Empty, or why it was not done.
  std::string command(const std::string& name, const nlohmann::json& json) {
    if (!may_command_) return "only who has the token may command";
    std::string refused;
    if (name == "go") {
      const auto x = json.find("x"), y = json.find("y");
      if (x == json.end() || y == json.end() || !x->is_number() || !y->is_number()) {
        return "no place; expected numbers x and y [m]";
      }
      refused = show_.commands_.go({x->get<double>(), y->get<double>()});
    } else {
      refused = show_.commands_.give(name);
    }
    show_.renew_status();
    return refused;
  }

  void answer(const std::string& name, const std::string& refused) {
    answers_.push_back(
        nlohmann::ordered_json({{"op", "answer"}, {"name", name}, {"refused", refused}})
            .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }

  PageShow& show_;
  const bool may_command_;
  bool welcomed_ = false;
  std::size_t turn_ = 0;
  int shown_ = -1;  // number of the newest step that it has
  std::array<std::uint64_t, kNewest> seen_{};
  std::deque<std::string> answers_;
  std::uint64_t dropped_ = 0;
};

PageShow::PageShow(double resolution, bool real_time, DriveCommands& commands)
    : resolution_(resolution), real_time_(real_time), commands_(commands) {
  load_image_codecs_if_there();
  renew_status();
}

void PageShow::add(const LiveFeed::News& news) {
  for (const auto& step : news.steps) {
    if (!began_) began_ = step->stamp - step->time;
    history_.add(step);
  }
  for (const Event& event : news.events) {
    // One that has happened again takes the place of what was said of it before.
    std::erase_if(events_, [&](const Event& known) {
      return known.stamp == event.stamp && known.source == event.source &&
             known.cause == event.cause;
    });
    events_.push_back(event);
    if (events_.size() > kShownEvents) events_.pop_front();
  }
  if (news.pose) pose_.set([pose = news.pose] { return pose_message(*pose); });
  if (news.picture) picture_.set([picture = news.picture] { return picture_message(*picture); });
  if (news.end) end_.set([end = news.end] { return end_message(*end); });
  if (news.driver) driver_ = news.driver;
  dropped_steps_ = news.dropped;
  const DriveRequests& requests = commands_.requests();
  const Asked asked{requests.told_to_drive(), requests.stopped(), requests.told()};
  if (news.driver || !news.events.empty() || asked != asked_) renew_status();
  asked_ = asked;
}

void PageShow::count(const ViewerCounts& counts) {
  if (counts.viewers == counts_.viewers && counts.dropped == counts_.dropped) return;
  counts_ = counts;
  renew_status();
}

void PageShow::renew_status() {
  // Made when it is wanted, of what is known then.
  status_.set([this] {
    const DriveRequests& requests = commands_.requests();
    return status_message({driver_.get(),
                           {events_.begin(), events_.end()},
                           counts_,
                           dropped_steps_,
                           requests.told_to_drive(),
                           requests.stopped(),
                           requests.told(),
                           began_});
  });
}

std::unique_ptr<Viewer> PageShow::viewer(bool may_command) {
  return std::make_unique<PageViewer>(*this, may_command);
}

}  // namespace prospect
