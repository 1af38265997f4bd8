// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_rows.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <stdexcept>
#include <system_error>
#include <tuple>

#include "adapters/formats/files/input_error.h"
#include "engine/support/named.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFormat = 3;

std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

Json head_json(const BenchTable& table) {
  Json sets = Json::array();
  for (const ProblemSetFacts& set : table.sets) {
    Json problems = Json::array();
    for (const ProblemFacts& problem : set.problems) {
      problems.push_back(
          {{"name", problem.name},
           {"variables", problem.variables},
           {"constraints", problem.constraints},
           {"fingerprint", problem.fingerprint},
           {"best_known", problem.best_known ? Json(*problem.best_known) : Json(nullptr)},
           {"start_cost", problem.start_cost},
           {"cost_change", problem.cost_change}});
    }
    sets.push_back({{"name", set.name},
                    {"best_known_source", set.best_known_source},
                    {"absolute_tolerance", set.absolute_tolerance},
                    {"problems", problems}});
  }
  return {{"bench",
           {{"format", kFormat},
            {"repeats", table.repeats},
            {"max_evaluations", table.max_evaluations},
            {"relative_tolerance", table.relative_tolerance},
            {"clock", to_string(table.clock)},
            {"deadlines_s", table.deadlines},
            {"seeds", table.seeds},
            {"solvers", table.solvers},
            {"sets", sets}}}};
}

Json row_json(const BenchTable& table, const BenchRow& row) {
  Json seconds = Json::array(), evaluations = Json::array(), costs = Json::array(),
       violations = Json::array();
  for (const Improvement& i : row.trace) {
    seconds.push_back(i.seconds);
    evaluations.push_back(i.evaluations);
    costs.push_back(i.cost);
    violations.push_back(i.violation);
  }
  return {{"row",
           {{"set", table.set_of(row).name},
            {"problem", table.problem_of(row).name},
            {"solver", table.solver_of(row)},
            {"deadline_s", row.deadline},
            {"seed", row.seed},
            {"load", row.load},
            {"supported", row.supported},
            {"held", row.held},
            {"stop", to_string(row.stop)},
            {"claimed", to_string(row.claimed)},
            {"quality", to_string(row.quality)},
            {"optimality", row.optimality},
            {"cost", row.cost},
            {"violation", row.violation},
            {"x", std::vector<double>(row.x.begin(), row.x.end())},
            {"cost_evaluations", row.counters.cost_evaluations},
            {"gradient_evaluations", row.counters.gradient_evaluations},
            {"iterations", row.counters.iterations},
            {"wall_s", row.wall_seconds},
            {"cpu_s", row.processor_seconds},
            {"repeat_s", row.repeat_seconds},
            {"overrun_s", row.overrun},
            {"detail", row.detail},
            {"trace",
             {{"seconds", seconds},
              {"evaluations", evaluations},
              {"cost", costs},
              {"violation", violations}}}}}};
}

/// JSON has no infinity and no NaN: null.
double number(const Json& json, double null) { return json.is_null() ? null : json.get<double>(); }

template <class Enum>
Enum word(const Json& json) {
  const std::optional<Enum> value = named<Enum>(json.get<std::string>());
  if (!value) throw std::invalid_argument("'" + json.dump() + "' is no such word");
  return *value;
}

BenchTable table_of(const Json& head) {
  BenchTable table;
  if (head.at("format") != kFormat) {
    throw std::invalid_argument("format " + head.at("format").dump() + " is not known");
  }
  head.at("repeats").get_to(table.repeats);
  head.at("max_evaluations").get_to(table.max_evaluations);
  head.at("relative_tolerance").get_to(table.relative_tolerance);
  const std::string clock = head.at("clock");
  table.clock =
      clock == to_string(SolveClock::kProcessor) ? SolveClock::kProcessor : SolveClock::kWall;
  if (clock != to_string(table.clock))
    throw std::invalid_argument("clock '" + clock + "' is not known");
  head.at("deadlines_s").get_to(table.deadlines);
  head.at("seeds").get_to(table.seeds);
  head.at("solvers").get_to(table.solvers);
  for (const Json& set : head.at("sets")) {
    ProblemSetFacts facts{
        set.at("name"), set.at("best_known_source"), set.at("absolute_tolerance"), {}};
    for (const Json& problem : set.at("problems")) {
      ProblemFacts p{problem.at("name"), problem.at("variables"), problem.at("constraints"),
                     problem.at("fingerprint"), std::nullopt};
      p.start_cost = number(problem.at("start_cost"), std::numeric_limits<double>::quiet_NaN());
      p.cost_change = number(problem.at("cost_change"), 0.0);
      if (!problem.at("best_known").is_null())
        p.best_known = problem.at("best_known").get<double>();
      facts.problems.push_back(std::move(p));
    }
    table.sets.push_back(std::move(facts));
  }
  return table;
}

