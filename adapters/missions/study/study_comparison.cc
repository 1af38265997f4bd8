// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>

#include "adapters/missions/study/signed_rank_test.h"

namespace prospect {
namespace {

/// Not a number without values; the mean of the two in the middle of an even number.
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? NumberComparison::kNone : 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

NumberComparison compare(const std::vector<std::pair<const StudyRow*, const StudyRow*>>& pairs,
                         const std::vector<StudyNumber>& numbers, std::size_t which) {
  const StudyNumber& number = numbers[which];
  NumberComparison c;
  c.number = &number;
  std::vector<double> first, second, difference;
  for (const auto& [reference, other] : pairs) {
    const double a = number.scale * value_of(*reference, which);
    const double b = number.scale * value_of(*other, which);
    const bool has_a = std::isfinite(a), has_b = std::isfinite(b);
    c.only_reference += has_a && !has_b;
    c.only_other += !has_a && has_b;
    if (!has_a || !has_b) continue;
    first.push_back(a);
    second.push_back(b);
    difference.push_back(b - a);
  }
  c.pairs = static_cast<int>(first.size());
  if (first.empty()) return c;
  c.median_reference = median(first);
  c.median_other = median(second);
  const auto vector = [&](const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), c.pairs);
  };
  const ResampledMeans means(c.pairs, 4000);
  c.difference = means.interval(vector(difference));
  if (number.ratio) c.ratio = means.ratio(vector(first), vector(second));
  c.p = signed_rank_test(difference).p;
  return c;
}

void compare_numbers(const StudyPlan& plan, StudyComparison& c) {
  const std::vector<StudyNumber>& numbers = study_numbers(plan.study.kind);
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    c.numbers.push_back(compare(c.pairs, numbers, n));
  }
}

/// What two setups have alike, without the axis `but` (-1: without the condition).
std::string alike(const StudyPlan& plan, const StudySetup& setup, int but) {
  std::string text = but < 0 ? "" : plan.condition(setup).name;
  const std::vector<std::string> values = plan.values(setup);
  for (std::size_t a = 0; a < values.size(); ++a) {
    if (static_cast<int>(a) == but) continue;
    text += (text.empty() ? "" : ", ") + plan.study.grid[a].key + "=" + values[a];
  }
  return text;
}

}  // namespace

std::vector<StudyComparison> compare_setups(const StudyPlan& plan,
                                            const std::vector<StudyRow>& rows) {
  using Key = std::tuple<std::size_t, std::size_t, std::string, std::uint64_t>;
  std::map<Key, const StudyRow*> done;
  for (const StudyRow& row : rows) {
    if (row.record.status != CellRecord::Status::kDone) continue;
    done.emplace(Key(row.cell->setup, row.cell->input, row.problem, row.cell->seed), &row);
  }
  std::map<std::pair<std::size_t, std::vector<std::size_t>>, std::size_t> index;
  for (std::size_t s = 0; s < plan.setups.size(); ++s) {
    index[{plan.setups[s].condition, plan.setups[s].values}] = s;
  }
  std::vector<StudyComparison> comparisons;
  const auto add = [&](std::size_t reference, std::size_t other, std::string label,
                       std::string among) {
    StudyComparison c{reference, other, std::move(label), std::move(among), "", {}, {}};
    for (const StudyRow& row : rows) {
      if (row.cell->setup != other || row.record.status != CellRecord::Status::kDone) continue;
      const auto found = done.find({reference, row.cell->input, row.problem, row.cell->seed});
      if (found != done.end()) c.pairs.emplace_back(found->second, &row);
    }
    if (c.pairs.empty()) return;
    compare_numbers(plan, c);
    comparisons.push_back(std::move(c));
  };
  for (std::size_t s = 0; s < plan.setups.size(); ++s) {
    const StudySetup& setup = plan.setups[s];
    if (setup.condition == 0) continue;
    add(index.at({0, setup.values}), s,
        plan.condition(setup).name + " / " + plan.study.conditions[0].name, alike(plan, setup, -1));
  }
  for (std::size_t a = 0; a < plan.study.grid.size(); ++a) {
    const StudyAxis& axis = plan.study.grid[a];
    for (std::size_t s = 0; s < plan.setups.size(); ++s) {
      const StudySetup& setup = plan.setups[s];
      if (setup.values[a] == 0) continue;
      std::vector<std::size_t> values = setup.values;
      values[a] = 0;
      add(index.at({setup.condition, values}), s,
          axis.key + " " + axis.values[setup.values[a]].value + " / " + axis.values[0].value,
          alike(plan, setup, static_cast<int>(a)));
    }
  }
  return comparisons;
}

std::vector<StudyComparison> by_input(const StudyPlan& plan, const StudyComparison& comparison) {
  std::map<std::size_t, StudyComparison> parts;
  for (const auto& pair : comparison.pairs) {
    const std::size_t input = pair.first->cell->input;
    parts
        .try_emplace(input, StudyComparison{comparison.reference,
                                            comparison.other,
                                            comparison.label,
                                            comparison.among,
                                            plan.study.inputs[input].name,
                                            {},
                                            {}})
        .first->second.pairs.push_back(pair);
  }
  std::vector<StudyComparison> all;
  if (parts.size() < 2) return all;
  for (auto& [input, part] : parts) {
    compare_numbers(plan, part);
    all.push_back(std::move(part));
  }
  return all;
}

}  // namespace prospect
