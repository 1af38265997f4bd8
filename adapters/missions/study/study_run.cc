// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_run.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <limits>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

#include "adapters/formats/files/child_process.h"
#include "adapters/formats/files/exit_code.h"
#include "adapters/formats/files/file_lock.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/whole_file.h"
#include "adapters/missions/run/run_start.h"

namespace prospect {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string host_name() {
  char name[256] = {};
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// The last line of a file that says something, "" if there is none.
std::string last_line(const std::string& path) {
  std::ifstream in(path);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  constexpr std::size_t kLongest = 500;
  const std::string name = "prospect: ";
  if (last.starts_with(name)) last.erase(0, name.size());
  return last.substr(0, kLongest);
}

bool of_this_machine(const std::string& line) {
  return line.find("writing failed") != std::string::npos ||
         line.find("cannot be written") != std::string::npos ||
         line.find("No space left") != std::string::npos;
}

struct RunningCell {
  const StudyCell* cell = nullptr;
  FileLock lock;
  ChildProcess process;
  CellRecord record;
  Clock::time_point start;
};

class StudyRunner {
 public:
  StudyRunner(const StudyPlan& plan, const CellStore& store, const StudyRunOptions& options)
      : plan_(plan), store_(store), options_(options), times_(plan) {}

  StudyRunResult run() {
    std::map<std::string, const StudyCell*> by_id;
    for (const StudyCell& cell : plan_.cells) by_id.emplace(cell.id, &cell);
    for (const std::string& id : cells_of(plan_, options_.shard)) {
      ++result_.cells;
      const CellRecord record = store_.record(id);
      if (record.status == CellRecord::Status::kDone) {
        ++result_.there;
        times_.add(id, record.wall_s);
      } else if (record.status == CellRecord::Status::kFailed && !options_.retry_failed) {
        ++result_.failed;
      } else {
        waiting_.push_back(by_id.at(id));
      }
    }
    while (!waiting_.empty() || !running_.empty()) {
      if (options_.cancelled && options_.cancelled()) {
        result_.cancelled = true;
        running_.clear();  // kills them
        break;
      }
      while (!waiting_.empty() && static_cast<int>(running_.size()) < options_.jobs) {
        const StudyCell& cell = *waiting_.front();
        waiting_.pop_front();
        begin(cell);
      }
      collect();
      if (!result_.stopped.empty()) waiting_.clear();
      tell();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return result_;
  }

 private:
  void begin(const StudyCell& cell) {
    const std::string lock_file = store_.path(cell.id, ".lock");
    FileLock lock(lock_file);
    if (lock.busy()) {
      ++result_.elsewhere;
      return;
    }
    if (!lock.held()) {
      fail(lock_file, "cannot be locked (" + lock.reason() + "); expected a writable folder");
    }
    // Another process may have done it since.
    const CellRecord now = store_.record(cell.id);
    if (now.status == CellRecord::Status::kDone) {
      ++result_.there;
      remove_file(lock_file);
      return;
    }
    RunningCell running;
    running.cell = &cell;
    running.record.host = host_name();
    running.record.version = options_.version;
    running.record.started = utc_now();
    store_.write_begun(cell.id, running.record);
    std::vector<std::string> words = options_.program;
    const std::vector<std::string> own =
        plan_.study.kind == Study::Kind::kBenches ? bench_of(cell) : mission_of(cell);
    words.insert(words.end(), own.begin(), own.end());
    for (const std::string& plugin : options_.plugins) {
      words.insert(words.end(), {"--plugin", plugin});
    }
    running.start = Clock::now();
    running.process = ChildProcess(
        words, {.errors = store_.path(cell.id, ".log"), .kept_open = lock.descriptor()});
    running.lock = std::move(lock);
    running_.push_back(std::move(running));
  }

  std::vector<std::string> bench_of(const StudyCell& cell) const {
    return bench_words(plan_.setup(cell).bench, plan_.study.inputs[cell.input].path, cell.seed,
                       store_.run_folder(cell.id));
  }

  /// The words that begin a mission; its configuration is on disk then.
  std::vector<std::string> mission_of(const StudyCell& cell) const {
    const std::string configuration = store_.path(cell.id, ".yaml");
    const std::string wrong = write_whole_file(configuration, cell_configuration(plan_, cell));
    if (!wrong.empty()) {
      fail(configuration, "cannot be written (" + wrong + "); expected a writable folder");
    }
    return {"explore", plan_.study.inputs[cell.input].path, "--config", configuration,
            "--seed",  std::to_string(cell.seed),           "--out",    store_.run_folder(cell.id),
            "--quiet"};
  }

  void collect() {
    for (auto it = running_.begin(); it != running_.end();) {
      const std::optional<ChildProcess::End> end = it->process.ended();
      if (!end) {
        ++it;
        continue;
      }
      judge(*it, *end);
      it = running_.erase(it);
    }
  }

  void judge(RunningCell& running, const ChildProcess::End& end) {
    const std::string& id = running.cell->id;
    CellRecord& record = running.record;
    record.wall_s = seconds_since(running.start);
    const std::string log = store_.path(id, ".log");
    const std::string lacks = store_.lacks(id);
    if (end.signal == 0 && end.code <= kFailed && lacks.empty()) {
      record.status = CellRecord::Status::kDone;
      store_.write(id, record);
      remove_file(log);
      remove_file(store_.path(id, ".yaml"));
      remove_file(store_.path(id, ".lock"));
      ++result_.ran;
      times_.add(id, record.wall_s);
    } else {
      const std::string said = last_line(log);
      const bool told_to_end = end.signal == SIGTERM || end.signal == SIGINT ||
                               end.signal == SIGHUP || end.code == kCancelled;
      if (told_to_end) {
        ++result_.broken_off;
        return;
      }
      if (of_this_machine(said)) {
        result_.stopped = said;
        return;
      }
      record.status = CellRecord::Status::kFailed;
      record.why = end.signal != 0
                       ? "signal " + std::to_string(end.signal) + " (" + strsignal(end.signal) + ")"
                   : said.empty() ? "exit code " + std::to_string(end.code) + ", " + lacks
                                  : said;
      store_.write(id, record);
      ++result_.failed;
    }
    if (options_.ended) options_.ended(*running.cell, record);
  }

  void tell() {
    if (!options_.progress || (told_ && seconds_since(*told_) < 0.1)) return;
    told_ = Clock::now();
    StudyProgress progress;
    progress.cells = result_.cells;
    progress.done = result_.there + result_.ran;
    progress.failed = result_.failed;
    progress.running = running_.size();
    double left = 0.0;
    for (const StudyCell* cell : waiting_) left += times_.of(cell->id);
    for (const RunningCell& running : running_) {
      left += std::max(0.0, times_.of(running.cell->id) - seconds_since(running.start));
    }
    progress.left_s =
        left / std::max<double>(
                   1.0, std::min<double>(options_.jobs,
                                         static_cast<double>(waiting_.size() + running_.size())));
    if (std::isnan(times_.of(""))) progress.left_s = std::numeric_limits<double>::quiet_NaN();
    options_.progress(progress);
  }

  static void remove_file(const std::string& path) {
    std::error_code error;
    std::filesystem::remove(path, error);
  }

  const StudyPlan& plan_;
  const CellStore& store_;
  const StudyRunOptions& options_;
  ExpectedTimes times_;
  StudyRunResult result_;
  std::deque<const StudyCell*> waiting_;
  std::list<RunningCell> running_;
  std::optional<Clock::time_point> told_;
};

}  // namespace

std::vector<std::string> cells_of(const StudyPlan& plan, const StudyShard& shard) {
  std::vector<std::string> ids;
  std::set<std::string> known;
  for (const StudyCell& cell : plan.cells) {
    std::uint64_t hash = 0;
    std::from_chars(cell.id.data(), cell.id.data() + cell.id.size(), hash, 16);
    const bool mine =
        hash % static_cast<std::uint64_t>(shard.of) == static_cast<std::uint64_t>(shard.number - 1);
    if (mine && known.insert(cell.id).second) ids.push_back(cell.id);
  }
  return ids;
}

StudyRunResult run_study(const StudyPlan& plan, const CellStore& store,
                         const StudyRunOptions& options) {
  return StudyRunner(plan, store, options).run();
}

ExpectedTimes::ExpectedTimes(const StudyPlan& plan) {
  for (const StudyCell& cell : plan.cells) cells_.emplace(cell.id, &cell);
}

void ExpectedTimes::add(const std::string& id, double wall_s) {
  const auto found = cells_.find(id);
  if (found == cells_.end() || !(wall_s > 0.0)) return;
  const StudyCell& cell = *found->second;
  for (Mean* mean : {&alike_[{cell.input, cell.setup}], &of_input_[cell.input], &all_}) {
    mean->sum += wall_s;
    ++mean->count;
  }
}

double ExpectedTimes::of(const std::string& id) const {
  const Mean* mean = &all_;
  if (const auto cell = cells_.find(id); cell != cells_.end()) {
    const auto input = of_input_.find(cell->second->input);
    if (input != of_input_.end()) mean = &input->second;
    const auto alike = alike_.find({cell->second->input, cell->second->setup});
    if (alike != alike_.end()) mean = &alike->second;
  }
  return mean->count > 0 ? mean->sum / mean->count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace prospect