template <typename List, typename Is>
int index_of(const List& list, Is is, const std::string& what) {
  const auto found = std::find_if(list.begin(), list.end(), is);
  if (found == list.end()) throw std::invalid_argument(what + " is not in the first line");
  return static_cast<int>(found - list.begin());
}

BenchRow row_of(const Json& json, const BenchTable& table, int environment) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  constexpr double kFar = std::numeric_limits<double>::infinity();
  BenchRow row;
  const std::string set = json.at("set"), problem = json.at("problem"), solver = json.at("solver");
  row.set = index_of(
      table.sets, [&](auto& s) { return s.name == set; }, "set '" + set + "'");
  row.problem = index_of(
      table.sets[static_cast<std::size_t>(row.set)].problems,
      [&](auto& p) { return p.name == problem; }, "problem '" + problem + "'");
  row.solver = index_of(
      table.solvers, [&](auto& s) { return s == solver; }, "back end '" + solver + "'");
  json.at("deadline_s").get_to(row.deadline);
  json.at("seed").get_to(row.seed);
  index_of(
      table.deadlines, [&](double d) { return d == row.deadline; }, "the row's deadline");
  index_of(
      table.seeds, [&](int s) { return s == row.seed; }, "the row's seed");
  row.load = number(json.at("load"), kUnknown);
  json.at("supported").get_to(row.supported);
  json.at("held").get_to(row.held);
  row.stop = word<StopReason>(json.at("stop"));
  row.claimed = word<Quality>(json.at("claimed"));
  row.quality = word<Quality>(json.at("quality"));
  row.optimality = number(json.at("optimality"), kUnknown);
  row.cost = number(json.at("cost"), kUnknown);
  row.violation = number(json.at("violation"), kFar);
  const std::vector<double> x = json.at("x");
  row.x = Eigen::VectorXd::Map(x.data(), static_cast<Eigen::Index>(x.size()));
  json.at("cost_evaluations").get_to(row.counters.cost_evaluations);
  json.at("gradient_evaluations").get_to(row.counters.gradient_evaluations);
  json.at("iterations").get_to(row.counters.iterations);
  json.at("wall_s").get_to(row.wall_seconds);
  json.at("cpu_s").get_to(row.processor_seconds);
  row.seconds = table.clock == SolveClock::kWall ? row.wall_seconds : row.processor_seconds;
  json.at("repeat_s").get_to(row.repeat_seconds);
  json.at("overrun_s").get_to(row.overrun);
  json.at("detail").get_to(row.detail);
  const Json& trace = json.at("trace");
  for (std::size_t i = 0; i < trace.at("seconds").size(); ++i) {
    row.trace.push_back({trace.at("seconds").at(i), trace.at("evaluations").at(i),
                         number(trace.at("cost").at(i), kUnknown),
                         number(trace.at("violation").at(i), kFar)});
  }
  if (environment < 0) throw std::invalid_argument("no environment stands before it");
  row.environment = environment;
  return row;
}

[[noreturn]] void fail_to_write(const std::string& path) {
  throw std::runtime_error(path + ": cannot be written (" + std::strerror(errno) + ")");
}

}  // namespace

BenchRowFile::BenchRowFile(const std::string& folder, const BenchTable& table)
    : path_((fs::path(folder) / kBenchRows).string()),
      file_((fs::path(folder) / kBenchRowsPart).string()) {
  if (!file_.is_open() || !file_.append(line_of(head_json(table)))) fail_to_write(path_);
  for (const BenchRow& row : table.rows) append(table, row);
  std::error_code error;
  fs::rename(fs::path(folder) / kBenchRowsPart, path_, error);
  if (error) throw std::runtime_error(path_ + ": cannot be written (" + error.message() + ")");
}

void BenchRowFile::append(const BenchTable& table, const BenchRow& row) {
  std::string lines;
  if (row.environment != environment_) {
    lines =
        line_of({{"environment", table.environments[static_cast<std::size_t>(row.environment)]}});
  }
  lines += line_of(row_json(table, row));
  if (!file_.append(lines)) fail_to_write(path_);
  environment_ = row.environment;
}

