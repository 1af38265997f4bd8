// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/gazebo_world.h"

#include "adapters/formats/files/not_built_in.h"

#ifdef PROSPECT_WITH_ASSIMP

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/mesh_file.h"
#include "adapters/formats/worlds/polygon_triangles.h"
#include "adapters/formats/worlds/sdf_fields.h"
#include "adapters/formats/worlds/sdf_file.h"
#include "models/lower_case.h"
#include "perception/odometry/rotation_between.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr int kDeepest = 16;  // models that include models
// Of a whole world, so that includes of includes end.
constexpr int kMostModels = 20'000;
constexpr int kMostShapes = 200'000;
constexpr std::size_t kMostTriangles = 20'000'000;
constexpr std::uintmax_t kLargestSdf = std::uintmax_t{64} << 20;

std::string without_space(const char* value) {
  std::string text = value != nullptr ? value : "";
  text.erase(0, text.find_first_not_of(" \t\r\n"));
  text.erase(text.find_last_not_of(" \t\r\n") + 1);
  return text;
}

bool is_true(const char* value) {
  const std::string word = lower_case(without_space(value));
  return word == "true" || word == "1";
}

/// What ends a world: it is too large, not only a part of it broken.
class TooMuch : public InputError {
 public:
  using InputError::InputError;
};

class Reader {
 public:
  Reader(const std::string& path, LoadProgress progress)
      : folder_(fs::path(path).parent_path()), progress_(std::move(progress)) {}

  TexturedMesh read(const std::string& path) {
    const XMLElement& sdf = document(path);
    Scope top;
    top.file = path;
    const XMLElement* world = sdf.FirstChildElement("world");
    if (world == nullptr) {
      build(sdf, "sdf", top, 0);
    } else {
      top.is_world = true;
      check_gravity(path, *world);
      build(*world, "world", top, 0);
      for (const XMLElement* e = sdf.FirstChildElement(); e != nullptr;
           e = e->NextSiblingElement()) {
        if (e != world) mesh_.left_out.count(std::string(e->Name()) + " beside the world");
      }
      // A world may hold several states; the last one is the newest.
      const XMLElement* state = nullptr;
      for (const XMLElement* e = world->FirstChildElement("state"); e != nullptr;
           e = e->NextSiblingElement("state")) {
        state = e;
      }
      if (state != nullptr) apply_state(*state, top);
    }
    show(top);
    mesh_.left_out.add(lights_and_more_);
    return std::move(mesh_);
  }

 private:
  struct Scope;

  /// A named thing with a pose: a model, link, frame or joint.
  struct Node {
    enum Kind { kModel, kLink, kFrame, kJoint } kind = kModel;
    std::string file;                         ///< that its pose is written in
    const XMLElement* element = nullptr;      ///< of itself, for messages
    const XMLElement* pose = nullptr;         ///< null: the identity
    std::string relative_to;                  ///< where the pose does not say; "": its scope
    std::string placement;                    ///< of a model: the frame in it that the pose is of
    std::unique_ptr<Scope> inside;            ///< of a model
    std::string included;                     ///< the uri of what it was included by; "": was not
    std::optional<Eigen::Affine3d> in_world;  ///< by <state>
    enum { kNew, kBusy, kDone } stage = kNew;
    Eigen::Affine3d T = Eigen::Affine3d::Identity();  ///< in its scope
  };

  /// What names can be seen together: a world or a model.
  struct Scope {
    std::string file;
    Scope* parent = nullptr;
    Node* self = nullptr;  ///< the model that this is the inside of
    bool is_world = false;
    std::vector<std::unique_ptr<Node>> nodes;
    std::map<std::string, Node*> named;
  };

  [[noreturn]] static void refuse(const std::string& file, const XMLElement& element,
                                  const std::string& what) {
    throw InputError(file + ":" + std::to_string(element.GetLineNum()) + ": " + what);
  }

  [[noreturn]] static void too_much(const std::string& file, const XMLElement& element,
                                    const std::string& what) {
    throw TooMuch(file + ":" + std::to_string(element.GetLineNum()) + ": " + what);
  }

  /// The root <sdf> of a file, which is read once, however often it is included.
  const XMLElement& document(const std::string& path) {
    std::unique_ptr<tinyxml2::XMLDocument>& known = documents_[path];
    if (known == nullptr) {
      std::error_code error;
      if (!fs::exists(path, error)) {
        throw InputError(path + ": no such file; expected a Gazebo world or model");
      }
      if (!fs::is_regular_file(path, error)) {
        throw InputError(path + ": is not a regular file; expected a Gazebo world or model");
      }
      const std::uintmax_t size = fs::file_size(path, error);
      if (error || size > kLargestSdf || (bytes_ += size) > 4 * kLargestSdf) {
        throw InputError(path + ": too large, or too much with what is included so far; expected " +
                         "at most 64 MB a file and 256 MB in all");
      }
      if (!std::ifstream(path)) {
        throw InputError(path + ": cannot be read; expected a readable file");
      }
      auto read = std::make_unique<tinyxml2::XMLDocument>();
      read_sdf(path, *read);
      known = std::move(read);
    }
    const XMLElement* sdf = known->FirstChildElement("sdf");
    if (sdf == nullptr) {
      const XMLElement* root = known->RootElement();
      const std::string name = root != nullptr ? root->Name() : "";
      throw InputError(path + ": its root is " + in_quotes(name) +
                       (name == "robot" ? ", a URDF" : "") + "; expected a Gazebo world, <sdf>");
    }
    check_version(path, *sdf);
    return *sdf;
  }

  /// Before 1.3 poses were attributes of another element; later than 1.12 nobody knows.
  static void check_version(const std::string& path, const XMLElement& sdf) {
    const char* version = sdf.Attribute("version");
    if (version == nullptr) return;
    int minor = 0;
    char more = 0;
    const std::string text = without_space(version);
    if (std::sscanf(text.c_str(), "1.%d%c", &minor, &more) != 1 || minor < 3 || minor > 12) {
      refuse(path, sdf, "SDF of version " + in_quotes(text) + "; expected 1.3 to 1.12");
    }
  }

