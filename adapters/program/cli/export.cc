// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/export_problems.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"
#include "adapters/program/cli/told_world.h"
#include "adapters/program/cli/written_file.h"
#include "adapters/robots/gazebo/gazebo_world_file.h"
#include "adapters/robots/gazebo/robot_in_world.h"
#include "adapters/robots/simulator/camera_sensors.h"

namespace prospect {
namespace {

struct ExportArguments {
  std::string what = "office";  ///< a world; with `to` a problem file or a set
  std::string sdf;              ///< file
  std::string to;               ///< a format of problems
  std::string folder;           ///< for them
  bool seeded = false;
  ConfigurationArguments configuration;
  std::uint64_t seed = 1;  ///< of the marks on surfaces, as in a mission
};

namespace fs = std::filesystem;
using Files = std::vector<std::pair<std::string, std::string>>;  // name and content

GazeboRobotOptions robot_options(const Configuration& configuration) {
  GazeboRobotOptions options;
  options.names = configuration.gazebo;
  return options;
}

Files files_of(const World& world, const Configuration& configuration, const std::string& name) {
  GazeboWorldOptions options;
  options.robot = robot_options(configuration);
  return gazebo_world_files(world, seen_mesh(world, configuration.simulator), configuration.robot,
                            options, name);
}

/// A world of Gazebo, as it is, with the robot on the floor that is explored.
Files with_robot(const std::string& path, const World& world, const Configuration& configuration,
                 const fs::path& sdf) {
  const std::string extension = fs::path(path).extension().string();
  if (extension != ".world" && extension != ".sdf") {
    throw InputError(path +
                     ": a mesh; expected a Gazebo world that shows it, or a world of voxels");
  }
  std::error_code error;
  if (fs::equivalent(path, sdf, error)) {
    throw InputError("--sdf: '" + sdf.string() + "' is the world itself; expected another name");
  }
  Pose start = world.start;
  start.position.z() = world.source_floor_height;
  const std::string model =
      gazebo_robot_model(configuration.robot, robot_options(configuration), start);
  const fs::path folder = sdf.has_parent_path() ? sdf.parent_path() : fs::path(".");
  return {{sdf.filename().string(), gazebo_world_with_robot(path, model, folder.string())}};
}

int export_world(const ExportArguments& arguments, const Registries& registries,
                 SignalGuard& signals) {
  const fs::path sdf = arguments.sdf;
  const std::string name = sdf.stem().string();
  if (sdf.extension() != ".sdf" || name.empty() ||
      name.find_first_of(" \"<>&#") != std::string::npos) {
    throw InputError("--sdf: '" + arguments.sdf +
                     "'; expected a file .sdf with a name without blanks and quotes");
  }
  Configuration configuration =
      read_told(arguments.configuration, registries, ConfigurationUse::kExport);
  Progress progress;
  const std::shared_ptr<const World> world =
      told_world(arguments.what, configuration, ConfigurationUse::kExport, progress);
  progress.show("surfaces of " + arguments.what);
  configuration.simulator.seed = arguments.seed;
  const fs::path folder = sdf.has_parent_path() ? sdf.parent_path() : fs::path(".");
  Files files;
  try {
    files = world->mesh ? with_robot(arguments.what, *world, configuration, sdf)
                        : files_of(*world, configuration, name);
  } catch (const std::invalid_argument& error) {
    throw InputError(arguments.what + ": " + error.what());
  }
  progress.finish();
  signals.note();  // what is written now is written whole
  OutputFolder out = OutputFolder::beside(folder.string());
  std::vector<std::string> names;
  for (const auto& [file, content] : files) names.push_back(file);
  out.claim_all(names);  // all, before the first is written
  // The SDF comes last: where it is, all that it names is.
  for (const auto& [file, content] : files) {
    const std::string path = (folder / file).string();
    write_file(out, file, content, path);
    std::printf("%s\n", path.c_str());
  }
  return kDone;
}

int export_told(const ExportArguments& arguments, const Registries& registries,
                SignalGuard& signals) {
  if (arguments.to.empty() == arguments.sdf.empty()) {
    throw InputError(arguments.to.empty()
                         ? "export: to what?; expected --sdf FILE of a world, or --to c, nl or "
                           "casadi of problems"
                         : "--to: beside --sdf; expected one of them");
  }
  if (!arguments.to.empty()) {
    if (!arguments.configuration.empty() || arguments.seeded) {
      throw InputError("--to: beside options of a world; expected --out at most");
    }
    return export_problems(
        {arguments.what, arguments.to, arguments.folder.empty() ? "." : arguments.folder},
        registries, signals);
  }
  if (!arguments.folder.empty()) {
    throw InputError("--out: beside --sdf, which says where; expected --to");
  }
  return export_world(arguments, registries, signals);
}

}  // namespace

Command export_command(CLI::App& program) {
  const auto given = std::make_shared<ExportArguments>();
  ExportArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "export",
      "A world with the robot in it, for Gazebo 11; or problems for other people's solvers");
  command
      ->add_option("world", arguments.what,
                   "With --sdf a world, as explore takes it, but no mesh file; with --to a "
                   "problem file or a set of problems, as bench takes it")
      ->type_name("WORLD")
      ->capture_default_str();
  command
      ->add_option("--sdf", arguments.sdf,
                   "File to write: the world as SDF; surfaces and textures go beside it")
      ->type_name("FILE");
  command
      ->add_option("--to", arguments.to,
                   "Problems as C with the interface of CasADi's external functions, as AMPL's "
                   "text form (.nl), or as Python that builds them with CasADi")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"c", "nl", "casadi"}));
  command->add_option("--out", arguments.folder, "With --to: folder to write to [.]")
      ->type_name("DIR");
  add_configuration(command, arguments.configuration);
  add_world_keys(command, arguments.configuration);
  CLI::Option* seed = command->add_option("--seed", arguments.seed, "Of the marks on surfaces")
                          ->check(whole_number_within(0, std::numeric_limits<std::uint64_t>::max()))
                          ->capture_default_str();
  return {command, [given, seed](const Invocation& in) {
            given->seeded = seed->count() > 0;
            return export_told(*given, in.registries, in.signals);
          }};
}

}  // namespace prospect
