// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/step_row.h"

#include <cstddef>
#include <cstdio>

#include "adapters/formats/files/csv.h"
#include "adapters/missions/run/step_fields.h"

namespace prospect {
namespace {

/// Shows each column of steps.csv in its order: visit(field, name). Fields that are one per name
/// stand name by name.
template <class Visit>
void visit_columns(const StepColumns& columns, const Visit& visit) {
  const std::span<const StepField> fields = step_fields();
  for (std::size_t i = 0; i < fields.size();) {
    const FieldPer per = fields[i].per;
    std::size_t end = i + 1;
    if (per == FieldPer::kStep) {
      if (fields[i].in(kSteps) && (columns.corrected || !fields[i].in(kCorrected))) {
        visit(fields[i], "");
      }
    } else {
      while (end < fields.size() && fields[end].per == per) ++end;
      for (const std::string& name : per == FieldPer::kTerm ? columns.terms : columns.weights) {
        for (std::size_t k = i; k < end; ++k) visit(fields[k], name);
      }
    }
    i = end;
  }
}

}  // namespace

StepColumns step_columns(const std::vector<StepRecord>& steps) {
  StepColumns columns;
  for (const StepRecord& step : steps) {
    for (const TermValue& term : step.explanation.terms) columns.terms.push_back(term.name);
    for (const TermWeight& weight : step.weights) columns.weights.push_back(weight.name);
    columns.corrected = columns.corrected || step.map_frame.has_value();
    if (!columns.empty()) break;
  }
  return columns;
}

std::string step_header(const StepColumns& columns) {
  std::string row;
  visit_columns(columns, [&](const StepField& field, const std::string& name) {
    if (!row.empty()) row += ',';
    row += csv::field(std::string(field.name) + (name.empty() ? "" : '_' + name));
  });
  return row + '\n';
}

std::string step_row(const StepRecord& step, const StepColumns& columns) {
  std::string row;
  visit_columns(columns, [&](const StepField& field, const std::string& name) {
    if (!row.empty()) row += ',';
    row += csv::field(text_of(field.of(step, name)));
  });
  return row + '\n';
}

std::string timing_header() {
  std::string row;
  for (const StepField& field : step_fields()) {
    if (field.in(kTiming)) row += (row.empty() ? "" : ",") + std::string(field.name);
  }
  return row + '\n';
}

std::string timing_row(const StepRecord& step) {
  std::string row = std::to_string(step.step);
  for (const StepField& field : step_fields()) {
    if (!field.in(kTiming) || field.in(kSteps)) continue;
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, ",%.3f", number_of(field.of(step, "")));
    row += buffer;
  }
  return row + '\n';
}

}  // namespace prospect