  /// Up is z.
  static void check_gravity(const std::string& file, const XMLElement& world) {
    const XMLElement* of_physics = world.FirstChildElement("physics");
    for (const XMLElement* holds : {&world, of_physics}) {
      const XMLElement* gravity = holds == nullptr ? nullptr : holds->FirstChildElement("gravity");
      if (gravity == nullptr || gravity->GetText() == nullptr) continue;
      const std::vector<double> g = numbers(file, *gravity, 3);
      if (g[2] > 0.0 || std::max(std::abs(g[0]), std::abs(g[1])) > -g[2]) {
        refuse(file, *gravity,
               "a gravity of " + in_quotes(without_space(gravity->GetText())) +
                   "; expected it along -z, which is down");
      }
    }
  }

  static std::vector<double> numbers(const std::string& file, const XMLElement& element,
                                     std::size_t count) {
    std::istringstream in(element.GetText() != nullptr ? element.GetText() : "");
    std::vector<double> values;
    for (double value = 0.0; in >> value;) values.push_back(value);
    const bool sound = in.eof() && values.size() == count &&
                       std::all_of(values.begin(), values.end(),
                                   [](double value) { return std::abs(value) < 1e6; });
    if (!sound) {
      refuse(file, element,
             std::string("<") + element.Name() + "> holds " +
                 in_quotes(element.GetText() != nullptr ? element.GetText() : "") + "; expected " +
                 std::to_string(count) + " numbers");
    }
    return values;
  }

  /// Lengths of a shape, which are not negative.
  static std::vector<double> lengths(const std::string& file, const XMLElement& shape,
                                     const char* name, std::size_t count) {
    const XMLElement* element = shape.FirstChildElement(name);
    if (element == nullptr) {
      refuse(file, shape,
             std::string("<") + shape.Name() + "> without <" + name + ">; expected one");
    }
    std::vector<double> values = numbers(file, *element, count);
    for (const double value : values) {
      if (value < 0.0) {
        refuse(file, *element, std::string("a negative <") + name + ">; expected a length [m]");
      }
    }
    return values;
  }

  static std::string text(const std::string& file, const XMLElement& parent, const char* name) {
    const XMLElement* element = parent.FirstChildElement(name);
    if (element == nullptr || element->GetText() == nullptr) {
      refuse(file, parent,
             std::string("<") + parent.Name() + "> without <" + name + ">; expected one");
    }
    return without_space(element->GetText());
  }

