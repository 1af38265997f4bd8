// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_files.h"

#include <filesystem>
#include <map>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/missions/study/other_versions.h"
#include "adapters/missions/study/steps_file.h"
#include "adapters/missions/study/study_comparison.h"
#include "adapters/missions/study/study_figures.h"
#include "adapters/missions/study/study_page.h"
#include "adapters/missions/study/study_results.h"

namespace prospect {

StudyFiles write_study(const StudyPlan& plan, const CellStore& store, const Registries& registries,
                       const StudyGathering& gathering) {
  namespace fs = std::filesystem;
  if (plan.study.kind == Study::Kind::kBenches && (gathering.steps || gathering.any_version)) {
    fail(plan.study.file, gathering.steps
                              ? "solves problems, which have no steps; expected no --steps"
                              : "solves problems; expected no --any-version, but `prospect bench "
                                "compare` of two cells");
  }
  StudyFiles result;
  OutputFolder folder = OutputFolder::shared(store.folder(), {"study"});
  const auto write = [&](const fs::path& name, const std::string& content) {
    const fs::path file = fs::path(store.folder()) / name;
    const std::string wrong = folder.write(name.string(), content);
    if (!wrong.empty()) {
      fail(file.string(), "cannot be written (" + wrong + "); expected a writable folder");
    }
    result.files.push_back(file.string());
  };
  const std::vector<StudyRow> rows =
      read_rows(plan, store,
                gathering.any_version ? other_versions(plan, store, registries)
                                      : std::map<std::string, std::string>{});
  for (const StudyRow& row : rows) {
    result.done += row.record.status == CellRecord::Status::kDone;
    result.of_other_versions += row.id != row.cell->id;
    result.failed += row.record.status == CellRecord::Status::kFailed;
    result.missing += row.record.status == CellRecord::Status::kMissing;
  }
  write("results.csv", results_csv(plan, rows));
  const std::vector<StudyComparison> comparisons = compare_setups(plan, rows);
  const std::vector<StudyFigure> figures =
      study_figures(plan, store, rows, comparisons, registries);
  for (const StudyFigure& figure : figures) {
    for (const std::string& format : gathering.formats) {
      write(fs::path("figures") / (figure.name + '.' + format), written(figure.drawing, format));
    }
  }
  write("study.html", study_page(plan, rows, comparisons, figures));
  if (gathering.steps) {
    result.files.push_back(folder.claim("steps.h5"));
    write_steps(plan, store, rows, result.files.back());
  }
  return result;
}

}  // namespace prospect
