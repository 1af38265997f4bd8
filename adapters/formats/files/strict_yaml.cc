// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/strict_yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <unordered_map>

#include "models/lower_case.h"
#include "models/nearest_name.h"
#include "models/range_text.h"

namespace prospect {

struct YamlMap::Node {
  enum class Kind { kNull, kScalar, kList, kMap };
  struct Entry {
    std::string key;
    int line = 0;
    std::unique_ptr<Node> value;
    bool read = false;
  };
  Kind kind = Kind::kNull;
  int line = 0;
  bool quoted = false;
  std::string scalar;
  std::vector<std::unique_ptr<Node>> items;
  std::vector<Entry> entries;
  std::vector<std::string> asked;  ///< keys that a reader knows, for "did you mean"
  bool entered = false;            ///< a reader took it as the mapping it is
  bool fallback = false;           ///< a setting asks for the default
};

struct YamlMap::State {
  struct Problem {
    int line;
    std::string text;
  };
  std::string source;
  std::unique_ptr<Node> root = std::make_unique<Node>();
  std::vector<Problem> problems;
  std::size_t untold = 0;  ///< problems beyond kMostProblems
  bool quoted_numbers = false;
  std::vector<ConfigEntry> entries;
  std::vector<RenamedKey> renamed;
  std::vector<std::string> notices;  ///< of them

  /// The n-th setting (StrictYaml::set) stands in line kSettings + n, after all that files hold.
  static constexpr int kSettings = 1'000'000'000;
  std::vector<std::string> settings;  ///< as messages name them

  std::string at(int line) const {
    if (line >= kSettings) return settings[static_cast<std::size_t>(line - kSettings)];
    return line > 0 ? source + ":" + std::to_string(line) : source;
  }
  /// Nobody reads more of them, and each costs a search for the nearest name.
  static constexpr std::size_t kMostProblems = 100;
  bool told_enough() const { return problems.size() >= kMostProblems; }
  std::size_t problem_count() const { return problems.size() + untold; }
  void problem(int line, const std::string& text) {
    if (told_enough()) {
      ++untold;
    } else {
      problems.push_back({line, text});
    }
  }
  [[noreturn]] void raise() {
    std::stable_sort(problems.begin(), problems.end(),
                     [](const Problem& a, const Problem& b) { return a.line < b.line; });
    std::vector<std::string> lines;
    for (const Problem& p : problems) lines.push_back(at(p.line) + ": " + p.text);
    if (untold > 0) {
      lines.push_back(source + ": " + std::to_string(untold) +
                      " more problems; expected none of them");
    }
    throw InputError(lines);
  }

  /// Builds the node tree from the parser's events. Nodes are owned once: aliases, which could make
  /// the tree endless, are refused.
  class Builder;
};

namespace {

/// Text from a file for a message: one line, of bounded length.
std::string shown(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
    if (out.size() >= 60) return out + "...";
  }
  return out;
}

std::string format(const std::vector<double>& values) {
  std::string out = "[";
  for (std::size_t i = 0; i < values.size(); ++i) out += (i ? ", " : "") + exact_text(values[i]);
  return out + "]";
}

}  // namespace