  /// The numbers of a <pose>: x y z roll pitch yaw, the angles in degrees if it says so, or a
  /// quaternion.
  static Eigen::Affine3d pose_of(const std::string& file, const XMLElement* pose) {
    if (pose == nullptr || without_space(pose->GetText()).empty())
      return Eigen::Affine3d::Identity();
    const std::string format = without_space(pose->Attribute("rotation_format"));
    const bool degrees = is_true(pose->Attribute("degrees"));
    if (format == "quat_xyzw") {
      if (degrees) refuse(file, *pose, "a quaternion in degrees; expected one of the two");
      const std::vector<double> p = numbers(file, *pose, 7);
      const Eigen::Quaterniond q(p[6], p[3], p[4], p[5]);
      if (!(q.norm() > 1e-6)) refuse(file, *pose, "a quaternion of zero; expected a rotation");
      return Eigen::Translation3d(p[0], p[1], p[2]) * q.normalized();
    }
    if (!format.empty() && format != "euler_rpy") {
      refuse(file, *pose,
             "rotation_format " + in_quotes(format) + "; expected euler_rpy or quat_xyzw");
    }
    const std::vector<double> p = numbers(file, *pose, 6);
    const double unit = degrees ? std::numbers::pi / 180.0 : 1.0;
    return Eigen::Translation3d(p[0], p[1], p[2]) *
           Eigen::AngleAxisd(unit * p[5], Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(unit * p[4], Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(unit * p[3], Eigen::Vector3d::UnitX());
  }

  /// The frame that a pose names, "" if none.
  static std::string frame_of(const XMLElement* pose) {
    if (pose == nullptr) return "";
    for (const char* attribute : {"relative_to", "frame"}) {
      const std::string name = without_space(pose->Attribute(attribute));
      if (!name.empty()) return name;
    }
    return "";
  }

  // --- the tree of what is there -----------------------------------------------------------------

  Node& add(Scope& scope, Node::Kind kind, const XMLElement& element, const std::string& file,
            const std::string& name) {
    auto node = std::make_unique<Node>();
    node->kind = kind;
    node->element = &element;
    node->file = file;
    node->pose = element.FirstChildElement("pose");
    scope.nodes.push_back(std::move(node));
    Node& added = *scope.nodes.back();
    if (!name.empty()) scope.named.emplace(name, &added);
    return added;
  }

  /// The inside of a model.
  void fill(Node& model, const XMLElement& element, Scope& parent, const std::string& file,
            int depth) {
    if (++models_ > kMostModels) {
      too_much(file, element,
               "more than " + std::to_string(kMostModels) +
                   " models with what is included; expected fewer");
    }
    model.inside = std::make_unique<Scope>();
    model.inside->file = file;
    model.inside->parent = &parent;
    model.inside->self = &model;
    model.placement = without_space(element.Attribute("placement_frame"));
    build(element, "model", *model.inside, depth);
  }

  /// The nodes of a world, of a model, or of the top of a file: of what the table of fields calls
  /// `what`.
  void build(const XMLElement& parent, const std::string& what, Scope& scope, int depth) {
    leave_out_attributes(parent, what);
    for (const XMLElement* e = parent.FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      const std::string kind = e->Name(), name = without_space(e->Attribute("name"));
      const FieldRule* rule = sdf_field(what + "/" + kind);
      const bool read = rule != nullptr && rule->use == FieldUse::kUsed;
      if (kind.starts_with("xacro:")) {
        refuse(scope.file, *e,
               "<" + kind.substr(0, 40) + ">, which xacro would replace; expected what it writes");
      } else if (kind == "population") {
        refuse(scope.file, *e,
               "a <population>, which makes models by itself; expected each as a <model>");
      } else if (!read) {
        leave_out(what, *e);
      } else if (kind == "include") {
        include_or_tell(*e, scope, depth);
      } else if (kind == "model") {
        fill(add(scope, Node::kModel, *e, scope.file, name), *e, scope, scope.file, depth);
      } else if (kind == "link") {
        add(scope, Node::kLink, *e, scope.file, name);
      } else if (kind == "frame") {
        Node& frame = add(scope, Node::kFrame, *e, scope.file, name);
        frame.relative_to = without_space(e->Attribute("attached_to"));
        leave_out_rest("frame", *e);
      } else if (kind == "joint" && !name.empty()) {
        Node& joint = add(scope, Node::kJoint, *e, scope.file, name);
        if (const XMLElement* child = e->FirstChildElement("child")) {
          joint.relative_to = without_space(child->GetText());
        }
        leave_out_rest("joint", *e);
      } else {
        leave_out(what, *e);
      }
    }
  }

  /// Whether nothing but what is usual is said.
  static bool is_usual(const std::string& field, const XMLElement& element) {
    const std::string text = without_space(element.GetText());
    if (field == "visual/transparency") return element.DoubleText(1.0) == 0.0;
    return field == "visual/visibility_flags" && text == "4294967295";
  }

  /// Tells of what is in an element that is read, `what` in the table of fields, what the table
  /// does not have or refuses.
  void leave_out_rest(const std::string& what, const XMLElement& element) {
    leave_out_attributes(element, what);
    for (const XMLElement* e = element.FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      leave_out(what, *e);
    }
  }

  void leave_out_attributes(const XMLElement& element, const std::string& what) {
    for (const tinyxml2::XMLAttribute* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
      const std::string name = a->Name();
      if (name.starts_with("xmlns") || sdf_field(what + "@" + name) != nullptr) continue;
      lights_and_more_.count(in_quotes(name) + " attribute");
    }
  }

  void leave_out(const std::string& parent, const XMLElement& element) {
    const std::string kind = element.Name(), field = parent + "/" + kind;
    const FieldRule* rule = sdf_field(field);
    if (kind == "pose") leave_out_attributes(element, kind);
    if (rule != nullptr && (rule->use != FieldUse::kRefused || is_usual(field, element))) return;
    for (const char* known : {"light", "plugin", "sensor", "actor", "road", "projector"}) {
      if (kind != known) continue;
      lights_and_more_.count(kind);
      return;
    }
    if (kind == "particle_emitter") {
      lights_and_more_.count("particle emitter");
    } else if (parent == "material" && rule != nullptr) {
      lights_and_more_.count("material " + kind);
    } else {
      lights_and_more_.count(in_quotes(kind) + " element");
    }
  }

  /// Tells of a model or mesh that is not on this machine. Worlds are often moved without theirs.
  void leave_out_absent(const std::string& what, const std::string& uri) {
    const std::string name = uri.starts_with(kModel) ? uri.substr(kModel.size()) : uri;
    lights_and_more_.name(what + " " + in_quotes(name) + " (absent)");
  }

  /// An included file that is broken is left out and told: the world does without it.
  void include_or_tell(const XMLElement& element, Scope& scope, int depth) {
    const std::string uri = text(scope.file, element, "uri");
    const std::size_t before = scope.nodes.size();
    try {
      include(element, uri, scope, depth);
    } catch (const TooMuch&) {
      throw;
    } catch (const InputError& error) {
      drop(scope, before);
      leave_out_broken(uri, error);
      return;
    }
    for (std::size_t n = before; n < scope.nodes.size(); ++n) scope.nodes[n]->included = uri;
  }

  /// Takes nodes out of a scope, from the one at `first` on.
  void drop(Scope& scope, std::size_t first) {
    for (std::size_t n = first; n < scope.nodes.size(); ++n) {
      const Node* node = scope.nodes[n].get();
      std::erase_if(scope.named, [&](const auto& named) { return named.second == node; });
      if (const auto merged = merged_.find(&scope); merged != merged_.end()) {
        std::erase_if(merged->second,
                      [&](const auto& named) { return named.second.first == node; });
      }
      dropped_.push_back(std::move(scope.nodes[n]));  // its scopes keep their addresses
    }
    scope.nodes.resize(first);
  }

  void leave_out_broken(const std::string& uri, const InputError& error) {
    lights_and_more_.name("model " + in_quotes(uri) + " (" + error.lines().front().substr(0, 200) +
                          ")");
  }

  void include(const XMLElement& element, const std::string& uri, Scope& scope, int depth) {
    if (depth >= kDeepest) {
      too_much(scope.file, element, "models that include each other; expected an end of that");
    }
    const std::string name = element.FirstChildElement("name") != nullptr
                                 ? without_space(element.FirstChildElement("name")->GetText())
                                 : "";
    leave_out_rest("include", element);
    const fs::path found = find(scope.file, uri, [](const fs::path& candidate) {
      std::error_code error;
      return fs::exists(model_file(candidate), error);
    });
    if (found.empty()) {
      const std::string stock = stock_name(uri);
      if (stock == "sun") {
        lights_and_more_.count("sun");
        return;
      }
      if (stock == "ground_plane") {
        std::unique_ptr<tinyxml2::XMLDocument>& plane = documents_["model://ground_plane"];
        if (plane == nullptr) {
          plane = std::make_unique<tinyxml2::XMLDocument>();
          plane->Parse(
              "<model name='ground_plane'><link name='link'><visual name='visual'><geometry><plane>"
              "<normal>0 0 1</normal><size>100 100</size></plane></geometry></visual></link>"
              "</model>");
        }
        const XMLElement& model = *plane->FirstChildElement();
        Node& node = add(scope, Node::kModel, model, scope.file, name.empty() ? stock : name);
        node.pose = element.FirstChildElement("pose");
        fill(node, model, scope, scope.file, depth + 1);
        return;
      }
      leave_out_absent("model", uri);
      return;
    }
    const std::string file = model_file(found);
    const XMLElement& sdf = document(file);
    const XMLElement* pose = element.FirstChildElement("pose");
    const XMLElement* placement = element.FirstChildElement("placement_frame");
    bool any = false;
    const XMLElement* world = sdf.FirstChildElement("world");
    const XMLElement& parent = world != nullptr ? *world : sdf;
    const std::string what = world != nullptr ? "world" : "sdf";
    for (const XMLElement* e = parent.FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      const std::string kind = e->Name();
      if (kind == "model") {
        const std::string own = without_space(e->Attribute("name"));
        Node& node = add(scope, Node::kModel, *e, file, name.empty() ? own : name);
        fill(node, *e, scope, file, depth + 1);
        // Its pose is that of the <include>, if it has one.
        if (pose != nullptr) {
          node.pose = pose;
          node.file = scope.file;
        }
        if (placement != nullptr) node.placement = without_space(placement->GetText());
        if (is_true(element.Attribute("merge"))) {
          // What is in it can be named from here, too.
          for (auto& [inner, its] : node.inside->named) {
            merged_[&scope].emplace(inner, std::make_pair(&node, its));
          }
        }
        any = true;
      } else if (kind == "include") {
        Scope& inner = *wrap(scope, *e, pose, depth).inside;
        inner.file = file;
        include_or_tell(*e, inner, depth + 1);
        any = true;
      } else {
        any = any || kind == "light" || kind == "actor";
        leave_out(what, *e);
      }
    }
    if (!any) refuse(scope.file, element, in_quotes(uri) + " holds no model; expected one");
  }

  /// A model of no name about what an included file includes.
  Node& wrap(Scope& scope, const XMLElement& element, const XMLElement* pose, int depth) {
    Node& node = add(scope, Node::kModel, element, scope.file, "");
    if (++models_ > kMostModels || depth >= kDeepest) {
      too_much(scope.file, element,
               "more than " + std::to_string(kMostModels) +
                   " models with what is included, or more "
                   "than " +
                   std::to_string(kDeepest) + " inside each other; expected fewer");
    }
    node.pose = pose;
    node.inside = std::make_unique<Scope>();
    node.inside->parent = &scope;
    node.inside->self = &node;
    return node;
  }

  /// Poses and models as the simulation left them when the world was saved.
  void apply_state(const XMLElement& state, Scope& world) {
    leave_out_rest("state", state);
    for (const XMLElement* e = state.FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      const std::string kind = e->Name();
      if (kind == "insertions") {
        build(*e, kind, world, 0);
      } else if (kind == "deletions") {
        for (const XMLElement* gone = e->FirstChildElement("name"); gone != nullptr;
             gone = gone->NextSiblingElement("name")) {
          const auto found = world.named.find(without_space(gone->GetText()));
          if (found == world.named.end()) continue;
          deleted_.insert(found->second);
        }
      }
    }
    apply_states_of(state, {"model", "model_state"}, world);
  }

  /// Those of the models or links that an element of a state holds, by either of their names.
  void apply_states_of(const XMLElement& state, const std::set<std::string>& kinds,
                       const Scope& scope) {
    for (const XMLElement* e = state.FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      if (kinds.count(e->Name()) == 0) continue;
      const std::string name = without_space(e->Attribute("name"));
      const auto found = scope.named.find(name);
      if (found == scope.named.end()) {
        lights_and_more_.name("state of " + in_quotes(name) + " (absent)");
      } else {
        apply_state_to(*e, *found->second, scope.file);
      }
    }
  }

  void apply_state_to(const XMLElement& state, Node& node, const std::string& file) {
    leave_out_rest(node.kind == Node::kLink ? "link_state" : "model_state", state);
    if (const XMLElement* pose = state.FirstChildElement("pose")) {
      if (!frame_of(pose).empty()) {
        refuse(file, *pose,
               "a pose relative to " + in_quotes(frame_of(pose)) +
                   " in <state>; expected one in the world");
      }
      node.in_world = pose_of(file, pose);
    }
    if (const XMLElement* scale = state.FirstChildElement("scale")) {
      for (const double s : numbers(file, *scale, 3)) {
        if (s != 1.0) refuse(file, *scale, "a model that is scaled in <state>; expected 1 1 1");
      }
    }
    if (node.inside == nullptr) return;
    apply_states_of(state, {"link", "link_state", "model", "model_state"}, *node.inside);
  }

  // --- where it is -------------------------------------------------------------------------------

  /// The pose in `scope` of the frame that `name` means there.
  Eigen::Affine3d frame_in(Scope& scope, const std::string& name, const std::string& file,
                           const XMLElement& asking) {
    if (name == "__model__" || (scope.is_world && name == "world")) {
      return Eigen::Affine3d::Identity();
    }
    if (const auto found = scope.named.find(name); found != scope.named.end()) {
      return pose_in_scope(*found->second, scope);
    }
    if (const auto lifted = merged_.find(&scope); lifted != merged_.end()) {
      if (const auto found = lifted->second.find(name); found != lifted->second.end()) {
        auto [model, inner] = found->second;
        return pose_in_scope(*model, scope) * pose_in_scope(*inner, *model->inside);
      }
    }
    const std::size_t colons = name.find("::");
    if (colons != std::string::npos) {
      const auto found = scope.named.find(name.substr(0, colons));
      if (found != scope.named.end() && found->second->inside != nullptr) {
        Node& model = *found->second;
        return pose_in_scope(model, scope) *
               frame_in(*model.inside, name.substr(colons + 2), file, asking);
      }
    }
    refuse(file, asking,
           "a pose relative to " + in_quotes(name) +
               ", which is not there; expected a frame, link, joint or model of the same model or "
               "world");
  }

  Eigen::Affine3d pose_in_scope(Node& node, Scope& scope) {
    if (node.stage == Node::kDone) return node.T;
    if (node.stage == Node::kBusy) {
      refuse(node.file, *node.element, "poses that are relative to each other; expected an end");
    }
    node.stage = Node::kBusy;
    std::string relative_to = frame_of(node.pose);
    if (relative_to.empty()) relative_to = node.relative_to;
    const XMLElement& asking = node.pose != nullptr ? *node.pose : *node.element;
    Eigen::Affine3d T = pose_of(node.file, node.pose);
    if (!relative_to.empty()) T = frame_in(scope, relative_to, node.file, asking) * T;
    if (!node.placement.empty() && node.inside != nullptr) {
      T = T * frame_in(*node.inside, node.placement, node.file, *node.element).inverse();
    }
    node.T = T;
    node.stage = Node::kDone;
    return T;
  }

  Eigen::Affine3d scope_in_world(Scope& scope) {
    if (scope.self == nullptr) return Eigen::Affine3d::Identity();
    if (scope.self->in_world) return *scope.self->in_world;
    return scope_in_world(*scope.parent) * pose_in_scope(*scope.self, *scope.parent);
  }

  void show(Scope& scope) {
    const Eigen::Affine3d T_WS = scope_in_world(scope);
    for (const std::unique_ptr<Node>& node : scope.nodes) {
      if (deleted_.count(node.get()) > 0) continue;
      if (node->kind == Node::kModel && node->inside != nullptr) show_model(*node, scope);
      if (node->kind == Node::kLink) show_link(*node, scope, T_WS);
    }
  }

  void show_model(Node& model, Scope& scope) {
    if (model.included.empty()) return show(*model.inside);
    // A pose that its includer gives is the includer's.
    if (!model.in_world && model.file == scope.file) pose_in_scope(model, scope);
    const std::size_t vertices = mesh_.vertices.size(), triangles = mesh_.triangles.size();
    try {
      show(*model.inside);
    } catch (const TooMuch&) {
      throw;
    } catch (const InputError& error) {
      mesh_.vertices.resize(vertices);
      mesh_.uv.resize(vertices);
      mesh_.triangles.resize(triangles);
      mesh_.material.resize(triangles);
      leave_out_broken(model.included, error);
    }
  }

  void show_link(Node& link, Scope& scope, const Eigen::Affine3d& T_WS) {
    const Eigen::Affine3d T_SL = pose_in_scope(link, scope);
    const Eigen::Affine3d T_WL = link.in_world ? *link.in_world : T_WS * T_SL;
    const bool shows = link.element->FirstChildElement("visual") != nullptr;
    leave_out_attributes(*link.element, "link");
    for (const XMLElement* e = link.element->FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      const std::string kind = e->Name();
      if (kind == "visual") {
        const XMLElement* pose = e->FirstChildElement("pose");
        const std::string relative_to = frame_of(pose);
        Eigen::Affine3d T_WV = T_WL * pose_of(link.file, pose);
        if (!relative_to.empty() && &link != named(scope, relative_to)) {
          T_WV = T_WL * T_SL.inverse() * frame_in(scope, relative_to, link.file, *pose) *
                 pose_of(link.file, pose);
        }
        show_visual(*e, {link.file, T_WV});
      } else if (kind == "collision") {
        const XMLElement* geometry = e->FirstChildElement("geometry");
        const XMLElement* shape = geometry != nullptr ? geometry->FirstChildElement() : nullptr;
        if (!shows && shape != nullptr) {
          lights_and_more_.count(std::string(shape->Name()).substr(0, 40) + " collision");
        }
      } else {
        leave_out("link", *e);
      }
    }
  }

  static const Node* named(const Scope& scope, const std::string& name) {
    const auto found = scope.named.find(name);
    return found == scope.named.end() ? nullptr : found->second;
  }

  // --- shapes ------------------------------------------------------------------------------------

  struct Place {
    const std::string& file;
    Eigen::Affine3d T_W;
  };

  void show_visual(const XMLElement& visual, const Place& place) {
    const XMLElement* geometry = visual.FirstChildElement("geometry");
    const XMLElement* first = geometry != nullptr ? geometry->FirstChildElement() : nullptr;
    if (first == nullptr) {
      lights_and_more_.count("shapeless visual");
      return;
    }
    if (++shapes_ > kMostShapes) {
      too_much(place.file, visual,
               "more than " + std::to_string(kMostShapes) + " shapes; expected fewer");
    }
    const XMLElement& shape = *first;
    const std::string kind = shape.Name();
    leave_out_rest("visual", visual);
    if (const XMLElement* material = visual.FirstChildElement("material")) {
      leave_out_rest("material", *material);
    }
    const FieldRule* rule = sdf_field("geometry/" + kind);
    if (rule == nullptr || rule->use == FieldUse::kRefused) {
      lights_and_more_.count(in_quotes(kind) + " shape");
      return;
    }
    leave_out_rest(kind, shape);
    for (const XMLElement* e = shape.NextSiblingElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      if (kind == "polyline" && kind == e->Name()) {
        leave_out_rest(kind, *e);
      } else {
        lights_and_more_.count("further " + in_quotes(e->Name()) + " shape");
      }
    }
    const auto one = [&](const char* name) { return lengths(place.file, shape, name, 1)[0]; };
    const auto plain = [&](TexturedMesh part, const Eigen::Affine3d& T) {
      add_plain(std::move(part), grey_of(visual, place), T);
    };
    if (kind == "mesh") {
      add_mesh(shape, place);
    } else if (kind == "box") {
      const std::vector<double> s = lengths(place.file, shape, "size", 3);
      plain(prism(4, {s[0], s[1], s[2]}), place.T_W);
    } else if (kind == "cylinder") {
      const double diameter = 2.0 * one("radius");
      plain(prism(32, {diameter, diameter, one("length")}), place.T_W);
    } else if (kind == "sphere") {
      plain(turned_profile(arc(one("radius"), 0.0)), place.T_W);
    } else if (kind == "ellipsoid") {
      const std::vector<double> r = lengths(place.file, shape, "radii", 3);
      Eigen::Affine3d T = place.T_W;
      T.scale(Eigen::Vector3d(r[0], r[1], r[2]));
      plain(turned_profile(arc(1.0, 0.0)), T);
    } else if (kind == "capsule") {
      plain(turned_profile(arc(one("radius"), one("length"))), place.T_W);
    } else if (kind == "cone") {
      const double h = 0.5 * one("length");
      plain(turned_profile({{0.0, -h}, {one("radius"), -h}, {0.0, h}}), place.T_W);
    } else if (kind == "polyline") {
      add_polylines(*geometry, visual, place);
    } else if (kind == "plane") {
      const XMLElement* normal = shape.FirstChildElement("normal");
      std::vector<double> s{1.0, 1.0}, n{0.0, 0.0, 1.0};
      if (shape.FirstChildElement("size") != nullptr) s = lengths(place.file, shape, "size", 2);
      if (normal != nullptr) n = numbers(place.file, *normal, 3);
      const Eigen::Vector3d direction(n[0], n[1], n[2]);
      if (!(direction.norm() > 1e-9)) {
        refuse(place.file, shape, "<plane> with a <normal> of zero; expected a direction");
      }
      TexturedMesh plane;
      for (int k = 0; k < 4; ++k) {
        plane.vertices.emplace_back(
            Eigen::Vector3d((k & 1 ? 0.5 : -0.5) * s[0], (k & 2 ? 0.5 : -0.5) * s[1], 0.0)
                .cast<float>());
      }
      plane.triangles = {{0, 1, 3}, {0, 3, 2}};
      Eigen::Affine3d T = place.T_W;
      T.rotate(rotation_between(Eigen::Vector3d::UnitZ(), direction));
      plain(std::move(plane), T);
    }
  }

  /// A prism about the z axis whose base is a regular polygon inscribed into the ellipse of
  /// size.x() x size.y(); of four sides, the box of that size.
  static TexturedMesh prism(int sides, const Eigen::Vector3d& size) {
    TexturedMesh mesh;
    const double turn = sides == 4 ? 0.25 * std::numbers::pi : 0.0;
    const double reach = sides == 4 ? 0.5 * std::numbers::sqrt2 : 0.5;
    const auto count = static_cast<std::uint32_t>(sides);
    for (int n = 0; n < sides; ++n) {
      const double angle = turn + 2.0 * std::numbers::pi * n / sides;
      for (const double z : {-0.5, 0.5}) {
        mesh.vertices.emplace_back(
            (Eigen::Vector3d(reach * std::cos(angle), reach * std::sin(angle), z)
                 .cwiseProduct(size))
                .cast<float>());
      }
    }
    for (std::uint32_t n = 0; n < count; ++n) {
      const std::uint32_t a = 2 * n, b = 2 * ((n + 1) % count);
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
      if (n > 0 && n + 1 < count) {
        mesh.triangles.push_back({0, b, a});
        mesh.triangles.push_back({1, a + 1, b + 1});
      }
    }
    return mesh;
  }

  /// Distance from the axis and height [m] of points from pole to pole of a sphere whose halves are
  /// `apart`.
  static std::vector<Eigen::Vector2d> arc(double radius, double apart) {
    constexpr int kSteps = 8;  // of a half
    std::vector<Eigen::Vector2d> profile;
    for (const double half : {-0.5, 0.5}) {
      for (int n = 0; n <= kSteps; ++n) {
        const double angle =
            0.5 * std::numbers::pi * (n - (half < 0.0 ? kSteps : 0)) / static_cast<double>(kSteps);
        profile.emplace_back(std::max(0.0, radius * std::cos(angle)),
                             radius * std::sin(angle) + half * apart);
      }
    }
    return profile;
  }

  /// What a profile from below to above becomes when it turns about the z axis, closed at the ends.
  static TexturedMesh turned_profile(const std::vector<Eigen::Vector2d>& profile) {
    constexpr std::uint32_t kSides = 32;
    TexturedMesh mesh;
    for (const Eigen::Vector2d& p : profile) {
      for (std::uint32_t n = 0; n < kSides; ++n) {
        const double angle = 2.0 * std::numbers::pi * n / kSides;
        mesh.vertices.emplace_back(
            Eigen::Vector3d(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y()).cast<float>());
      }
    }
    for (std::uint32_t ring = 0; ring + 1 < profile.size(); ++ring) {
      for (std::uint32_t n = 0; n < kSides; ++n) {
        const std::uint32_t a = ring * kSides + n, b = ring * kSides + (n + 1) % kSides;
        if (profile[ring].x() > 0.0) mesh.triangles.push_back({a, b, b + kSides});
        if (profile[ring + 1].x() > 0.0) mesh.triangles.push_back({a, b + kSides, a + kSides});
      }
    }
    return mesh;
  }

  /// The corners of a <polyline>, to the left.
  static Ring ring_of(const XMLElement& polyline, const Place& place) {
    Ring corners;
    for (const XMLElement* point = polyline.FirstChildElement("point"); point != nullptr;
         point = point->NextSiblingElement("point")) {
      const std::vector<double> p = numbers(place.file, *point, 2);
      corners.emplace_back(p[0], p[1]);
    }
    if (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
    if (corners.size() < 3) {
      refuse(place.file, polyline,
             "a <polyline> of " + std::to_string(corners.size()) + " points; expected 3 or more");
    }
    if (doubled_area(corners) < 0.0) std::reverse(corners.begin(), corners.end());
    return corners;
  }

  /// Walls over the polygons, from 0 to the height of the first, and both ends of what lies in an
  /// odd number of them: polygons in polygons are holes.
  void add_polylines(const XMLElement& geometry, const XMLElement& visual, const Place& place) {
    const XMLElement* first = geometry.FirstChildElement("polyline");
    const double height = lengths(place.file, *first, "height", 1)[0];
    constexpr std::size_t kMostCorners = 2000;
    std::vector<Ring> rings;
    std::size_t corners = 0;
    for (const XMLElement* e = first; e != nullptr; e = e->NextSiblingElement("polyline")) {
      rings.push_back(ring_of(*e, place));
      corners += rings.back().size();
      if (corners > kMostCorners) {
        refuse(
            place.file, *e,
            "polylines of more than " + std::to_string(kMostCorners) + " points; expected fewer");
      }
    }
    const auto depth = [&](const Ring& ring) {
      return std::count_if(rings.begin(), rings.end(), [&](const Ring& other) {
        return &other != &ring && is_within(ring.front(), other);
      });
    };
    TexturedMesh part;
    // Corners of rings as vertices, at 0 and at the height; the number of the first.
    const auto add_corners = [&](const std::vector<const Ring*>& of) {
      const auto begin = static_cast<std::uint32_t>(part.vertices.size());
      for (const double z : {0.0, height}) {
        for (const Ring* ring : of) {
          for (const Eigen::Vector2d& p : *ring) {
            part.vertices.emplace_back(Eigen::Vector3d(p.x(), p.y(), z).cast<float>());
          }
        }
      }
      return begin;
    };
    for (const Ring& ring : rings) {
      const auto size = static_cast<std::uint32_t>(ring.size());
      const std::uint32_t begin = add_corners({&ring});
      for (std::uint32_t k = 0; k < size; ++k) {
        const std::uint32_t n = begin + k, m = begin + (k + 1) % size;
        part.triangles.push_back({n, m, m + size});
        part.triangles.push_back({n, m + size, n + size});
      }
      const auto level = depth(ring);
      if (level % 2 == 1) continue;
      std::vector<Ring> holes;
      std::vector<const Ring*> all{&ring};
      for (const Ring& other : rings) {
        if (&other == &ring || depth(other) != level + 1 || !is_within(other.front(), ring))
          continue;
        holes.push_back(other);
        all.push_back(&other);
      }
      const std::uint32_t base = add_corners(all);
      const auto top = static_cast<std::uint32_t>((part.vertices.size() - base) / 2);
      for (const auto& [a, b, c] : polygon_triangles(ring, holes)) {
        part.triangles.push_back({base + a, base + c, base + b});
        part.triangles.push_back({base + a + top, base + b + top, base + c + top});
      }
    }
    add_plain(std::move(part), grey_of(visual, place), place.T_W);
  }

  static std::uint8_t grey_of(const XMLElement& visual, const Place& place) {
    constexpr std::uint8_t kPlain = 180;
    const XMLElement* material = visual.FirstChildElement("material");
    if (material == nullptr) return kPlain;
    for (const char* name : {"diffuse", "ambient"}) {
      const XMLElement* colour = material->FirstChildElement(name);
      if (colour == nullptr) continue;
      // With or without its opacity.
      std::istringstream in(colour->GetText() != nullptr ? colour->GetText() : "");
      std::vector<double> c;
      for (double value = 0.0; in >> value;) c.push_back(value);
      if (c.size() != 3) c = numbers(place.file, *colour, 4);
      const double grey = 255.0 * (0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2]);
      return static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
    }
    return kPlain;
  }

  void append(const TexturedMesh& part, const Eigen::Affine3d& T, std::uint32_t first_texture) {
    if (mesh_.triangles.size() + part.triangles.size() > kMostTriangles) {
      throw TooMuch(mesh_file_ + ": more than " + std::to_string(kMostTriangles) +
                    " triangles in all; expected fewer");
    }
    append_triangles(part, T, first_texture, mesh_);
  }

  void add_plain(TexturedMesh part, std::uint8_t grey, const Eigen::Affine3d& T) {
    part.uv.assign(part.vertices.size(), Eigen::Vector2f::Zero());
    part.material.assign(part.triangles.size(), 0);
    auto& texture = plain_[grey];
    if (!texture) {
      mesh_.textures.emplace_back(1, 1, grey);
      texture = static_cast<std::uint32_t>(mesh_.textures.size() - 1);
    }
    append(part, T, *texture);
  }

  void add_mesh(const XMLElement& shape, const Place& place) {
    const std::string uri = text(place.file, shape, "uri");
    const fs::path path = find(place.file, uri);
    if (unreadable_.count(path.string()) > 0) return;
    if (path.empty()) {
      leave_out_absent("mesh", uri);
      return;
    }
    if (!is_mesh_file(path.string())) {
      lights_and_more_.name("mesh " + in_quotes(uri) + " (of a kind that is not read)");
      return;
    }
    Eigen::Affine3d T = place.T_W;
    if (const XMLElement* scale = shape.FirstChildElement("scale")) {
      const std::vector<double> s = numbers(place.file, *scale, 3);
      T.scale(Eigen::Vector3d(s[0], s[1], s[2]));
    }
    Submesh submesh;
    if (const XMLElement* wanted = shape.FirstChildElement("submesh")) {
      submesh.name = text(place.file, *wanted, "name");
      leave_out_rest("submesh", *wanted);
      if (const XMLElement* centre = wanted->FirstChildElement("center")) {
        submesh.centred = is_true(centre->GetText());
      }
    }
    const auto key = std::make_tuple(path.string(), submesh.name, submesh.centred);
    auto known = parts_.find(key);
    if (known == parts_.end()) {
      // Read once, however many models show it; its textures are in the whole once, too.
      std::optional<TexturedMesh> read = read_or_tell(path.string(), uri, submesh, place, shape);
      if (!read) return;
      Part part{*std::move(read), static_cast<std::uint32_t>(mesh_.textures.size())};
      for (Image& texture : part.mesh.textures) mesh_.textures.push_back(std::move(texture));
      part.mesh.textures.clear();
      mesh_.left_out.add(part.mesh.left_out);
      known = parts_.emplace(key, std::move(part)).first;
    }
    mesh_file_ = path.string();
    append(known->second.mesh, T, known->second.first_texture);
  }

  /// A mesh; none, and told, if it cannot be read: the world does without it.
  std::optional<TexturedMesh> read_or_tell(const std::string& path, const std::string& uri,
                                           const Submesh& submesh, const Place& place,
                                           const XMLElement& shape) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    try {
      return read_mesh_file(path, UpAxis::kZ, submesh, progress_);
    } catch (const InputError& error) {
      std::string why = error.lines().front();
      if (why.starts_with(path + ": ")) why.erase(0, path.size() + 2);
      lights_and_more_.name("mesh " + in_quotes(uri) + " (" + why.substr(0, 200) + ")");
      if (submesh.name.empty()) unreadable_.insert(path);
    }
    seconds_in_vain_ += std::chrono::duration<double>(Clock::now() - begin).count();
    constexpr double kMost = 120.0;  // [s]
    if (seconds_in_vain_ > kMost) {
      too_much(place.file, shape,
               "meshes that cannot be read have taken more than two minutes; "
               "expected sound ones");
    }
    return std::nullopt;
  }

  // --- files -------------------------------------------------------------------------------------

  static constexpr std::string_view kModel = "model://", kFile = "file://", kPackage = "package://";

  static bool is_web(const std::string& uri) {
    return uri.starts_with("http://") || uri.starts_with("https://");
  }

  /// Of https://HOST/1.0/OWNER/models/NAME/...: NAME and what follows it, with spaces for %20.
  static std::string fuel_name(const std::string& uri) {
    constexpr std::string_view kModels = "/models/";
    const std::size_t at = uri.find(kModels);
    if (!is_web(uri) || at == std::string::npos) return "";
    std::string name;
    for (std::size_t n = at + kModels.size(); n < uri.size() && uri[n] != '/'; ++n) {
      const bool space = uri.compare(n, 3, "%20") == 0;
      name += space ? ' ' : uri[n];
      if (space) n += 2;
    }
    return name;
  }

  /// The name of a model that nearly every world includes and that need not be there.
  static std::string stock_name(const std::string& uri) {
    std::string name =
        lower_case(uri.starts_with(kModel) ? uri.substr(kModel.size()) : fuel_name(uri));
    std::replace(name.begin(), name.end(), ' ', '_');
    while (!name.empty() && name.back() == '/') name.pop_back();
    return name == "sun" || name == "ground_plane" ? name : "";
  }

  /// The folders in a variable of the environment.
  static std::vector<fs::path> listed(const char* variable) {
    std::vector<fs::path> folders;
    const char* value = std::getenv(variable);
    std::istringstream in(value != nullptr ? value : "");
    for (std::string folder; std::getline(in, folder, ':');) {
      if (!folder.empty()) folders.emplace_back(folder);
    }
    return folders;
  }

  /// The folders that Gazebo looks for files in, in its order.
  static std::vector<fs::path> resource_folders() {
    std::vector<fs::path> folders;
    for (const fs::path& folder : listed("GAZEBO_RESOURCE_PATH")) {
      for (const char* below : {"", "models", "media/models", "Media/models", "media"}) {
        folders.push_back(folder / below);
      }
    }
    for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH"}) {
      for (const fs::path& folder : listed(variable)) folders.push_back(folder);
    }
    return folders;
  }

