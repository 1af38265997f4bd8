// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/robot_in_world.h"

#include "adapters/formats/files/not_built_in.h"

#ifdef PROSPECT_WITH_TINYXML2

#include <tinyxml2.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/left_out.h"
#include "adapters/formats/worlds/sdf_file.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

[[noreturn]] void refuse_world(const std::string& path, int line, const std::string& what) {
  throw InputError(path + ":" + std::to_string(line) + ": " + what);
}

std::string text_of(const char* text) { return text != nullptr ? text : ""; }

/// Refuses a <uri> or the like that names a file beside the world.
void refuse_neighbours(const std::string& path, const XMLElement& element) {
  for (const XMLElement* e = element.FirstChildElement(); e != nullptr;
       e = e->NextSiblingElement()) {
    std::string name = text_of(e->GetText());
    name.erase(0, name.find_first_not_of(" \t\r\n"));
    name.erase(name.find_last_not_of(" \t\r\n") + 1);
    std::error_code error;
    const std::string kind = e->Name();
    const bool names_a_file = kind == "uri" || kind == "filename";
    if (names_a_file && !name.empty() && name.find("://") == std::string::npos &&
        fs::is_regular_file(fs::path(path).parent_path() / name, error)) {
      refuse_world(path, e->GetLineNum(),
                   "<" + kind + "> names " + in_quotes(name) +
                       ", which lies beside the world; expected --sdf in the same folder");
    }
    refuse_neighbours(path, *e);
  }
}

}  // namespace

std::string gazebo_world_with_robot(const std::string& path, const std::string& model,
                                    const std::string& folder) {
  tinyxml2::XMLDocument file, robot;
  read_sdf(path, file);
  XMLElement* sdf = file.FirstChildElement("sdf");
  if (sdf == nullptr) refuse_world(path, 1, "no <sdf>; expected a Gazebo world");
  const std::string version = text_of(sdf->Attribute("version"));
  if (std::atof(version.c_str()) < 1.5) {
    refuse_world(path, sdf->GetLineNum(),
                 "SDF of version " + in_quotes(version) +
                     "; expected 1.5 or newer, as `gz sdf -c FILE` writes it");
  }
  XMLElement* world = sdf->FirstChildElement("world");
  if (world == nullptr) {
    refuse_world(path, sdf->GetLineNum(),
                 "a model without a <world>; expected a world to put it into");
  }
  if (robot.Parse(model.c_str()) != tinyxml2::XML_SUCCESS || robot.RootElement() == nullptr) {
    throw std::invalid_argument("robot in world: the model is no XML");
  }
  const std::string name = text_of(robot.RootElement()->Attribute("name"));
  for (const XMLElement* e = world->FirstChildElement(); e != nullptr;
       e = e->NextSiblingElement()) {
    const XMLElement* named = e->FirstChildElement("name");
    const std::string its = std::string(e->Name()) == "include"
                                ? text_of(named != nullptr ? named->GetText() : nullptr)
                                : text_of(e->Attribute("name"));
    if (its == name) {
      refuse_world(path, e->GetLineNum(),
                   "a model " + in_quotes(name) + " is in it; expected a world without the robot");
    }
  }
  std::error_code error;
  const fs::path own = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : ".";
  if (!fs::equivalent(own, folder, error)) refuse_neighbours(path, *world);
  world->InsertEndChild(robot.RootElement()->DeepClone(&file));
  tinyxml2::XMLPrinter printer;
  file.Print(&printer);
  return printer.CStr();
}

}  // namespace prospect

#else

namespace prospect {

std::string gazebo_world_with_robot(const std::string&, const std::string&, const std::string&) {
  throw NotBuiltIn("export of Gazebo worlds",
                   "Assimp and TinyXML-2 (libassimp-dev, libtinyxml2-dev)");
}

}  // namespace prospect

#endif
