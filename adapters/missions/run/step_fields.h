// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "adapters/missions/run/run_record.h"

namespace prospect {

// The one table of what is told of a planning step. steps.csv, timing.csv, the messages of
// mission.mcap, the report, the live page and the table of docs/reference/report.md come from it.

/// none: the step lacks it. A word or a sentence is a text; a word that is not known is "".
using StepValue = std::variant<std::monostate, bool, int, double, std::string>;

/// As it stands in a table: numbers as the shortest text that reads back exactly, a flag as 1 or 0,
/// "" for none.
std::string text_of(const StepValue& value);
/// NaN for none and for a text.
double number_of(const StepValue& value);

enum class FieldType {
  kInteger,
  kNumber,
  kFlag,
  kWord,  ///< of an enumeration
  kText
};

/// Which tables a field is a column of.
enum StepTables : unsigned {
  kSteps = 1,     ///< steps.csv
  kTiming = 2,    ///< timing.csv
  kPage = 4,      ///< report and live page
  kCorrected = 8  ///< with kSteps: only of a run whose map may be corrected
};

/// Whether there is one of a field, or one for each name.
enum class FieldPer { kStep, kTerm, kWeight };

/// A field of a step.
struct StepField {
  std::string_view name;  ///< of its column and its entry; per name what stands before that
  std::string_view unit;  ///< "" for a pure number
  FieldType type;
  FieldPer per;
  unsigned tables;  ///< StepTables
  /// Its place among the entries of the log's message, from 1; 0: it is none of those. Terms and
  /// weights follow them.
  int log_place;
  std::string_view sentence;  ///< what it means, as the reference page has it

  /// Its value. name: of the term, where it is one per term or weight.
  StepValue (*of)(const StepRecord& step, std::string_view name);
  /// Enters what text_of() gave. False: the text is no such value.
  bool (*enter)(StepRecord& step, std::string_view name, const std::string& text);
  /// Of a word: those that there are.
  std::vector<std::string_view> (*words)();

  bool in(StepTables table) const { return (tables & table) != 0; }
  bool holds_text() const { return type == FieldType::kWord || type == FieldType::kText; }
};

/// All of them, in the order of steps.csv, then those of timing.csv.
std::span<const StepField> step_fields();

/// The field that a column of steps.csv or timing.csv holds, and the name that it is of; null: no
/// field of this program.
std::pair<const StepField*, std::string> field_of_column(const std::string& column);

/// Enters a field's text. Throws InputError "WHERE: NAME is 'TEXT'; expected ..." where it is none.
void enter_field(const StepField& field, const std::string& name, const std::string& text,
                 const std::string& where, StepRecord& step);

/// The columns of steps.csv as a table in Markdown, those of one sentence in a row. The reference
/// page holds it.
std::string step_field_table();

}  // namespace prospect
