// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_results.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>

#include "adapters/formats/files/csv.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/bench_merge.h"
#include "adapters/missions/bench/bench_rows.h"
#include "adapters/missions/run/summary.h"
#include "adapters/missions/study/mission_numbers.h"
#include "adapters/missions/study/solve_numbers.h"
#include "models/range_text.h"

namespace prospect {
namespace {

std::string number_field(double value) { return std::isfinite(value) ? exact_text(value) : ""; }

StudyRow mission_row(const StudyPlan& plan, const CellStore& store, const StudyCell& cell,
                     const std::map<std::string, std::string>& other_versions) {
  StudyRow row{&cell, "", cell.id, store.record(cell.id), "", {}};
  if (row.record.status != CellRecord::Status::kDone) {
    const auto other = other_versions.find(cell.id);
    if (other != other_versions.end()) {
      row.id = other->second;
      row.record = store.record(row.id);
    }
  }
  row.reason = row.record.why;
  if (row.record.status != CellRecord::Status::kDone) return row;
  const std::string folder = store.run_folder(row.id);
  std::ifstream in(folder + "/summary.json", std::ios::binary);
  const std::optional<Summary> summary =
      summary_from_json(std::string(std::istreambuf_iterator<char>(in), {}));
  if (!summary) fail(folder + "/summary.json", "no summary; expected that of a run");
  row.reason = to_string(summary->end);
  row.numbers = values_of(
      mission_numbers_of_run(folder, plan.setup(cell).configuration.planner.features.N_min));
  return row;
}

/// All benches that are done as one table, judged; a setup stands as a back end, by its label.
BenchTable merged_cells(const StudyPlan& plan, const CellStore& store,
                        const std::vector<CellRecord>& records) {
  BenchTable merged;
  merged.seeds.clear();
  merged.deadlines.clear();
  for (const StudySetup& setup : plan.setups) merged.solvers.push_back(plan.label(setup));
  for (std::size_t c = 0; c < plan.cells.size(); ++c) {
    if (records[c].status != CellRecord::Status::kDone) continue;
    const StudyCell& cell = plan.cells[c];
    const std::string folder = store.run_folder(cell.id);
    BenchTable part = read_bench_rows(folder);
    if (part.sets.size() != 1 || part.solvers.size() != 1) {
      fail(folder, "is no bench of one set by one back end; expected that of a cell");
    }
    part.sets.front().name = plan.study.inputs[cell.input].name;
    part.solvers.front() = merged.solvers[cell.setup];
    add_problems(merged, part, folder);
    take_rows(merged, part);
  }
  judge(merged);
  return merged;
}

std::vector<StudyRow> solve_rows(const StudyPlan& plan, const CellStore& store) {
  std::vector<CellRecord> records;
  for (const StudyCell& cell : plan.cells) records.push_back(store.record(cell.id));
  const BenchTable table = merged_cells(plan, store, records);
  using Key = std::tuple<std::string, std::string, std::string, int>;
  std::map<Key, const BenchRow*> solves;
  for (const BenchRow& row : table.rows) {
    solves.emplace(
        Key(table.solver_of(row), table.set_of(row).name, table.problem_of(row).name, row.seed),
        &row);
  }
  std::vector<StudyRow> rows;
  for (std::size_t c = 0; c < plan.cells.size(); ++c) {
    const StudyCell& cell = plan.cells[c];
    for (const std::string& problem : plan.problems[cell.input]) {
      StudyRow row{&cell, problem, cell.id, records[c], records[c].why, {}};
      const auto solve =
          solves.find({plan.label(plan.setup(cell)), plan.study.inputs[cell.input].name, problem,
                       static_cast<int>(cell.seed)});
      if (solve != solves.end()) {
        const BenchRow& solved = *solve->second;
        row.reason = solved.supported ? to_string(solved.stop) : "not supported";
        row.numbers = values_of(solved);
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace

const std::vector<StudyNumber>& study_numbers(Study::Kind kind) {
  static const std::vector<StudyNumber> of_missions = [] {
    std::vector<StudyNumber> numbers;
    for (const MissionNumber& number : mission_number_list()) numbers.push_back(number.number);
    return numbers;
  }();
  return kind == Study::Kind::kBenches ? solve_number_list() : of_missions;
}

double value_of(const StudyRow& row, std::size_t number) {
  return number < row.numbers.size() ? row.numbers[number]
                                     : std::numeric_limits<double>::quiet_NaN();
}

std::vector<StudyRow> read_rows(const StudyPlan& plan, const CellStore& store,
                                const std::map<std::string, std::string>& other_versions) {
  if (plan.study.kind == Study::Kind::kBenches) return solve_rows(plan, store);
  std::vector<StudyRow> rows;
  for (const StudyCell& cell : plan.cells) {
    rows.push_back(mission_row(plan, store, cell, other_versions));
  }
  return rows;
}

std::string results_csv(const StudyPlan& plan, const std::vector<StudyRow>& rows) {
  const bool benches = plan.study.kind == Study::Kind::kBenches;
  std::string table = benches ? "id,condition,set,problem,seed" : "id,condition,world,seed";
  for (const StudyAxis& axis : plan.study.grid) table += ',' + csv::field(axis.key);
  table += ",status,reason";
  const std::vector<StudyNumber>& all = study_numbers(plan.study.kind);
  const auto numbers = [&](bool timing, const auto& add) {
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (all[n].timing == timing) add(n);
    }
  };
  const auto header = [&](std::size_t n) { table += std::string(",") + all[n].name; };
  numbers(false, header);
  table += ",host,version,started,process_s";
  numbers(true, header);
  table += '\n';
  for (const StudyRow& row : rows) {
    const StudySetup& setup = plan.setup(*row.cell);
    table += row.id + ',' + csv::field(plan.condition(setup).name) + ',' +
             csv::field(plan.study.inputs[row.cell->input].name) + ',' +
             (benches ? csv::field(row.problem) + ',' : "") + std::to_string(row.cell->seed);
    for (const std::string& value : plan.values(setup)) table += ',' + csv::field(value);
    table += ',' + to_string(row.record.status) + ',' + csv::field(row.reason);
    const auto value = [&](std::size_t n) { table += ',' + number_field(value_of(row, n)); };
    numbers(false, value);
    table += ',' + csv::field(row.record.host) + ',' + csv::field(row.record.version) + ',' +
             csv::field(row.record.started) + ',' +
             (row.record.wall_s > 0.0 ? number_field(row.record.wall_s) : "");
    numbers(true, value);
    table += '\n';
  }
  return table;
}

}  // namespace prospect
