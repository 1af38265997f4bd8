// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect {

/// One setting as it is in effect: read from the file, or its default.
struct ConfigEntry {
  std::string path;           ///< "planner.dt", "rooms[2].name"
  std::string value;          ///< as YAML, numbers in their shortest exact form
  std::string default_value;  ///< as YAML; "" for a required entry
  std::string unit;           ///< "m", "m/s", "1" for a pure number, "" for text and switches
  std::string range;          ///< what it may be: "0 to 5", "free, blocked", "3 numbers, -5 to 5"
  std::string description;
  std::vector<std::string> words{};  ///< of a choice or switch: all that it may be
  bool from_file = false;            ///< or by StrictYaml::set()
  bool set = false;                  ///< by StrictYaml::set()
  std::string where{};               ///< who tells it: "file:line", "--set key=value"; "": nobody
};

/// All entries as one YAML text, nested by path, each with `# description [unit]` and, where it
/// differs, the default. Reading the text again gives the same configuration.
std::string effective_yaml(const std::vector<ConfigEntry>& entries);

class StrictYaml;

/// A value that stands above what a document says.
struct YamlSetting {
  /// "planner.weights.w_l=0": a scalar, a list or a mapping, as YAML on one line; `~`: the default.
  YamlSetting(std::string key_and_value, std::string said_by = "")
      : assignment(std::move(key_and_value)), where(std::move(said_by)) {}
  YamlSetting(const char* key_and_value) : YamlSetting(std::string(key_and_value)) {}

  std::string assignment;
  std::string where;         ///< who says it, for messages; "": `--set ASSIGNMENT`
  bool unless_told = false;  ///< below what the document says
};

/// A text of any characters as YAML on one line.
std::string yaml_text(const std::string& text);

/// A key or mapping of a document that has another name now, by their paths: "drive.odometry".
struct RenamedKey {
  std::string before, now;
};

/// A key that is no more. Files that were written with its default still hold it.
struct GoneKey {
  std::string before;  ///< its path
  std::string value;   ///< its default, as it was written
  std::string why;     ///< what does its work now, a clause
};

/// A value of any kind, as a document holds it.
struct YamlValue {
  std::string yaml;   ///< on one line, as StrictYaml::set() takes it
  std::string text;   ///< of a scalar; "" of a list or mapping
  std::string where;  ///< file:line
  bool is_scalar = false;
};

/// A view of one mapping of a document. Every key must be asked for: what finish() of the document
/// finds unread is unknown and an error. A reader never throws: each problem is recorded
/// (`file:line: what; expected what`), the default is returned in its place (the lower end of the
/// range for a required number), and StrictYaml::finish() throws all problems at once, at most
/// 100 of them in full.
///
/// A view of an absent mapping is empty and serves defaults; asking for a required key of it is an
/// error. Views are small and copyable and must not outlive the document.
class YamlMap {
 public:
  bool has(const std::string& key) const;
  /// False for the view of a mapping that the file does not hold.
  bool present() const;
  /// `file:line` of the key, or of the mapping if the key is absent: for the caller's own messages.
  std::string where(const std::string& key = "") const;
  /// Path of this mapping in the document, "" for the root.
  const std::string& path() const { return path_; }

  /// A finite number in [min, max]. Decimal point, no separators, no quotes; `1e-3` is fine; nan
  /// and inf are errors. The default may lie outside the range (say, "not set").
  double number(const std::string& key, double default_value, double min, double max,
                const std::string& unit, const std::string& description);
  double required_number(const std::string& key, double min, double max, const std::string& unit,
                         const std::string& description);
  std::int64_t integer(const std::string& key, std::int64_t default_value, std::int64_t min,
                       std::int64_t max, const std::string& unit, const std::string& description);
  /// `true` or `false`, nothing else.
  bool boolean(const std::string& key, bool default_value, const std::string& description);
  /// A switch as YAML of other programs spells it: 0, 1, true, false, yes, no, on, off, in any
  /// case.
  bool loose_boolean(const std::string& key, bool default_value, const std::string& description);
  /// Any scalar that is not empty, as text.
  std::string text(const std::string& key, const std::string& default_value,
                   const std::string& description);
  std::string required_text(const std::string& key, const std::string& description);
  /// One of `choices`.
  std::string choice(const std::string& key, const std::string& default_value,
                     const std::vector<std::string>& choices, const std::string& description);
  /// The same in any case, as other programs read it.
  std::string loose_choice(const std::string& key, const std::string& default_value,
                           const std::vector<std::string>& choices, const std::string& description);
  std::string required_choice(const std::string& key, const std::vector<std::string>& choices,
                              const std::string& description);
  /// A list of numbers, each in [min, max], of `size` entries (any number of entries for size < 0).
  std::vector<double> numbers(const std::string& key, const std::vector<double>& default_value,
                              int size, double min, double max, const std::string& unit,
                              const std::string& description);
  std::vector<double> required_numbers(const std::string& key, int size, double min, double max,
                                       const std::string& unit, const std::string& description);
  /// A list of texts.
  std::vector<std::string> texts(const std::string& key,
                                 const std::vector<std::string>& default_value,
                                 const std::string& description);

