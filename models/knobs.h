// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace prospect {

/// What can be set of a structure of options, told once. Beside the structure stands a function
///
///   void describe(Knobs& knobs, FrontierOrderOptions& o) {
///     knobs.number("horizon", o.horizon, {0.1, 1e4}, "m", "of way in which ... loses a factor of
///     e");
///   }
///
/// that hands over name, range, unit and one sentence of each value; the default is what a new
/// structure holds. Who needs any of it calls that function with a Knobs of its own: constructors
/// with one that checks (check_knobs()), configuration files and problem files with one that reads,
/// the reference with one that lists. Values that something else fills in are no knobs.
///
/// describe() calls the same functions in the same order whatever the values are, so that all
/// readers see the same knobs. Names are unique in their group.
class Knobs {
 public:
  /// Both ends belong to it; an infinite end is none.
  struct Range {
    double min, max;
  };
  struct WholeRange {
    int min, max;
  };

  virtual ~Knobs() = default;

  /// A finite number, or an infinite one where the range has no end. unit: "m", "1/s"; "1": none.
  virtual void number(const char* name, double& value, Range range, const char* unit,
                      const char* sentence) = 0;
  /// The same for an angle [rad] that people are told and tell in degrees. A milliradian too much
  /// is taken for rounding where the number in rad is what is given.
  virtual void degrees(const char* name, double& radians, Range range, const char* sentence) = 0;
  virtual void integer(const char* name, int& value, WholeRange range, const char* unit,
                       const char* sentence) = 0;
  virtual void boolean(const char* name, bool& value, const char* sentence) = 0;
  /// Several numbers that belong together, such as the coordinates of a point.
  virtual void numbers(const char* name, double* values, std::size_t count, Range range,
                       const char* unit, const char* sentence) = 0;
  /// words: of the enumeration's values 0, 1, 2 ...
  template <typename Enum>
  void choice(const char* name, Enum& value, std::initializer_list<const char*> words,
              const char* sentence) {
    auto index = static_cast<std::size_t>(value);
    word(name, index, {words.begin(), words.end()}, sentence);
    value = static_cast<Enum>(index);
  }

  /// What `content` describes lies in the group `name`.
  template <typename Content>
  void group(const char* name, Content content) {
    enter(name);
    content();
    leave();
  }

  /// What several values must agree in: unless `holds`, what is wrong with the one called `name`,
  /// "more knots than stages; expected at most N". After the values that it is about.
  virtual void require(bool holds, const char* name, const char* what) = 0;

 protected:
  virtual void word(const char* name, std::size_t& index, const std::vector<std::string>& words,
                    const char* sentence) = 0;
  virtual void enter(const char* name) = 0;
  virtual void leave() = 0;
};

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;

/// Checks what is described.
class KnobCheck final : public Knobs {
 public:
  /// owner: whose options they are, for messages.
  explicit KnobCheck(std::string_view owner) : owner_(owner) {}

  void number(const char* name, double& value, Range range, const char* unit,
              const char* sentence) override;
  void degrees(const char* name, double& radians, Range range, const char* sentence) override;
  void integer(const char* name, int& value, WholeRange range, const char* unit,
               const char* sentence) override;
  void boolean(const char*, bool&, const char*) override {}
  void numbers(const char* name, double* values, std::size_t count, Range range, const char* unit,
               const char* sentence) override;
  void require(bool holds, const char* name, const char* what) override;

 private:
  void word(const char* name, std::size_t& index, const std::vector<std::string>& words,
            const char* sentence) override;
  void enter(const char* name) override { groups_.push_back(name); }
  void leave() override { groups_.pop_back(); }
  /// "owner: group.name"
  std::string subject(const char* name) const;

  std::string_view owner_;
  std::vector<const char*> groups_;
};

/// Throws std::invalid_argument at the first of the described values that is out of its range or
/// does not agree with the others: "frontier order: horizon is nan; expected a number from 0.1 to
/// 10000 m", "planner: M: more knots than stages; expected at most N".
template <typename Options>
void check_knobs(std::string_view owner, const Options& options) {
  Options copy = options;  // describe() may set
  KnobCheck check(owner);
  describe(check, copy);
}

}  // namespace prospect
