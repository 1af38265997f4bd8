#include "adapters/study/study_results.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>

#include "adapters/files/csv.h"
#include "adapters/files/input_error.h"
#include "adapters/run/summary.h"
#include "models/range_text.h"

namespace prospect {
namespace {

std::string number_field(double value) { return std::isfinite(value) ? exact_text(value) : ""; }

}  // namespace

std::vector<StudyRow> read_rows(const StudyPlan& plan, const CellStore& store,
                                const std::map<std::string, std::string>& other_versions) {
  std::vector<StudyRow> rows;
  for (const StudyCell& cell : plan.cells) {
    StudyRow row{&cell, cell.id, store.record(cell.id), "", {}};
    if (row.record.status != CellRecord::Status::kDone) {
      const auto other = other_versions.find(cell.id);
      if (other != other_versions.end()) {
        row.id = other->second;
        row.record = store.record(row.id);
      }
    }
    row.reason = row.record.why;
    if (row.record.status == CellRecord::Status::kDone) {
      const std::string folder = store.run_folder(row.id);
      std::ifstream in(folder + "/summary.json", std::ios::binary);
      const std::optional<Summary> summary =
          summary_from_json(std::string(std::istreambuf_iterator<char>(in), {}));
      if (!summary) fail(folder + "/summary.json", "no summary; expected that of a run");
      row.reason = summary->reason;
      row.numbers =
          mission_numbers_of_run(folder, plan.setup(cell).configuration.planner.features.N_min);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string results_csv(const StudyPlan& plan, const std::vector<StudyRow>& rows) {
  std::string table = "id,condition,world,seed";
  for (const StudyAxis& axis : plan.study.grid) table += ',' + csv::field(axis.key);
  table += ",status,reason";
  const auto numbers = [&](bool timing, const auto& add) {
    for (const MissionNumber& number : mission_number_list()) {
      if (number.timing == timing) add(number);
    }
  };
  const auto header = [&](const MissionNumber& number) { table += std::string(",") + number.name; };
  numbers(false, header);
  table += ",host,version,started,process_s";
  numbers(true, header);
  table += '\n';
  for (const StudyRow& row : rows) {
    const StudySetup& setup = plan.setup(*row.cell);
    table += row.id + ',' + csv::field(plan.condition(setup).name) + ',' +
             csv::field(plan.study.worlds[row.cell->world].name) + ',' +
             std::to_string(row.cell->seed);
    for (const std::string& value : plan.values(setup)) table += ',' + csv::field(value);
    table += ',' + to_string(row.record.status) + ',' + csv::field(row.reason);
    const auto value = [&](const MissionNumber& number) {
      table += ',' + number_field(row.numbers.*number.member);
    };
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