  /// A value of any kind, for who hands it on; none if it is absent or "key:" has nothing behind
  /// it.
  std::optional<YamlValue> value(const std::string& key, const std::string& description);
  /// The entries of a list of them; a value that is no list counts as the only entry.
  std::vector<YamlValue> values(const std::string& key, const std::string& description);

  /// The mapping under the key; empty if absent.
  YamlMap map(const std::string& key);
  /// The same where the keys are free names, for the reader to ask for: an empty one is an entry.
  YamlMap free_map(const std::string& key, const std::string& description);
  /// The list of mappings under the key; empty if absent.
  std::vector<YamlMap> maps(const std::string& key);
  /// All keys of this mapping in the file's order, for mappings whose keys are free names.
  std::vector<std::string> keys() const;

  /// The keys of this mapping that nobody asked for, in the file's order: of a file that other
  /// programs share. They are no error of finish() then, but for those that are nearly a key that
  /// was asked for: they are a slip.
  std::vector<std::string> leave_rest();
  /// Number of problems in the whole document so far: unchanged by a reading that went well.
  std::size_t problem_count() const;
  /// Records a problem found by the caller at the key (or at this mapping if the key is "" or
  /// absent): `what` in the form "what; expected what".
  void problem(const std::string& key, const std::string& what);

 private:
  friend class StrictYaml;
  struct Node;
  struct State;
  YamlMap(State* state, Node* node, std::string path, int line)
      : state_(state), node_(node), path_(std::move(path)), line_(line) {}
  Node* find(const std::string& key) const;
  std::optional<std::vector<double>> read_numbers(const std::string& key, int size, double min,
                                                  double max, const std::string& unit);
  std::string read_choice(const std::string& key, const std::string& default_value,
                          const std::vector<std::string>& choices, const std::string& description,
                          char (*as_read)(char));
  void missing(const std::string& key, const std::string& expected);
  YamlValue value_of(const Node& node) const;
  std::string child_path(const std::string& key) const;
  void record(const std::string& key, const std::string& value, const std::string& default_value,
              const std::string& unit, const std::string& range, const std::string& description,
              const std::vector<std::string>& words = {});

  State* state_;
  Node* node_;  ///< null: the file does not hold this mapping
  std::string path_;
  int line_;  ///< of the mapping, or of the nearest one that is there
};

/// Strict reading of one YAML document: unknown, duplicate, missing, non-finite, out-of-range and
/// wrongly typed entries are errors, and all of them are reported together.
///
///   StrictYaml yaml = StrictYaml::from_file("robot.yaml");
///   const double radius = yaml.root().map("robot").number("radius", 0.18, 0.01, 5, "m", "...");
///   yaml.finish();  // throws InputError with every problem
///
/// Not thread-safe; movable.
class StrictYaml {
 public:
  /// Throws InputError if the file is missing, no regular file, unreadable, larger than 16 MB, not
  /// YAML, or its root is not a mapping. An empty document is an empty mapping.
  static StrictYaml from_file(const std::string& path);
  /// `source` stands for the file's name in messages.
  static StrictYaml from_text(const std::string& text, const std::string& source);
  StrictYaml(StrictYaml&&) noexcept;
  StrictYaml& operator=(StrictYaml&&) noexcept;
  ~StrictYaml();

  /// Puts a value in the place of what the document says at that path, or adds it; of two for one
  /// path the later counts. Before reading. Throws InputError if it is no value, or if the document
  /// has something else than mappings on the way.
  void set(const YamlSetting& setting);

  /// Moves what has another name now to that name, and notes each key of it (notices()). Of a key
  /// that both names tell, the later setting counts; told twice by the document it is a problem.
  /// Before reading; settings that follow are moved likewise.
  void rename(std::vector<RenamedKey> renamed);
  /// "f.yaml:3: simulator.mapping.core is perception.mapping.core now; it is read as that for one
  /// version more", in the order of the table, at most 100.
  const std::vector<std::string>& notices() const;

  /// Takes keys that are no more out of the document. Records a problem for each that has another
  /// value than its default. Before reading.
  void leave_out(const std::vector<GoneKey>& gone);

  YamlMap root();
  /// Numbers in quotes and with a plus sign count as numbers, as yaml-cpp itself takes them.
  void accept_quoted_numbers();
  /// Adds an error for every key that was never asked for (with the nearest key that was), then
  /// throws InputError if there is any problem, in the order of the lines.
  void finish();
  /// Every entry that was asked for so far, in the order of asking.
  const std::vector<ConfigEntry>& entries() const;

 private:
  StrictYaml();
  void move_renamed();
  std::unique_ptr<YamlMap::State> state_;
};

}  // namespace prospect