std::string yaml_text(const std::string& text) {
  static const std::vector<std::string> kWords = {"true", "false", "null", "yes",
                                                  "no",   "on",    "off"};
  const std::string lowered = lower_case(text);
  const bool starts_plain =
      !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '/');
  const bool plain = starts_plain &&
                     std::all_of(text.begin(), text.end(),
                                 [](char c) {
                                   return std::isalnum(static_cast<unsigned char>(c)) ||
                                          std::string_view("_./+-").find(c) != std::string::npos;
                                 }) &&
                     std::find(kWords.begin(), kWords.end(), lowered) == kWords.end();
  if (plain) return text;
  std::string out = "\"";
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (u < 0x20 || u == 0x7f) {
      constexpr char kHex[] = "0123456789abcdef";
      out += std::string("\\x") + kHex[u >> 4] + kHex[u & 15];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

namespace {

std::string format(const std::vector<std::string>& texts) {
  std::string out = "[";
  for (std::size_t i = 0; i < texts.size(); ++i) out += (i ? ", " : "") + yaml_text(texts[i]);
  return out + "]";
}

std::optional<double> parse_number(const std::string& text) {
  double value = 0.0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

class YamlMap::State::Builder : public YAML::EventHandler {
 public:
  explicit Builder(State& state) : state_(state) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { scalar(mark, "", Text::kNull); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    state_.problem(mark.line + 1, "an alias (*name); expected the value itself");
    scalar(mark, "", Text::kNull);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& value) override {
    scalar(mark, value, tag == "!" ? Text::kQuoted : Text::kPlain);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    open(mark, Node::Kind::kList);
  }
  void OnSequenceEnd() override { stack_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    open(mark, Node::Kind::kMap);
  }
  void OnMapEnd() override { stack_.pop_back(); }

 private:
  struct Open {
    Node* node;
    bool have_key = false;
    std::string key;
    int key_line = 0;
    std::unordered_map<std::string, int> lines;  ///< of the keys so far
  };

  enum class Text { kPlain, kQuoted, kNull };
  void scalar(const YAML::Mark& mark, const std::string& value, Text text) {
    const bool null = text == Text::kNull;
    if (!stack_.empty() && stack_.back().node->kind == Node::Kind::kMap &&
        !stack_.back().have_key) {
      stack_.back().have_key = true;
      stack_.back().key = null ? "~" : value;
      stack_.back().key_line = mark.line + 1;
      return;
    }
    auto node = std::make_unique<Node>();
    node->kind = null ? Node::Kind::kNull : Node::Kind::kScalar;
    node->line = mark.line + 1;
    node->scalar = value;
    node->quoted = text == Text::kQuoted;
    place(std::move(node));
  }

  void open(const YAML::Mark& mark, Node::Kind kind) {
    auto node = std::make_unique<Node>();
    node->kind = kind;
    node->line = mark.line + 1;
    Node* raw = node.get();
    if (!stack_.empty() && stack_.back().node->kind == Node::Kind::kMap &&
        !stack_.back().have_key) {
      state_.problem(mark.line + 1, "a key that is a list or mapping; expected a name");
      stack_.back().have_key = true;
      stack_.back().key = "~";
      stack_.back().key_line = mark.line + 1;
      discarded_.push_back(std::move(node));  // its content is read, then forgotten
    } else {
      place(std::move(node));
    }
    stack_.push_back({raw, false, "", 0, {}});
  }

  void place(std::unique_ptr<Node> node) {
    if (stack_.empty()) {
      state_.root = std::move(node);
      return;
    }
    Open& top = stack_.back();
    if (top.node->kind == Node::Kind::kList) {
      top.node->items.push_back(std::move(node));
      return;
    }
    const auto [first, is_new] = top.lines.emplace(top.key, top.key_line);
    top.have_key = false;
    if (!is_new) {
      state_.problem(top.key_line, "duplicate key '" + shown(top.key) + "', first in line " +
                                       std::to_string(first->second) + "; expected it once");
      discarded_.push_back(std::move(node));
      return;
    }
    top.node->entries.push_back({top.key, top.key_line, std::move(node), false});
  }

  State& state_;
  std::vector<Open> stack_;
  std::vector<std::unique_ptr<Node>> discarded_;
};

StrictYaml::StrictYaml() : state_(std::make_unique<YamlMap::State>()) {}
StrictYaml::StrictYaml(StrictYaml&&) noexcept = default;
StrictYaml& StrictYaml::operator=(StrictYaml&&) noexcept = default;
StrictYaml::~StrictYaml() = default;

StrictYaml StrictYaml::from_file(const std::string& path) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{16} << 20;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw InputError(path + ": no such file; expected a YAML file");
  }
  if (std::filesystem::is_directory(status)) {
    throw InputError(path + ": is a directory; expected a YAML file");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(path + ": is not a regular file; expected a YAML file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kLargest) {
    throw InputError(path + ": " + std::to_string(size) + " bytes; expected at most " +
                     std::to_string(kLargest) + " for a YAML file");
  }
  std::ifstream in(path, std::ios::binary);
  std::string text;
  if (in) {
    // Bounded even if the file is a device or grows while it is read.
    std::array<char, 65536> buffer;
    while (in && text.size() <= kLargest) {
      in.read(buffer.data(), buffer.size());
      text.append(buffer.data(), static_cast<std::size_t>(in.gcount()));
    }
  }
  if (in.bad() || (!in.eof() && text.empty()) || text.size() > kLargest) {
    throw InputError(path + ": cannot be read; expected a readable YAML file");
  }
  return from_text(text, path);
}

StrictYaml StrictYaml::from_text(const std::string& text, const std::string& source) {
  StrictYaml yaml;
  YamlMap::State& state = *yaml.state_;
  state.source = source;
  if (text.find('\0') != std::string::npos) {
    throw InputError(source + ": holds a zero byte; expected YAML text");
  }
  try {
    std::istringstream in(text);
    YAML::Parser parser(in);
    YamlMap::State::Builder builder(state);
    if (parser.HandleNextDocument(builder)) {
      std::unique_ptr<YamlMap::Node> first = std::move(state.root);
      state.root = std::make_unique<YamlMap::Node>();
      YamlMap::State::Builder rest(state);
      if (parser.HandleNextDocument(rest)) {
        state.problem(state.root->line, "a second document; expected one document");
      }
      state.root = std::move(first);
    }
  } catch (const YAML::Exception& e) {
    const int line = e.mark.is_null() ? 0 : e.mark.line + 1;
    throw InputError(state.at(line) + ": " + e.msg + "; expected YAML");
  }
  using Kind = YamlMap::Node::Kind;
  if (state.root->kind == Kind::kScalar || state.root->kind == Kind::kList) {
    throw InputError(state.at(state.root->line) + ": the document is a " +
                     (state.root->kind == Kind::kList ? "list" : "single value") +
                     "; expected a mapping (key: value)");
  }
  return yaml;
}

namespace {

template <typename Node>
void move_to_line(Node& node, int line) {
  node.line = line;
  for (auto& item : node.items) move_to_line(*item, line);
  for (auto& entry : node.entries) {
    entry.line = line;
    move_to_line(*entry.value, line);
  }
}

}  // namespace

void StrictYaml::set(const YamlSetting& setting) {
  using Node = YamlMap::Node;
  YamlMap::State& state = *state_;
  const int line = YamlMap::State::kSettings + static_cast<int>(state.settings.size());
  const std::string& text = setting.assignment;
  state.settings.push_back(setting.where.empty() ? "--set " + shown(text) : setting.where);
  const auto refuse = [&](const std::string& what) {
    throw InputError(state.at(line) + ": " + what);
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || text.find_first_of("\r\n") != std::string::npos) {
    refuse("no value; expected KEY=VALUE, such as planner.weights.w_l=0");
  }
  std::unique_ptr<Node> value;
  try {
    const StrictYaml parsed = from_text("value: " + text.substr(equals + 1), "value");
    if (parsed.state_->problems.empty() && parsed.state_->root->entries.size() == 1) {
      value = std::move(parsed.state_->root->entries.front().value);
    }
  } catch (const InputError&) {
    // Told below.
  }
  if (!value) refuse("not a value; expected YAML on one line: a scalar, [a, list] or {a: mapping}");
  value->fallback = text.substr(equals + 1) == "~";
  move_to_line(*value, line);

  Node* node = state.root.get();
  std::string path;
  std::string keys = text.substr(0, equals);
  while (true) {
    const std::size_t dot = keys.find('.');
    const std::string key = keys.substr(0, dot);
    if (key.empty()) refuse("an empty key; expected names joined by dots");
    if (node->kind == Node::Kind::kNull) node->kind = Node::Kind::kMap;
    if (node->kind != Node::Kind::kMap) {
      refuse((path.empty() ? "the document" : path) + " is no mapping; expected one");
    }
    path += (path.empty() ? "" : ".") + key;
    auto entry = std::find_if(node->entries.begin(), node->entries.end(),
                              [&](const Node::Entry& e) { return e.key == key; });
    const bool created = entry == node->entries.end();
    if (created) {
      node->entries.push_back({key, line, std::make_unique<Node>(), false});
      entry = std::prev(node->entries.end());
      entry->value->line = line;
    }
    if (dot == std::string::npos) {
      if (setting.unless_told && !created) return;
      entry->line = line;
      entry->value = std::move(value);
      move_renamed();
      return;
    }
    node = entry->value.get();
    keys = keys.substr(dot + 1);
  }
}

namespace {

/// Calls visit(path below the node, line) for each key that is no mapping of others.
template <typename Node, typename Visit>
void visit_keys(const Node& node, int line, const std::string& below, const Visit& visit) {
  if (node.entries.empty()) visit(below, line);
  for (const auto& entry : node.entries) {
    visit_keys(*entry.value, entry.line, below + '.' + entry.key, visit);
  }
}

/// Takes the entry at that path out of the node, and with it the mappings that held nothing else.
template <typename Entry, typename Node>
std::optional<Entry> take(Node& node, const std::string& path) {
  const std::size_t dot = path.find('.');
  const auto entry = std::find_if(node.entries.begin(), node.entries.end(),
                                  [&](const Entry& e) { return e.key == path.substr(0, dot); });
  if (entry == node.entries.end()) return std::nullopt;
  std::optional<Entry> taken;
  if (dot == std::string::npos) {
    taken = std::move(*entry);
  } else {
    taken = take<Entry>(*entry->value, path.substr(dot + 1));
    if (!taken || !entry->value->entries.empty()) return taken;
  }
  node.entries.erase(entry);
  return taken;
}

/// Puts an entry at that path of the node. both(path, line): what is there already and stays, as it
/// is no later setting.
template <typename Entry, typename Node, typename Both>
void put(Node& node, const std::string& path, Entry entry, int settings, const Both& both) {
  if (node.kind == Node::Kind::kNull) node.kind = Node::Kind::kMap;
  if (node.kind != Node::Kind::kMap) return;  // which its reader refuses
  const std::size_t dot = path.find('.');
  const std::string key = path.substr(0, dot);
  auto there = std::find_if(node.entries.begin(), node.entries.end(),
                            [&](const Entry& e) { return e.key == key; });
  if (dot != std::string::npos) {
    if (there == node.entries.end()) {
      node.entries.push_back({key, entry.line, std::make_unique<Node>(), false});
      there = std::prev(node.entries.end());
      there->value->line = entry.line;
    }
    put(*there->value, path.substr(dot + 1), std::move(entry), settings, both);
    return;
  }
  using Kind = typename Node::Kind;
  if (there == node.entries.end() || there->value->kind == Kind::kNull) {
    if (there != node.entries.end()) node.entries.erase(there);
    entry.key = key;
    node.entries.push_back(std::move(entry));
  } else if (there->value->kind == Kind::kMap && entry.value->kind == Kind::kMap) {
    for (Entry& below : entry.value->entries) {
      const std::string name = below.key;
      put(*there->value, name, std::move(below), settings, both);
    }
  } else if (entry.line >= settings && entry.line > there->line) {
    there->line = entry.line;
    there->value = std::move(entry.value);
  } else if (there->line < settings) {
    both(entry.line, there->line);
  }
}

}  // namespace

namespace {

/// Calls visit(node, entry) for the entry at that path, if there is one; node holds it.
template <typename Node, typename Visit>
void visit_entry(Node& root, std::string path, const Visit& visit) {
  Node* node = &root;
  while (true) {
    const std::size_t dot = path.find('.');
    const std::string name = path.substr(0, dot);
    const auto entry = std::find_if(node->entries.begin(), node->entries.end(),
                                    [&](const auto& e) { return e.key == name; });
    if (entry == node->entries.end()) return;
    if (dot == std::string::npos) return visit(*node, entry);
    node = entry->value.get();
    path = path.substr(dot + 1);
  }
}

}  // namespace

void StrictYaml::rename(std::vector<RenamedKey> renamed) {
  state_->renamed = std::move(renamed);
  move_renamed();
}

void StrictYaml::move_renamed() {
  using Node = YamlMap::Node;
  YamlMap::State& state = *state_;
  for (const RenamedKey& key : state.renamed) {
    std::optional<Node::Entry> entry = take<Node::Entry>(*state.root, key.before);
    if (!entry) continue;
    visit_keys(*entry->value, entry->line, "", [&](const std::string& below, int line) {
      if (state.notices.size() == YamlMap::State::kMostProblems) return;
      state.notices.push_back(state.at(line) + ": " + shown(key.before + below) + " is " +
                              shown(key.now + below) +
                              " now; it is read as that for one version more");
    });
    put(*state.root, key.now, std::move(*entry), YamlMap::State::kSettings,
        [&](int line, int there) {
          state.problem(line, shown(key.before) + " is " + shown(key.now) + " now, and " +
                                  state.at(there) + " tells that too; expected one of them");
        });
  }
}

const std::vector<std::string>& StrictYaml::notices() const { return state_->notices; }

void StrictYaml::leave_out(const std::vector<GoneKey>& gone) {
  using Node = YamlMap::Node;
  for (const GoneKey& key : gone) {
    visit_entry(*state_->root, key.before, [&](Node& node, auto entry) {
      if (entry->value->kind != Node::Kind::kScalar || entry->value->scalar != key.value) {
        state_->problem(entry->line, shown(key.before) + " is no key any more: " + key.why +
                                         "; expected nothing, or " + key.value +
                                         ", which it was by default");
      }
      node.entries.erase(entry);
    });
  }
}

YamlMap StrictYaml::root() {
  YamlMap::Node* node = state_->root.get();
  return {state_.get(), node, "", std::max(1, node->line)};
}

const std::vector<ConfigEntry>& StrictYaml::entries() const { return state_->entries; }

void StrictYaml::accept_quoted_numbers() { state_->quoted_numbers = true; }

void StrictYaml::finish() {
  using Node = YamlMap::Node;
  // Only what a reader has descended into can hold keys that it missed.
  struct Visit {
    Node* node;
    std::string path;
  };
  std::vector<Visit> open{{state_->root.get(), ""}};
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    for (Node::Entry& entry : visit.node->entries) {
      const std::string path = visit.path.empty() ? entry.key : visit.path + "." + entry.key;
      if (!entry.read && state_->told_enough()) {
        state_->problem(entry.line, "");
        entry.read = true;
      } else if (!entry.read) {
        const std::string hint = did_you_mean(entry.key, visit.node->asked);
        std::string expected;
        for (const std::string& name : visit.node->asked) {
          expected += (expected.empty() ? "" : ", ") + name;
        }
        if (expected.empty()) expected = "no key";
        state_->problem(entry.line, "unknown key '" + shown(path) + "'" + hint +
                                        "; expected one of: " + expected);
        entry.read = true;
      } else if (entry.value->entered) {
        open.push_back({entry.value.get(), path});
      } else if (entry.value->kind == Node::Kind::kList) {
        for (std::size_t i = 0; i < entry.value->items.size(); ++i) {
          Node* item = entry.value->items[i].get();
          if (item->entered) {
            open.push_back({item, path + "[" + std::to_string(i) + "]"});
          }
        }
      }
    }
  }
  if (!state_->problems.empty()) state_->raise();
}

// --- YamlMap
// ---------------------------------------------------------------------------------------

bool YamlMap::present() const { return node_ != nullptr && node_->kind == Node::Kind::kMap; }

YamlMap::Node* YamlMap::find(const std::string& key) const {
  if (node_ == nullptr) return nullptr;
  if (std::find(node_->asked.begin(), node_->asked.end(), key) == node_->asked.end()) {
    node_->asked.push_back(key);
  }
  for (Node::Entry& entry : node_->entries) {
    if (entry.key == key) {
      entry.read = true;
      return entry.value->fallback ? nullptr : entry.value.get();
    }
  }
  return nullptr;
}

bool YamlMap::has(const std::string& key) const {
  return node_ != nullptr &&
         std::any_of(node_->entries.begin(), node_->entries.end(),
                     [&](const Node::Entry& e) { return e.key == key && !e.value->fallback; });
}

std::vector<std::string> YamlMap::keys() const {
  std::vector<std::string> out;
  if (node_ != nullptr) {
    for (Node::Entry& entry : node_->entries) {
      if (entry.value->fallback) {
        entry.read = true;
      } else {
        out.push_back(entry.key);
      }
    }
  }
  return out;
}

std::string YamlMap::where(const std::string& key) const {
  if (node_ != nullptr && !key.empty()) {
    for (const Node::Entry& entry : node_->entries) {
      if (entry.key == key) return state_->at(entry.line);
    }
  }
  return state_->at(line_);
}

std::string YamlMap::child_path(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

std::vector<std::string> YamlMap::leave_rest() {
  std::vector<std::string> rest;
  if (node_ == nullptr) return rest;
  for (Node::Entry& entry : node_->entries) {
    if (entry.read || state_->told_enough()) continue;
    if (!nearest_name(entry.key, node_->asked).empty()) continue;
    entry.read = true;
    rest.push_back(shown(entry.key));
  }
  return rest;
}

std::size_t YamlMap::problem_count() const { return state_->problem_count(); }

void YamlMap::problem(const std::string& key, const std::string& what) {
  int line = line_;
  if (node_ != nullptr && !key.empty()) {
    for (const Node::Entry& entry : node_->entries) {
      if (entry.key == key) line = entry.line;
    }
  }
  const std::string subject = key.empty() ? path_ : child_path(key);
  state_->problem(line, (subject.empty() ? "" : shown(subject) + ": ") + what);
}

void YamlMap::missing(const std::string& key, const std::string& expected) {
  problem(key, "missing; expected " + expected);
}

void YamlMap::record(const std::string& key, const std::string& value,
                     const std::string& default_value, const std::string& unit,
                     const std::string& range, const std::string& description,
                     const std::vector<std::string>& words) {
  ConfigEntry entry{child_path(key), value, default_value, unit, range, description, words};
  if (node_ != nullptr) {
    for (const Node::Entry& told : node_->entries) {
      if (told.key != key || told.value->fallback) continue;
      entry.from_file = true;
      entry.set = told.line >= State::kSettings;
      entry.where = state_->at(told.line);
    }
  }
  state_->entries.push_back(std::move(entry));
}

namespace {

/// What a node is, for "is ...".
template <typename Node>
std::string what_it_is(const Node& node) {
  switch (node.kind) {
    case Node::Kind::kNull:
      return "has no value";
    case Node::Kind::kList:
      return "is a list";
    case Node::Kind::kMap:
      return "is a mapping";
    default:
      return (node.quoted ? "is the text \"" : "is '") + shown(node.scalar) +
             (node.quoted ? "\"" : "'");
  }
}

/// The number that a node holds; `loose`: also in quotes or with a plus sign.
template <typename Node>
std::optional<double> number_in(const Node& node, bool loose) {
  if (node.kind != Node::Kind::kScalar || (node.quoted && !loose)) return std::nullopt;
  const bool plus = loose && node.scalar.size() > 1 && node.scalar[0] == '+' &&
                    node.scalar[1] != '-' && node.scalar[1] != '+';
  return parse_number(plus ? node.scalar.substr(1) : node.scalar);
}

}  // namespace

double YamlMap::number(const std::string& key, double default_value, double min, double max,
                       const std::string& unit, const std::string& description) {
  double value = default_value;
  if (const Node* node = find(key)) {
    const std::string expected = "; expected a number" + in_range(min, max, unit);
    const auto parsed = number_in(*node, state_->quoted_numbers);
    if (!parsed || !((*parsed >= min && *parsed <= max) || *parsed == default_value)) {
      problem(key, what_it_is(*node) + expected);
    } else {
      value = *parsed;
    }
  }
  record(key, exact_text(value), exact_text(default_value), unit, range_text(min, max),
         description);
  return value;
}

double YamlMap::required_number(const std::string& key, double min, double max,
                                const std::string& unit, const std::string& description) {
  double value = std::clamp(0.0, min, max);
  const std::string expected = "a number" + in_range(min, max, unit);
  if (const Node* node = find(key)) {
    const auto parsed = number_in(*node, state_->quoted_numbers);
    if (!parsed || !(*parsed >= min && *parsed <= max)) {
      problem(key, what_it_is(*node) + "; expected " + expected);
    } else {
      value = *parsed;
    }
  } else {
    missing(key, expected);
  }
  record(key, exact_text(value), "", unit, range_text(min, max), description);
  return value;
}

std::int64_t YamlMap::integer(const std::string& key, std::int64_t default_value, std::int64_t min,
                              std::int64_t max, const std::string& unit,
                              const std::string& description) {
  std::int64_t value = default_value;
  if (const Node* node = find(key)) {
    std::int64_t parsed = 0;
    const char* end = node->scalar.data() + node->scalar.size();
    const auto result = std::from_chars(node->scalar.data(), end, parsed);
    const bool good = node->kind == Node::Kind::kScalar && !node->quoted &&
                      result.ec == std::errc() && result.ptr == end &&
                      ((parsed >= min && parsed <= max) || parsed == default_value);
    if (good) {
      value = parsed;
    } else {
      problem(key, what_it_is(*node) + "; expected a whole number" + in_range(min, max, unit));
    }
  }
  record(key, std::to_string(value), std::to_string(default_value), unit, range_text(min, max),
         description);
  return value;
}

bool YamlMap::boolean(const std::string& key, bool default_value, const std::string& description) {
  bool value = default_value;
  if (const Node* node = find(key)) {
    const bool scalar = node->kind == Node::Kind::kScalar && !node->quoted;
    if (scalar && (node->scalar == "true" || node->scalar == "false")) {
      value = node->scalar == "true";
    } else {
      problem(key, what_it_is(*node) + "; expected true or false");
    }
  }
  record(key, value ? "true" : "false", default_value ? "true" : "false", "", "true, false",
         description, {"true", "false"});
  return value;
}

bool YamlMap::loose_boolean(const std::string& key, bool default_value,
                            const std::string& description) {
  bool value = default_value;
  if (const Node* node = find(key)) {
    const std::string word = node->kind == Node::Kind::kScalar ? lower_case(node->scalar) : "";
    const auto is_one_of = [&](std::initializer_list<const char*> words) {
      return std::find(words.begin(), words.end(), word) != words.end();
    };
    const bool yes = is_one_of({"1", "true", "yes", "on", "y"});
    if (yes || is_one_of({"0", "false", "no", "off", "n"})) {
      value = yes;
    } else {
      problem(key, what_it_is(*node) + "; expected 0, 1, true or false");
    }
  }
  record(key, value ? "true" : "false", default_value ? "true" : "false", "", "true, false",
         description, {"true", "false"});
  return value;
}

std::string YamlMap::text(const std::string& key, const std::string& default_value,
                          const std::string& description) {
  std::string value = default_value;
  if (const Node* node = find(key)) {
    if (node->kind == Node::Kind::kScalar) {
      value = node->scalar;
    } else {
      problem(key, what_it_is(*node) + "; expected a text");
    }
  }
  record(key, yaml_text(value), yaml_text(default_value), "", "text", description);
  return value;
}

std::string YamlMap::required_text(const std::string& key, const std::string& description) {
  std::string value;
  if (const Node* node = find(key)) {
    if (node->kind == Node::Kind::kScalar && !node->scalar.empty()) {
      value = node->scalar;
    } else {
      problem(key, what_it_is(*node) + "; expected a text");
    }
  } else {
    missing(key, "a text");
  }
  record(key, yaml_text(value), "", "", "text", description);
  return value;
}

namespace {

std::string listed(const std::vector<std::string>& choices) {
  std::string out;
  for (const std::string& c : choices) out += (out.empty() ? "" : ", ") + c;
  return out;
}

}  // namespace

std::string YamlMap::choice(const std::string& key, const std::string& default_value,
                            const std::vector<std::string>& choices,
                            const std::string& description) {
  return read_choice(key, default_value, choices, description, [](char c) { return c; });
}

std::string YamlMap::loose_choice(const std::string& key, const std::string& default_value,
                                  const std::vector<std::string>& choices,
                                  const std::string& description) {
  return read_choice(key, default_value, choices, description, [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
}

std::string YamlMap::read_choice(const std::string& key, const std::string& default_value,
                                 const std::vector<std::string>& choices,
                                 const std::string& description, char (*as_read)(char)) {
  std::string value = default_value;
  if (const Node* node = find(key)) {
    std::string word = node->kind == Node::Kind::kScalar ? node->scalar : "";
    std::transform(word.begin(), word.end(), word.begin(), as_read);
    const bool known =
        node->kind == Node::Kind::kScalar &&
        (std::find(choices.begin(), choices.end(), word) != choices.end() || word == default_value);
    if (known) {
      value = word;
    } else {
      const std::string hint =
          node->kind == Node::Kind::kScalar ? did_you_mean(node->scalar, choices) : "";
      problem(key, what_it_is(*node) + hint + "; expected one of: " + listed(choices));
    }
  }
  record(key, yaml_text(value), yaml_text(default_value), "", listed(choices), description,
         choices);
  return value;
}

std::string YamlMap::required_choice(const std::string& key,
                                     const std::vector<std::string>& choices,
                                     const std::string& description) {
  std::string value = choices.empty() ? "" : choices.front();
  if (const Node* node = find(key)) {
    if (node->kind == Node::Kind::kScalar &&
        std::find(choices.begin(), choices.end(), node->scalar) != choices.end()) {
      value = node->scalar;
    } else {
      const std::string hint =
          node->kind == Node::Kind::kScalar ? did_you_mean(node->scalar, choices) : "";
      problem(key, what_it_is(*node) + hint + "; expected one of: " + listed(choices));
    }
  } else {
    missing(key, "one of: " + listed(choices));
  }
  record(key, yaml_text(value), "", "", listed(choices), description, choices);
  return value;
}

namespace {

/// "3 numbers, -5 to 5", "numbers, 0 or more".
std::string list_text(int size, double min, double max) {
  const std::string range = range_text(min, max);
  return (size < 0 ? "" : std::to_string(size) + " ") + "numbers" +
         (range.empty() ? "" : ", " + range);
}

}  // namespace

std::optional<std::vector<double>> YamlMap::read_numbers(const std::string& key, int size,
                                                         double min, double max,
                                                         const std::string& unit) {
  const Node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const std::string expected = "; expected a list of " +
                               (size < 0 ? std::string("numbers, each") : std::to_string(size)) +
                               (size < 0 ? "" : " numbers, each") + in_range(min, max, unit);
  if (node->kind != Node::Kind::kList) {
    problem(key, what_it_is(*node) + expected);
    return std::nullopt;
  }
  if (size >= 0 && node->items.size() != static_cast<std::size_t>(size)) {
    problem(key, "has " + std::to_string(node->items.size()) + " entries" + expected);
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < node->items.size(); ++i) {
    const Node& item = *node->items[i];
    const auto parsed = number_in(item, state_->quoted_numbers);
    if (!parsed || *parsed < min || *parsed > max) {
      problem(key, "entry " + std::to_string(i + 1) + " " + what_it_is(item) + expected);
      return std::nullopt;
    }
    values.push_back(*parsed);
  }
  return values;
}

std::vector<double> YamlMap::numbers(const std::string& key,
                                     const std::vector<double>& default_value, int size, double min,
                                     double max, const std::string& unit,
                                     const std::string& description) {
  const std::vector<double> value = read_numbers(key, size, min, max, unit).value_or(default_value);
  record(key, format(value), format(default_value), unit, list_text(size, min, max), description);
  return value;
}

std::vector<double> YamlMap::required_numbers(const std::string& key, int size, double min,
                                              double max, const std::string& unit,
                                              const std::string& description) {
  const auto read = read_numbers(key, size, min, max, unit);
  if (!read && !has(key)) {
    missing(key, size < 0 ? "a list of numbers" : "a list of " + std::to_string(size) + " numbers");
  }
  const std::vector<double> value = read.value_or(
      std::vector<double>(static_cast<std::size_t>(std::max(size, 0)), std::clamp(0.0, min, max)));
  record(key, format(value), "", unit, list_text(size, min, max), description);
  return value;
}

std::vector<std::string> YamlMap::texts(const std::string& key,
                                        const std::vector<std::string>& default_value,
                                        const std::string& description) {
  std::vector<std::string> value = default_value;
  if (const Node* node = find(key)) {
    std::vector<std::string> read;
    bool good = node->kind == Node::Kind::kList;
    if (!good) problem(key, what_it_is(*node) + "; expected a list of texts");
    for (std::size_t i = 0; good && i < node->items.size(); ++i) {
      const Node& item = *node->items[i];
      if (item.kind != Node::Kind::kScalar) {
        problem(key,
                "entry " + std::to_string(i + 1) + " " + what_it_is(item) + "; expected a text");
        good = false;
      } else {
        read.push_back(item.scalar);
      }
    }
    if (good) value = read;
  }
  record(key, format(value), format(default_value), "", "texts", description);
  return value;
}

namespace {

template <typename Node>
std::string on_one_line(const Node& node) {
  std::string out;
  switch (node.kind) {
    case Node::Kind::kNull:
      return "~";
    case Node::Kind::kList:
      for (const auto& item : node.items) out += (out.empty() ? "" : ", ") + on_one_line(*item);
      return "[" + out + "]";
    case Node::Kind::kMap:
      for (const auto& entry : node.entries) {
        out += (out.empty() ? "" : ", ") + yaml_text(entry.key) + ": " + on_one_line(*entry.value);
      }
      return "{" + out + "}";
    default:
      break;
  }
  // Plain scalars such as -1.5 and true mean something else in quotes.
  const bool plain = !node.scalar.empty() && !node.quoted &&
                     std::all_of(node.scalar.begin(), node.scalar.end(), [](char c) {
                       return std::isalnum(static_cast<unsigned char>(c)) ||
                              std::string_view("_./+-").find(c) != std::string::npos;
                     });
  return plain ? node.scalar : yaml_text(node.scalar);
}

}  // namespace

YamlValue YamlMap::value_of(const Node& node) const {
  const bool scalar = node.kind == Node::Kind::kScalar;
  return {on_one_line(node), scalar ? node.scalar : "", state_->at(node.line), scalar};
}

std::optional<YamlValue> YamlMap::value(const std::string& key, const std::string& description) {
  const Node* node = find(key);
  if (node == nullptr || node->kind == Node::Kind::kNull) return std::nullopt;
  YamlValue value = value_of(*node);
  record(key, value.yaml, "", "", "any value", description);
  return value;
}

std::vector<YamlValue> YamlMap::values(const std::string& key, const std::string& description) {
  std::vector<YamlValue> out;
  const Node* node = find(key);
  if (node == nullptr || node->kind == Node::Kind::kNull) return out;
  if (node->kind == Node::Kind::kList) {
    for (const auto& item : node->items) out.push_back(value_of(*item));
  } else {
    out.push_back(value_of(*node));
  }
  std::string list;
  for (const YamlValue& value : out) list += (list.empty() ? "" : ", ") + value.yaml;
  record(key, "[" + list + "]", "", "", "any values", description);
  return out;
}

YamlMap YamlMap::map(const std::string& key) {
  Node* node = find(key);
  if (node != nullptr && node->kind != Node::Kind::kMap && node->kind != Node::Kind::kNull) {
    problem(key, what_it_is(*node) + "; expected a mapping (key: value)");
    node = nullptr;
  }
  if (node != nullptr) node->entered = true;
  return {state_, node, child_path(key), node != nullptr ? node->line : line_};
}

YamlMap YamlMap::free_map(const std::string& key, const std::string& description) {
  YamlMap values = map(key);
  if (values.keys().empty()) record(key, "{}", "{}", "", "mapping", description);
  return values;
}

std::vector<YamlMap> YamlMap::maps(const std::string& key) {
  std::vector<YamlMap> out;
  Node* node = find(key);
  if (node == nullptr || node->kind == Node::Kind::kNull) return out;
  if (node->kind != Node::Kind::kList) {
    problem(key, what_it_is(*node) + "; expected a list of mappings");
    return out;
  }
  for (std::size_t i = 0; i < node->items.size(); ++i) {
    Node* item = node->items[i].get();
    const std::string path = child_path(key) + "[" + std::to_string(i) + "]";
    if (item->kind != Node::Kind::kMap) {
      state_->problem(item->line,
                      shown(path) + ": " + what_it_is(*item) + "; expected a mapping (key: value)");
      continue;
    }
    item->entered = true;
    out.push_back({state_, item, path, item->line});
  }
  return out;
}

// --- printing
// --------------------------------------------------------------------------------------

namespace {

struct Printed {
  std::string name;
  const ConfigEntry* entry = nullptr;
  std::vector<Printed> children;
  bool is_item = false;

  Printed& child(const std::string& child_name, bool item) {
    for (Printed& c : children) {
      if (c.name == child_name && c.is_item == item) return c;
    }
    children.push_back({child_name, nullptr, {}, item});
    return children.back();
  }
};

void print(const Printed& node, int depth, bool after_dash, std::string& out) {
  bool first = after_dash;
  for (const Printed& child : node.children) {
    const std::string indent = first ? "" : std::string(2 * static_cast<std::size_t>(depth), ' ');
    first = false;
    if (child.is_item) {
      out += indent + "- ";
      print(child, depth + 1, true, out);
      continue;
    }
    if (child.entry == nullptr) {
      const bool list = !child.children.empty() && child.children.front().is_item;
      out += indent + yaml_text(child.name) + ":\n";
      print(child, depth + (list ? 0 : 1), false, out);
      continue;
    }
    const ConfigEntry& e = *child.entry;
    const bool unset = e.value == "inf" || e.value == "-inf" || e.value == "nan";
    std::string line =
        indent + (unset && !e.unit.empty() ? "# " : "") + yaml_text(child.name) + ": " + e.value;
    std::string note = e.description;
    if (!e.unit.empty()) note += (note.empty() ? "[" : " [") + e.unit + "]";
    if (!e.default_value.empty() && e.default_value != e.value) {
      note += (note.empty() ? "" : ", ") + ("default " + e.default_value);
    }
    if (!note.empty()) {
      if (line.size() < 34) line.resize(34, ' ');
      line += "  # " + note;
    }
    out += line + "\n";
  }
}

}  // namespace

std::string effective_yaml(const std::vector<ConfigEntry>& entries) {
  Printed root;
  for (const ConfigEntry& entry : entries) {
    Printed* node = &root;
    std::string name;
    const auto descend = [&](bool item) {
      if (!name.empty()) node = &node->child(name, item);
      name.clear();
    };
    for (const char c : entry.path) {
      if (c == '.' || c == '[') {
        descend(false);
      } else if (c == ']') {
        descend(true);
      } else {
        name += c;
      }
    }
    descend(false);
    node->entry = &entry;
  }
  std::string out;
  print(root, 0, false, out);
  return out;
}

}  // namespace prospect
