// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace prospect::test {

/// The lines of a page, from 1, less fenced code blocks, comments and, if asked for, `code spans`.
inline std::vector<std::pair<int, std::string>> prose_of(const std::filesystem::path& page,
                                                         bool without_spans) {
  static const std::regex span("`[^`]*`"), comment("<!--.*?-->");
  std::vector<std::pair<int, std::string>> lines;
  std::ifstream file(page);
  std::string line;
  bool code = false;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.rfind("```", 0) == 0) code = !code;
    if (code) continue;
    line = std::regex_replace(line, comment, "");
    lines.emplace_back(number, without_spans ? std::regex_replace(line, span, "") : line);
  }
  return lines;
}

/// The anchors of a page's headings, as GitHub makes them: letters in lower case, blanks to
/// hyphens, punctuation left out.
inline std::set<std::string> anchors_of(const std::filesystem::path& page) {
  std::set<std::string> anchors;
  for (const auto& [number, line] : prose_of(page, false)) {
    const std::size_t level = line.find_first_not_of('#');
    if (level == 0 || level == std::string::npos || line[level] != ' ') continue;
    std::string anchor;
    for (const char c : line.substr(level + 1)) {
      const auto byte = static_cast<unsigned char>(c);
      if (c == ' ') {
        anchor += '-';
      } else if (std::isalnum(byte) || c == '-' || c == '_' || byte >= 0x80) {
        anchor += static_cast<char>(std::tolower(byte));
      }
    }
    anchors.insert(anchor);
  }
  return anchors;
}

/// README.md and all pages below docs/ of a project.
inline std::vector<std::filesystem::path> pages_of(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  std::vector<fs::path> pages = {root / "README.md"};
  for (const auto& entry : fs::recursive_directory_iterator(root / "docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  std::sort(pages.begin(), pages.end());
  return pages;
}

/// Relative links that lead nowhere, as "page:line: target: why".
inline std::vector<std::string> broken_links(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  std::vector<std::string> found;
  for (const fs::path& page : pages_of(root)) {
    for (const auto& [number, line] : prose_of(page, true)) {
      for (std::sregex_iterator it(line.begin(), line.end(), link), end; it != end; ++it) {
        const std::string target = (*it)[1];
        if (target.find("://") != std::string::npos) continue;
        const std::size_t hash = target.find('#');
        const std::string file = target.substr(0, hash);
        const fs::path path = file.empty() ? page : page.parent_path() / file;
        const std::string where =
            fs::relative(page, root).generic_string() + ":" + std::to_string(number) + ": ";
        if (!fs::exists(path)) {
          found.push_back(where + target + ": no such file");
        } else if (hash != std::string::npos && !anchors_of(path).count(target.substr(hash + 1))) {
          found.push_back(where + target + ": no such heading");
        }
      }
    }
  }
  return found;
}

/// Files of the docs that sources, scripts and build files name and that are not there, as
/// "file:line: name".
inline std::vector<std::string> mentions_of_nothing(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  static const std::regex mention(R"((^|[^\w/.])docs/([\w/.-]*\w))");
  static const std::set<std::string> extensions = {".h",  ".cc",   ".txt", ".cmake", ".sh",
                                                   ".md", ".yaml", ".in",  ""};
  std::vector<std::string> found;
  for (const char* top : {"adapters", "benchmarks", "cmake", "docs", "engine", "models",
                          "perception", "problems", "runtime", "scripts", "solvers", "tests"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      // The test of this very function names files that are not there.
      if (entry.path().filename() == "docs_pages_test.cc") continue;
      if (!entry.is_regular_file() || !extensions.count(entry.path().extension().string()))
        continue;
      std::ifstream file(entry.path());
      std::string line;
      for (int number = 1; std::getline(file, line); ++number) {
        for (std::sregex_iterator it(line.begin(), line.end(), mention), end; it != end; ++it) {
          const std::string name = "docs/" + (*it)[2].str();
          if (fs::exists(root / name)) continue;
          found.push_back(fs::relative(entry.path(), root).generic_string() + ":" +
                          std::to_string(number) + ": " + name);
        }
      }
    }
  }
  return found;
}

/// Pages below docs/ that docs/README.md does not link to.
inline std::vector<std::string> pages_not_in_the_index(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  std::string index;
  for (const auto& [number, line] : prose_of(root / "docs/README.md", true)) index += line + '\n';
  std::vector<std::string> found;
  for (const fs::path& page : pages_of(root)) {
    const std::string name = fs::relative(page, root / "docs").generic_string();
    if (name == "README.md" || name.rfind("../", 0) == 0) continue;
    if (index.find("](" + name + ")") == std::string::npos) found.push_back(name);
  }
  return found;
}

/// How many words pages hold, by blanks: README.md and docs/, but for the configuration's
/// reference, and of them docs/results/.
struct DocsSize {
  int all = 0, results = 0;
};
inline DocsSize docs_size(const std::filesystem::path& root) {
  DocsSize size;
  for (const std::filesystem::path& page : pages_of(root)) {
    const std::string name = std::filesystem::relative(page, root).generic_string();
    if (name == "docs/reference/configuration.md") continue;
    std::ifstream file(page);
    int words = 0;
    for (std::string word; file >> word;) ++words;
    size.all += words;
    if (name.rfind("docs/results/", 0) == 0) size.results += words;
  }
  return size;
}

/// Lines of docs/reference/ and docs/tutorials/ that tell how things came about, or say with a word
/// of our own what the field has a word for, as "page:line: word". Code spans are not read.
inline std::vector<std::string> words_out_of_place(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  static const std::vector<std::pair<std::regex, std::string>> words = [] {
    std::vector<std::pair<std::regex, std::string>> all;
    for (const char* word : {"no longer",

                             "used to be",  "formerly",
                             "previously",  "[*]tried",
                             "tried first", "we had",
                             "came to be",  "nowadays",
                             "leftovers?",  "impasses?",
                             "outlooks?",   "keyholes?",
                             "guidance",    "the guide",
                             "recipes?",    "crowding",
                             "senses",      "made anew",
                             "squeez\\w+",  "put off",
                             "forgiv\\w+",  "tiers?",
                             "cautions?",   "worth its way",
                             "reopenings?", "(commit|planner) `[0-9a-f]{7}`"}) {
      all.emplace_back(std::regex(std::string("(^|[^\\w])") + word + "($|[^\\w])",
                                  std::regex::icase | std::regex::ECMAScript),
                       word);
    }
    return all;
  }();
  std::vector<std::string> found;
  for (const char* shelf : {"docs/reference", "docs/tutorials"}) {
    if (!fs::exists(root / shelf)) continue;
    for (const auto& entry : fs::directory_iterator(root / shelf)) {
      if (entry.path().extension() != ".md") continue;
      for (const auto& [number, line] : prose_of(entry.path(), true)) {
        for (const auto& [pattern, word] : words) {
          if (!std::regex_search(line, pattern)) continue;
          found.push_back(fs::relative(entry.path(), root).generic_string() + ":" +
                          std::to_string(number) + ": " + word);
        }
      }
    }
  }
  return found;
}

}  // namespace prospect::test
