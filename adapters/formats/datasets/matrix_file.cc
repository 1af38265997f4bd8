// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/matrix_file.h"

#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"

namespace prospect {

Eigen::MatrixXd read_matrix(const std::string& path, int rows, int columns,
                            const std::string& expected, bool finite) {
  Eigen::MatrixXd matrix(rows, columns);
  std::istringstream text(read_whole_file(path));
  std::string line, word;
  int row = 0;
  for (int n = 1; std::getline(text, line); ++n) {
    for (char& c : line) {
      if (c == ',') c = ' ';
    }
    std::istringstream words(line);
    std::vector<double> numbers;
    bool good = true;
    while (words >> word) {
      double value = 0.0;
      good = good && parse_number(word, value) && (!finite || std::isfinite(value));
      numbers.push_back(value);
    }
    if (numbers.empty()) continue;
    if (row == rows || !good || static_cast<int>(numbers.size()) != columns) {
      throw InputError(path + ":" + std::to_string(n) + ": not a row of it; expected " + expected);
    }
    for (int c = 0; c < columns; ++c) matrix(row, c) = numbers[static_cast<std::size_t>(c)];
    ++row;
  }
  if (row < rows) {
    throw InputError(path + ": ends after " + std::to_string(row) + " rows; expected " + expected);
  }
  return matrix;
}

}  // namespace prospect