  /// The folders that models lie in.
  std::vector<fs::path> model_folders() const {
    std::vector<fs::path> folders{folder_, folder_ / "models", folder_ / ".." / "models",
                                  folder_ / "..", folder_ / ".." / ".." / "models"};
    const char* home = std::getenv("HOME");
    if (home != nullptr) folders.push_back(fs::path(home) / ".gazebo" / "models");
    for (const fs::path& folder : listed("GAZEBO_MODEL_PATH")) folders.push_back(folder);
    for (const fs::path& folder : resource_folders()) folders.push_back(folder);
    return folders;
  }

  /// What a uri can name, the likeliest first.
  std::vector<fs::path> candidates(const std::string& file, const std::string& uri) const {
    std::vector<std::string> names;
    std::vector<fs::path> folders, paths;
    if (uri.starts_with(kModel) || uri.starts_with(kPackage)) {
      names = {uri.substr(uri.find("://") + 3)};
      folders = model_folders();
    } else if (is_web(uri)) {
      std::string name = fuel_name(uri);
      if (name == "." || name == "..") return {};
      names = {name, lower_case(name)};
      std::replace(name.begin(), name.end(), ' ', '_');
      names.push_back(name);
      names.push_back(lower_case(name));
      folders = model_folders();
    } else {
      const bool file_uri = uri.starts_with(kFile);
      std::string name = file_uri ? uri.substr(kFile.size()) : uri;
      names = {name};
      std::replace(name.begin(), name.end(), '\\', '/');
      if (name != names[0]) names.push_back(name);
      // As Gazebo does: from where the program runs, then from its folders. A plain name is, in SDF
      // of today, from the file's own folder.
      const fs::path own = fs::path(file).parent_path();
      if (!file_uri) folders.push_back(own);
      folders.push_back(fs::path());
      for (const fs::path& folder : resource_folders()) folders.push_back(folder);
      if (file_uri) folders.push_back(own);
      for (const fs::path& folder : listed("GAZEBO_MODEL_PATH")) folders.push_back(folder);
      for (const char* up : {"", "..", "../.."}) folders.push_back(folder_ / up);
    }
    for (const fs::path& folder : folders) {
      for (const std::string& name : names) {
        if (!name.empty()) paths.push_back(folder / name);
      }
    }
    return paths;
  }