BenchTable read_bench_rows(const std::string& folder) {
  const std::string path = (fs::path(folder) / kBenchRows).string();
  const char* const expected = "; expected the rows of a bench, as `prospect bench` writes them";
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) throw InputError(path + ": no such file" + expected);
  std::ifstream file(path, std::ios::binary);
  BenchTable table;
  std::string line;
  std::set<std::string> keys;
  int environment = -1;
  for (int count = 1; std::getline(file, line); ++count) {
    // Without a newline it is cut off: whatever came after it was never there.
    if (file.eof()) break;
    const std::string where = path + ":" + std::to_string(count) + ": ";
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || json.size() != 1)
      throw InputError(where + "is no such line" + expected);
    const Json::const_iterator entry = json.begin();
    const std::string& kind = entry.key();
    const Json& value = entry.value();
    try {
      if (kind == "bench" && count == 1) {
        table = table_of(value);
      } else if (kind == "environment" && count > 1 && value.is_object()) {
        environment = environment_index(table, value);
      } else if (kind == "row" && count > 1) {
        table.rows.push_back(row_of(value, table, environment));
        if (!keys.insert(words_of(table, table.rows.back())).second) {
          throw std::invalid_argument(words_of(table, table.rows.back()) + " is there twice");
        }
      } else {
        throw std::invalid_argument("'" + kind + "' does not belong there");
      }
    } catch (const std::exception& e) {
      throw InputError(where + e.what() + expected);
    }
  }
  if (table.sets.empty()) throw InputError(path + ": holds no bench" + expected);
  return table;
}

std::string differs_from(const BenchTable& earlier, const BenchTable& wanted) {
  const auto count = [](const char* what, int there, int asked) {
    return std::string(what) + ": " + std::to_string(there) + " there, " + std::to_string(asked) +
           " asked for";
  };
  if (earlier.clock != wanted.clock) {
    return "clock: " + to_string(earlier.clock) + " there, " + to_string(wanted.clock) +
           " asked for";
  }
  if (earlier.repeats != wanted.repeats) return count("repeats", earlier.repeats, wanted.repeats);
  if (earlier.max_evaluations != wanted.max_evaluations) {
    return count("evaluations at most", earlier.max_evaluations, wanted.max_evaluations);
  }
  const auto lacks = [](const auto& list, const auto& value) {
    return std::find(list.begin(), list.end(), value) == list.end();
  };
  for (const std::string& solver : earlier.solvers) {
    if (lacks(wanted.solvers, solver)) return "back end '" + solver + "' is there, not asked for";
  }
  for (const double seconds : earlier.deadlines) {
    if (lacks(wanted.deadlines, seconds)) return "another deadline is there than those asked for";
  }
  for (const int seed : earlier.seeds) {
    if (lacks(wanted.seeds, seed)) {
      return "seed " + std::to_string(seed) + " is there, not asked for";
    }
  }
  for (const ProblemSetFacts& set : earlier.sets) {
    const auto other = std::find_if(wanted.sets.begin(), wanted.sets.end(),
                                    [&](auto& s) { return s.name == set.name; });
    if (other == wanted.sets.end()) return "set '" + set.name + "' is there, not asked for";
    for (const ProblemFacts& problem : set.problems) {
      const auto same = std::find_if(other->problems.begin(), other->problems.end(),
                                     [&](auto& p) { return p.name == problem.name; });
      const std::string which = "problem '" + problem.name + "' of '" + set.name + "' ";
      if (same == other->problems.end()) return which + "is there, not asked for";
      if (same->fingerprint != problem.fingerprint) return which + "is another one there";
    }
  }
  const auto build = [](const Json& environment) {
    return environment.is_object() ? environment.value("build", Json()) : Json();
  };
  for (const Json& environment : earlier.environments) {
    for (const Json& now : wanted.environments) {
      const Json a = build(environment), b = build(now);
      if (a == b) continue;
      for (const char* key : {"version", "commit", "compiler", "flags", "build_type"}) {
        const Json there = a.is_object() ? a.value(key, Json()) : Json();
        const Json asked = b.is_object() ? b.value(key, Json()) : Json();
        if (there != asked) {
          return "the program's " + std::string(key) + " is " + there.dump() + " there, and now " +
                 asked.dump();
        }
      }
      return "the program is another build there";
    }
  }
  return "";
}

std::string take_rows(BenchTable& to, const BenchTable& from) {
  std::set<std::string> keys;
  for (const BenchRow& row : to.rows) keys.insert(words_of(to, row));
  for (const BenchRow& row : from.rows) {
    if (keys.contains(words_of(from, row))) return words_of(from, row);
  }
  const auto index = [](const auto& list, auto is) {
    return static_cast<int>(std::find_if(list.begin(), list.end(), is) - list.begin());
  };
  std::vector<int> places;
  for (const Json& environment : from.environments) {
    places.push_back(environment_index(to, environment));
  }
  for (const BenchRow& row : from.rows) {
    BenchRow taken = row;
    taken.set = index(to.sets, [&](auto& s) { return s.name == from.set_of(row).name; });
    taken.problem = index(to.sets[static_cast<std::size_t>(taken.set)].problems,
                          [&](auto& p) { return p.name == from.problem_of(row).name; });
    taken.solver = index(to.solvers, [&](auto& s) { return s == from.solver_of(row); });
    taken.environment = places[static_cast<std::size_t>(row.environment)];
    to.rows.push_back(std::move(taken));
  }
  return "";
}

}  // namespace prospect
