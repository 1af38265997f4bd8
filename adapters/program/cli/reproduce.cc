// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "adapters/formats/files/child_process.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/interrupt.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

struct ReproduceArguments {
  std::string row, build, data;
  bool show = false, check = false;
};

/// scripts/reproduce of the clone that a page lies in, else of that where the program is called.
fs::path script_for(const std::string& row) {
  std::error_code error;
  for (const fs::path& start : {fs::path(row.substr(0, row.find('#'))), fs::path(".")}) {
    fs::path folder = fs::weakly_canonical(start, error);
    for (; !error && folder.has_relative_path(); folder = folder.parent_path()) {
      const fs::path script = folder / "scripts" / "reproduce";
      std::error_code absent;
      if (fs::is_regular_file(script, absent)) return script;
    }
  }
  throw InputError("'" + row +
                   "': no scripts/reproduce above it or above this folder; expected a clone of the "
                   "project, whose docs/results hold the rows");
}

int reproduce(const ReproduceArguments& arguments, SignalGuard& signals) {
  if (arguments.row.empty() != arguments.check) {
    throw InputError("reproduce: expected a row, PAGE#SECTION/CELL, or --check alone");
  }
  const fs::path own = own_program();
  std::vector<std::string> words = {script_for(arguments.row).string()};
  if (arguments.check) {
    words.push_back("--check");
  } else {
    words.push_back(arguments.row);
    const bool is_program = arguments.build.empty() && own.filename() == "prospect";
    const std::string build = is_program ? own.parent_path().string() : arguments.build;
    if (!build.empty()) words.insert(words.end(), {"--build", build});
    if (!arguments.data.empty()) words.insert(words.end(), {"--data", arguments.data});
    if (arguments.show) words.push_back("--show");
  }
  signals.note();  // the script's own programs end with this one
  const std::function<bool()> cancelled = signals.came();
  ChildProcess process(words, {.errors = "", .output = STDOUT_FILENO});
  std::optional<ChildProcess::End> end;
  while (!(end = process.ended())) {
    if (cancelled()) return kCancelled;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return end->signal == 0 ? end->code : kFailed;
}

}  // namespace

Command reproduce_command(CLI::App& program) {
  const auto given = std::make_shared<ReproduceArguments>();
  ReproduceArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "reproduce", "A row of docs/results again: its commit, its command, and whether it holds");
  command
      ->add_option("row", arguments.row,
                   "PAGE#SECTION[/CELL...], such as docs/results/missions.md#missions-today/office")
      ->type_name("ROW");
  command->add_option("--build", arguments.build, "Build tree that is asked [of this program]")
      ->type_name("DIR");
  command->add_option("--data", arguments.data, "Where files lie that rows name [../shared/data]")
      ->type_name("DIR");
  command->add_flag("--show", arguments.show, "Print commit and command alone");
  command->add_flag("--check", arguments.check,
                    "Instead: whether every table of the results leads to a commit that is there");
  return {command, [given](const Invocation& in) { return reproduce(*given, in.signals); }};
}

}  // namespace prospect