  /// The file or folder that a uri names, the first that exists and that `fits` takes; empty if
  /// there is none.
  fs::path find(const std::string& file, const std::string& uri,
                const std::function<bool(const fs::path&)>& fits = {}) const {
    std::error_code error;
    for (const fs::path& candidate : candidates(file, uri)) {
      if (fs::exists(candidate, error) && (!fits || fits(candidate))) return candidate;
    }
    return {};
  }

  /// The SDF of a model's folder: the one of the highest version that its manifest names, else
  /// model.sdf.
  static std::string model_file(const fs::path& found) {
    std::error_code error;
    if (!fs::is_directory(found, error)) return found.string();
    const fs::path manifest = found / "model.config";
    tinyxml2::XMLDocument document;
    std::string name = "model.sdf";
    if (fs::is_regular_file(manifest, error) && fs::file_size(manifest, error) < kLargestSdf &&
        document.LoadFile(manifest.c_str()) == tinyxml2::XML_SUCCESS) {
      double highest = -1.0;
      const XMLElement* model = document.FirstChildElement("model");
      for (const XMLElement* e = model != nullptr ? model->FirstChildElement("sdf") : nullptr;
           e != nullptr; e = e->NextSiblingElement("sdf")) {
        const double version = e->DoubleAttribute("version", 0.0);
        if (version < highest || e->GetText() == nullptr) continue;
        highest = version;
        name = without_space(e->GetText());
      }
    }
    return (found / name).string();
  }

