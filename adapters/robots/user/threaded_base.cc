// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/threaded_base.h"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/formatted.h"
#include "models/one_line.h"
#include "runtime/clock.h"
#include "runtime/realtime_priority.h"

namespace prospect {
namespace {

/// A line that a driver says: no control characters, not without end.
std::string line_of(std::string text, const char* if_empty) {
  constexpr std::size_t kLongest = 300;
  if (text.size() > kLongest) text.resize(kLongest);
  return text.empty() ? if_empty : one_line(std::move(text));
}

/// "" or why the call failed.
template <class Call>
std::string failure_of(const Call& call) {
  try {
    call();
    return "";
  } catch (const std::exception& e) {
    return line_of(e.what(), "an exception without words");
  } catch (...) {
    return "an exception that is not a std::exception";
  }
}

/// What a base says of itself.
template <class Call>
auto asked(const char* what, const Call& call) {
  decltype(call()) value{};
  const std::string why = failure_of([&] { value = call(); });
  if (!why.empty()) {
    throw std::invalid_argument(std::string("its base failed in ") + what + "(): " + why);
  }
  return value;
}

}  // namespace

struct ThreadedBase::Calls {
  /// What is wrong with one kind of call; stands until one went well after it was told of.
  struct Failure {
    std::string text;
    bool told = false;

    void after(const char* call, const std::string& why) {
      if (!why.empty()) {
        *this = {std::string("its driver failed in ") + call + "(): " + why, false};
      } else if (told) {
        *this = {};
      }
    }
  };
  struct Order {
    bool stop = false;
    Twist command;
    double expires = 0.0;
  };

  explicit Calls(std::shared_ptr<Base> driver) : base(std::move(driver)) {}

  void run(const std::stop_token& ends) {
    std::unique_lock lock(mutex);
    // What was ordered before the end is done.
    while (wanted.wait(lock, ends, [this] { return order || report_wanted; })) {
      if (order) {
        const Order next = *std::exchange(order, std::nullopt);
        running = next.stop ? "stop" : "send";
        commanded.after(running, called(lock, [&] {
                          next.stop ? base->stop() : base->send(next.command, next.expires);
                        }));
      } else {
        report_wanted = false;
        running = "report";
        BaseReport fresh;
        const std::string why = called(lock, [&] { fresh = base->report(); });
        reported.after(running, why);
        if (why.empty()) {
          take(std::move(fresh));
        } else {
          newest.connected = false;
        }
        ++answers;
      }
      running = nullptr;
      answered.notify_all();
    }
  }

  template <class Call>
  std::string called(std::unique_lock<std::mutex>& lock, const Call& call) {
    began = clock.now();
    lock.unlock();
    const std::string why = failure_of(call);
    lock.lock();
    return why;
  }

  void take(BaseReport fresh) {
    constexpr std::size_t kMostWheels = 10000, kMostFaults = 20;
    std::vector<WheelSample> wheels = std::move(newest.wheels);
    wheels.insert(wheels.end(), fresh.wheels.begin(), fresh.wheels.end());
    if (wheels.size() > kMostWheels) {
      wheels.erase(wheels.begin(), wheels.end() - static_cast<std::ptrdiff_t>(kMostWheels));
    }
    newest = std::move(fresh);
    newest.wheels = std::move(wheels);
    if (newest.faults.size() > kMostFaults) newest.faults.resize(kMostFaults);
    for (std::string& fault : newest.faults) fault = line_of(fault, "a fault without words");
  }

  void put(const Order& next) {
    {
      const std::lock_guard lock(mutex);
      order = next;
    }
    wanted.notify_one();
  }

  const std::shared_ptr<Base> base;
  const SteadyClock clock;
  std::mutex mutex;  // of what follows
  std::condition_variable_any wanted, answered;
  std::optional<Order> order;
  bool report_wanted = false;
  std::uint64_t answers = 0;
  const char* running = nullptr;  // the call that is being made
  double began = 0.0;             // [s] when
  BaseReport newest;              // with all wheel motion that was not told yet
  Failure commanded, reported;
};

ThreadedBase::ThreadedBase(std::shared_ptr<Base> base, int priority)
    : name_(line_of(asked("name", [&] { return base->name(); }), "base")),
      dead_man_(asked("dead_man", [&] { return base->dead_man(); })),
      limits_(asked("limits", [&] { return base->limits(); })),
      calls_(std::make_shared<Calls>(std::move(base))),
      thread_([calls = calls_, priority](const std::stop_token& ends) {
        const RealtimePriority first(priority);
        calls->run(ends);
      }) {}

void ThreadedBase::send(const Twist& command, double expires) noexcept {
  calls_->put({false, command, expires});
}

void ThreadedBase::stop() noexcept { calls_->put({true, {}, 0.0}); }

BaseReport ThreadedBase::report() noexcept {
  Calls& c = *calls_;
  std::unique_lock lock(c.mutex);
  const std::uint64_t before = c.answers;
  c.report_wanted = true;
  c.wanted.notify_one();
  const auto hangs = [&] { return c.running && c.clock.now() - c.began > kPatience; };
  if (!hangs()) {
    c.answered.wait_for(lock, std::chrono::duration<double>(kPatience),
                        [&] { return c.answers > before; });
  }
  BaseReport report = c.newest;
  c.newest.wheels.clear();
  for (Calls::Failure* failure : {&c.commanded, &c.reported}) {
    if (failure->text.empty()) continue;
    report.faults.push_back(failure->text);
    failure->told = true;
  }
  const double takes = c.running ? c.clock.now() - c.began : 0.0;
  if (takes > kLongest) {
    report.faults.push_back(
        formatted("its driver has not returned from %s() for %.1f s: what its "
                  "motors were told last they may still do until their dead-man",
                  c.running, takes));
  }
  return report;
}

}  // namespace prospect
