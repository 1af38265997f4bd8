// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/problem_file/archive.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace prospect {
namespace {

std::string brief(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

}  // namespace

void Archive::refuse(std::string_view name, const std::string& what,
                     const std::string& expected) const {
  refuse(name, what + "; expected " + expected);
}

void Archive::refuse(std::string_view name, const std::string& what) const {
  std::string where;
  for (const std::string& group : place_) where += '/' + group;
  if (!name.empty()) where += '/' + std::string(name);
  throw std::invalid_argument((where.empty() ? "/" : where) + ": " + what);
}

std::string Archive::describe(Type type, const Shape& shape) {
  std::string text = type == Type::kFloat64  ? "float64"
                     : type == Type::kInt64  ? "int64"
                     : type == Type::kUInt64 ? "uint64"
                                             : "uint8";
  if (shape.empty()) return text;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    text += (i == 0 ? "[" : ", ") + std::to_string(shape[i]);
  }
  return text + "]";
}

std::size_t Archive::size_of(Type type) { return type == Type::kUInt8 ? 1 : 8; }

std::size_t Archive::elements(const Shape& shape) {
  std::size_t product = 1;
  for (const std::size_t n : shape) product *= n;
  return product;
}

void Archive::group(const std::string& name, const std::function<void()>& content) {
  begin_group(name);
  content();
  end_group();
}

void Archive::begin_group(const std::string& name) {
  enter(name);
  place_.push_back(name);
}

void Archive::end_group() {
  leave();
  place_.pop_back();
}

void Archive::optional_group(const std::string& name, bool& present,
                             const std::function<void()>& content) {
  if (!writing()) present = has_group(name);
  if (present) group(name, content);
}

void Archive::check(const char* name, double value, double min, double max) const {
  if (value >= min && value <= max) return;
  refuse(name, "is " + brief(value), "a number from " + brief(min) + " to " + brief(max));
}

void Archive::number(const char* name, double& value, double min, double max) {
  if (writing()) check(name, value, min, max);
  attribute(name, Type::kFloat64, {}, &value);
  if (!writing()) check(name, value, min, max);
}

void Archive::integer(const char* name, int& value, int min, int max) {
  std::int64_t stored = value;
  attribute(name, Type::kInt64, {}, &stored);
  if (stored < min || stored > max) {
    refuse(name, "is " + std::to_string(stored),
           "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  }
  value = static_cast<int>(stored);
}

void Archive::natural(const char* name, std::uint64_t& value) {
  attribute(name, Type::kUInt64, {}, &value);
}

void Archive::flag(const char* name, bool& value) {
  int stored = value ? 1 : 0;
  integer(name, stored, 0, 1);
  value = stored != 0;
}

void Archive::text(const char* name, std::string& value) {
  if (writing()) {
    value.resize(std::min(value.size(), kLongest));
    // Where a reader would see its end.
    value.resize(std::min(value.size(), value.find('\0')));
  }
  text_attribute(name, value);
}

std::size_t Archive::choose(const char* name, std::size_t value,
                            const std::vector<std::string>& names) {
  std::string stored = writing() && value < names.size() ? names[value] : "";
  text(name, stored);
  const auto at = std::find(names.begin(), names.end(), stored);
  if (at == names.end()) {
    std::string list;
    for (const std::string& n : names) list += (list.empty() ? "" : ", ") + n;
    refuse(name, "is '" + stored + "'", "one of: " + list);
  }
  return static_cast<std::size_t>(at - names.begin());
}

void Archive::numbers(const char* name, double* values, const Shape& shape) {
  const std::size_t count = elements(shape);
  const auto check_all = [&] {
    for (std::size_t i = 0; i < count; ++i) check(name, values[i], -kLargest, kLargest);
  };
  if (writing()) check_all();
  attribute(name, Type::kFloat64, shape, values);
  if (!writing()) check_all();
}

void Archive::integers(const char* name, int* values, std::size_t count, int min, int max) {
  std::vector<std::int64_t> stored(values, values + count);
  attribute(name, Type::kInt64, {count}, stored.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (stored[i] < min || stored[i] > max) {
      refuse(name, "holds " + std::to_string(stored[i]),
             "whole numbers from " + std::to_string(min) + " to " + std::to_string(max));
    }
    values[i] = static_cast<int>(stored[i]);
  }
}

void Archive::vector(const char* name, Eigen::VectorXd& values, Eigen::Index size) {
  if (!writing()) values.setZero(size);
  if (values.size() != size) {
    refuse(name, "has " + std::to_string(values.size()) + " entries", std::to_string(size));
  }
  numbers(name, values.data(), {static_cast<std::size_t>(size)});
}

Archive::Shape Archive::shape(const char* name, const Shape& known, std::size_t most) {
  const Shape shape = writing() ? known : dataset_shape(name, known.size());
  std::size_t left = most;
  for (const std::size_t n : shape) {
    if (n == 0) return shape;
    left /= n;
  }
  if (left == 0) {
    std::string sizes;
    for (const std::size_t n : shape) sizes += (sizes.empty() ? "" : " x ") + std::to_string(n);
    refuse(name, "holds " + sizes + " elements", "at most " + std::to_string(most));
  }
  return shape;
}

void Archive::array(const char* name, std::vector<double>& values, const Shape& shape) {
  if (!writing()) values.assign(elements(shape), 0.0);
  const auto check_all = [&] {
    for (const double v : values) check(name, v, -kLargest, kLargest);
  };
  if (writing()) check_all();
  dataset(name, Type::kFloat64, shape, values.data());
  if (!writing()) check_all();
}

void Archive::array(const char* name, std::vector<std::uint64_t>& values, const Shape& shape) {
  if (!writing()) values.assign(elements(shape), 0);
  dataset(name, Type::kUInt64, shape, values.data());
}

void Archive::array(const char* name, std::vector<std::uint8_t>& values, const Shape& shape,
                    std::uint8_t largest) {
  if (!writing()) values.assign(elements(shape), 0);
  dataset(name, Type::kUInt8, shape, values.data());
  const auto above =
      std::find_if(values.begin(), values.end(), [&](std::uint8_t v) { return v > largest; });
  if (above != values.end()) {
    refuse(name, "holds " + std::to_string(*above), "values from 0 to " + std::to_string(largest));
  }
}

void Archive::texts(const char* name, std::vector<std::string>& values, std::size_t count) {
  values.resize(count);
  text_dataset(name, values);
}

}  // namespace prospect