  struct Part {
    TexturedMesh mesh;  // without textures
    std::uint32_t first_texture;
  };
  fs::path folder_;
  std::map<std::string, std::unique_ptr<tinyxml2::XMLDocument>> documents_;
  std::uintmax_t bytes_ = 0;
  int models_ = 0, shapes_ = 0;
  std::map<const Scope*, std::map<std::string, std::pair<Node*, Node*>>> merged_;
  LoadProgress progress_;
  std::set<const Node*> deleted_;
  std::vector<std::unique_ptr<Node>> dropped_;
  std::map<std::tuple<std::string, std::string, bool>, Part> parts_;
  std::set<std::string> unreadable_;  ///< files of meshes
  double seconds_in_vain_ = 0.0;
  std::map<std::uint8_t, std::optional<std::uint32_t>> plain_;
  std::string mesh_file_;
  LeftOut lights_and_more_;
  TexturedMesh mesh_;
};

}  // namespace

TexturedMesh read_gazebo_world(const std::string& path, const LoadProgress& progress) {
  TexturedMesh mesh = Reader(path, progress).read(path);
  if (mesh.triangles.empty()) {
    throw InputError(path + ": nothing to see" +
                     (mesh.left_out.empty() ? "" : " without " + mesh.left_out.text()) +
                     "; expected <visual>s whose files are there");
  }
  return mesh;
}

}  // namespace prospect

#else

namespace prospect {

TexturedMesh read_gazebo_world(const std::string&, const LoadProgress&) {
  throw NotBuiltIn("reading of Gazebo worlds",
                   "Assimp and TinyXML-2 (libassimp-dev, libtinyxml2-dev)");
}

}  // namespace prospect

#endif
