// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace prospect {

/// A tree of groups that hold attributes (single values and short vectors) and datasets (arrays),
/// either being written or being read. What a file looks like is said once, by a function that
/// hands every entry to an Archive: a writing one takes the entry's value, a reading one sets it.
///
/// Each entry is checked in both directions, so that what was written can be read; a wrong one
/// throws std::invalid_argument, "/group: what; expected what".
class Archive {
 public:
  using Shape = std::vector<std::size_t>;
  enum class Type { kFloat64, kInt64, kUInt64, kUInt8 };

  /// Largest magnitude of any number that has no range of its own.
  static constexpr double kLargest = 1e12;

  virtual ~Archive() = default;
  virtual bool writing() const = 0;

  /// The entries that `content` hands over lie in this group.
  void group(const std::string& name, const std::function<void()>& content);
  /// The same for the entries up to end_group().
  void begin_group(const std::string& name);
  void end_group();
  /// The same for a group that may be missing. Writing: `present` says whether it is. Reading: sets
  /// it.
  void optional_group(const std::string& name, bool& present, const std::function<void()>& content);

  // Attributes.
  void number(const char* name, double& value, double min = -kLargest, double max = kLargest);
  void integer(const char* name, int& value, int min, int max);
  void natural(const char* name, std::uint64_t& value);
  void flag(const char* name, bool& value);  ///< stored as 0 or 1
  void text(const char* name, std::string& value);
  /// An enumeration, stored as the name at its place in `names`.
  template <typename Enum>
  void choice(const char* name, Enum& value, const std::vector<std::string>& names) {
    value = static_cast<Enum>(choose(name, static_cast<std::size_t>(value), names));
  }
  /// Fixed shape, row-major.
  void numbers(const char* name, double* values, const Shape& shape);
  void integers(const char* name, int* values, std::size_t count, int min, int max);
  void vector(const char* name, Eigen::VectorXd& values, Eigen::Index size);

  // Datasets.
  /// The shape of a dataset. Writing: `known`. Reading: that of the file, of the same rank and with
  /// at most `most` elements in all.
  Shape shape(const char* name, const Shape& known, std::size_t most);
  void array(const char* name, std::vector<double>& values, const Shape& shape);
  void array(const char* name, std::vector<std::uint64_t>& values, const Shape& shape);
  /// Values up to `largest`.
  void array(const char* name, std::vector<std::uint8_t>& values, const Shape& shape,
             std::uint8_t largest);
  /// A list of names.
  void texts(const char* name, std::vector<std::string>& values, std::size_t count);

  /// Throws for the entry `name` ("": the group) of the present group.
  [[noreturn]] void refuse(std::string_view name, const std::string& what,
                           const std::string& expected) const;
  /// what: "what; expected what".
  [[noreturn]] void refuse(std::string_view name, const std::string& what) const;

 protected:
  /// Longest text that is written or read [bytes].
  static constexpr std::size_t kLongest = 4096;

  /// "float64[3, 3]"; without a shape, a single value.
  static std::string describe(Type type, const Shape& shape);
  static std::size_t size_of(Type type);
  static std::size_t elements(const Shape& shape);

  // One entry of the present group; `data` is read or filled.
  virtual void attribute(const char* name, Type type, const Shape& shape, void* data) = 0;
  virtual void text_attribute(const char* name, std::string& value) = 0;
  virtual void dataset(const char* name, Type type, const Shape& shape, void* data) = 0;
  virtual void text_dataset(const char* name, std::vector<std::string>& values) = 0;
  virtual Shape dataset_shape(const char* name, std::size_t rank) = 0;
  virtual void enter(const std::string& name) = 0;
  virtual void leave() = 0;
  virtual bool has_group(const std::string& name) = 0;

 private:
  std::size_t choose(const char* name, std::size_t value, const std::vector<std::string>& names);
  void check(const char* name, double value, double min, double max) const;

  std::vector<std::string> place_;
};

}  // namespace prospect
