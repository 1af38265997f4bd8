// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

/// A number that cells are compared by: how it is called in tables, and shown.
struct StudyNumber {
  const char* name;    ///< the column of results.csv
  const char* label;   ///< with its unit, as shown
  double scale;        ///< what is shown is so many times the number
  int digits;          ///< behind the point
  bool ratio;          ///< of positive numbers; one with a sign has none
  bool timing;         ///< of the machine: differs between two runs of one cell
  bool chief = false;  ///< of those few that stand in the box plots and in the ratios by input
};

}  // namespace prospect
