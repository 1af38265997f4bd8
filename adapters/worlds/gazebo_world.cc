#include "adapters/worlds/gazebo_world.h"

#include "adapters/config/not_built_in.h"

#ifdef PROSPECT_WITH_ASSIMP

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "adapters/config/input_error.h"
#include "adapters/worlds/mesh_file.h"
#include "perception/rotation_between.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr int kDeepest = 16;  // models that include models

class Reader {
 public:
  explicit Reader(const std::string& path) : folder_(fs::path(path).parent_path()) {}

  TexturedMesh mesh() { return std::move(mesh_); }

  void read_file(const std::string& path, const Eigen::Affine3d& T_W, int depth, bool posed) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) {
      throw InputError(path + ": no such file; expected a Gazebo world or model");
    }
    tinyxml2::XMLDocument document;
    if (document.LoadFile(path.c_str()) != tinyxml2::XML_SUCCESS) {
      throw InputError(path + ":" + std::to_string(document.ErrorLineNum()) + ": no whole XML (" +
                       document.ErrorName() + "); expected a Gazebo world or model");
    }
    const XMLElement* sdf = document.FirstChildElement("sdf");
    if (sdf == nullptr) throw InputError(path + ": no element <sdf>; expected a Gazebo world");
    const Place place{path, T_W, depth, posed};
    if (const XMLElement* world = sdf->FirstChildElement("world")) {
      read_models(*world, place);
    } else {
      read_models(*sdf, place);
    }
  }

 private:
  /// Where an element stands: its file, its frame in W, and how many models include it.
  struct Place {
    std::string file;
    Eigen::Affine3d T_W;
    int depth;
    bool posed;  // by the <include>, whose pose replaces that of the model
  };

  [[noreturn]] static void refuse(const Place& place, const XMLElement& element,
                                  const std::string& what) {
    throw InputError(place.file + ":" + std::to_string(element.GetLineNum()) + ": " + what);
  }

  static std::vector<double> numbers(const Place& place, const XMLElement& element,
                                     std::size_t count) {
    std::istringstream in(element.GetText() != nullptr ? element.GetText() : "");
    std::vector<double> values;
    for (double value = 0.0; in >> value;) values.push_back(value);
    const bool sound = in.eof() && values.size() == count &&
                       std::all_of(values.begin(), values.end(),
                                   [](double value) { return std::abs(value) < 1e6; });
    if (!sound) {
      refuse(place, element,
             std::string("<") + element.Name() + "> holds '" +
                 (element.GetText() != nullptr ? element.GetText() : "") + "'; expected " +
                 std::to_string(count) + " numbers");
    }
    return values;
  }

  static std::string text(const Place& place, const XMLElement& parent, const char* name) {
    const XMLElement* element = parent.FirstChildElement(name);
    if (element == nullptr || element->GetText() == nullptr) {
      refuse(place, parent, std::string("<") + parent.Name() + "> without <" + name + ">");
    }
    std::string value = element->GetText();
    value.erase(0, value.find_first_not_of(" \t\r\n"));
    value.erase(value.find_last_not_of(" \t\r\n") + 1);
    return value;
  }

  /// The frame of an element: its <pose> within that of `place`.
  static Place inside(const Place& place, const XMLElement& element) {
    Place own = place;
    const XMLElement* pose = element.FirstChildElement("pose");
    if (pose == nullptr || pose->GetText() == nullptr) return own;
    for (const char* attribute : {"frame", "relative_to"}) {
      const char* frame = pose->Attribute(attribute);
      if (frame != nullptr && *frame != '\0') {
        refuse(place, *pose,
               std::string("a pose relative to '") + frame +
                   "'; expected one relative to the element that holds it");
      }
    }
    const std::vector<double> p = numbers(place, *pose, 6);
    own.T_W = place.T_W * Eigen::Translation3d(p[0], p[1], p[2]) *
              Eigen::AngleAxisd(p[5], Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(p[4], Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(p[3], Eigen::Vector3d::UnitX());
    return own;
  }

  /// The models and includes that stand in a world, a model or at the top of a file.
  void read_models(const XMLElement& parent, const Place& place) {
    for (const XMLElement* e = parent.FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      const std::string name = e->Name();
      if (name == "include") {
        if (place.depth >= kDeepest) refuse(place, *e, "models that include each other");
        const Place own = inside(place, *e);
        const fs::path folder = resolve(place, *e, text(place, *e, "uri"));
        read_file((fs::is_directory(folder) ? folder / "model.sdf" : folder).string(), own.T_W,
                  place.depth + 1, e->FirstChildElement("pose") != nullptr);
      } else if (name == "model") {
        Place own = place.posed ? place : inside(place, *e);
        own.posed = false;
        read_models(*e, own);
        for (const XMLElement* link = e->FirstChildElement("link"); link != nullptr;
             link = link->NextSiblingElement("link")) {
          const Place at_link = inside(own, *link);
          for (const XMLElement* visual = link->FirstChildElement("visual"); visual != nullptr;
               visual = visual->NextSiblingElement("visual")) {
            read_visual(*visual, inside(at_link, *visual));
          }
        }
      }
    }
  }

  void read_visual(const XMLElement& visual, const Place& place) {
    const XMLElement* geometry = visual.FirstChildElement("geometry");
    if (geometry == nullptr) refuse(place, visual, "<visual> without <geometry>");
    const XMLElement* shape = geometry->FirstChildElement();
    if (shape == nullptr) refuse(place, *geometry, "<geometry> without a shape");
    const std::string kind = shape->Name();
    if (kind == "mesh") {
      add_mesh(*shape, place);
    } else if (kind == "box") {
      const XMLElement* size = shape->FirstChildElement("size");
      if (size == nullptr) refuse(place, *shape, "<box> without <size>");
      const std::vector<double> s = numbers(place, *size, 3);
      add_plain(prism(4, {s[0], s[1], s[2]}), grey_of(visual, place), place.T_W);
    } else if (kind == "cylinder") {
      const XMLElement *radius = shape->FirstChildElement("radius"),
                       *length = shape->FirstChildElement("length");
      if (radius == nullptr || length == nullptr) {
        refuse(place, *shape, "<cylinder> without <radius> or <length>");
      }
      const double diameter = 2.0 * numbers(place, *radius, 1)[0];
      add_plain(prism(32, {diameter, diameter, numbers(place, *length, 1)[0]}),
                grey_of(visual, place), place.T_W);
    } else if (kind == "plane") {
      const XMLElement *size = shape->FirstChildElement("size"),
                       *normal = shape->FirstChildElement("normal");
      std::vector<double> s{1.0, 1.0}, n{0.0, 0.0, 1.0};
      if (size != nullptr) s = numbers(place, *size, 2);
      if (normal != nullptr) n = numbers(place, *normal, 3);
      const Eigen::Vector3d direction(n[0], n[1], n[2]);
      if (!(direction.norm() > 1e-9)) refuse(place, *shape, "<plane> with a <normal> of zero");
      TexturedMesh plane;
      for (int k = 0; k < 4; ++k) {
        plane.vertices.emplace_back(
            Eigen::Vector3d((k & 1 ? 0.5 : -0.5) * s[0], (k & 2 ? 0.5 : -0.5) * s[1], 0.0)
                .cast<float>());
      }
      plane.triangles = {{0, 1, 3}, {0, 3, 2}};
      Eigen::Affine3d T = place.T_W;
      T.rotate(rotation_between(Eigen::Vector3d::UnitZ(), direction));
      add_plain(plane, grey_of(visual, place), T);
    } else if (kind != "empty") {
      refuse(place, *shape,
             "the shape <" + kind + ">; expected <mesh>, <box>, <plane> or <cylinder>");
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

  static std::uint8_t grey_of(const XMLElement& visual, const Place& place) {
    constexpr std::uint8_t kPlain = 180;
    const XMLElement* material = visual.FirstChildElement("material");
    if (material == nullptr) return kPlain;
    for (const char* name : {"diffuse", "ambient"}) {
      const XMLElement* colour = material->FirstChildElement(name);
      if (colour == nullptr) continue;
      const std::vector<double> c = numbers(place, *colour, 4);
      const double grey = 255.0 * (0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2]);
      return static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
    }
    return kPlain;
  }

  void add_plain(TexturedMesh part, std::uint8_t grey, const Eigen::Affine3d& T) {
    part.uv.assign(part.vertices.size(), Eigen::Vector2f::Zero());
    part.material.assign(part.triangles.size(), 0);
    mesh_.textures.emplace_back(1, 1, grey);
    append_triangles(part, T, static_cast<std::uint32_t>(mesh_.textures.size() - 1), mesh_);
  }

  void add_mesh(const XMLElement& shape, const Place& place) {
    const fs::path path = resolve(place, shape, text(place, shape, "uri"));
    Place own = place;
    if (const XMLElement* scale = shape.FirstChildElement("scale")) {
      const std::vector<double> s = numbers(place, *scale, 3);
      own.T_W.scale(Eigen::Vector3d(s[0], s[1], s[2]));
    }
    auto known = parts_.find(path.string());
    if (known == parts_.end()) {
      // Read once, however many models show it; its textures are in the whole once, too.
      Part part{read_mesh_file(path.string(), UpAxis::kZ),
                static_cast<std::uint32_t>(mesh_.textures.size())};
      for (Image& texture : part.mesh.textures) mesh_.textures.push_back(std::move(texture));
      part.mesh.textures.clear();
      known = parts_.emplace(path.string(), std::move(part)).first;
    }
    append_triangles(known->second.mesh, own.T_W, known->second.first_texture, mesh_);
  }

  /// The file or folder that a uri names.
  fs::path resolve(const Place& place, const XMLElement& element, const std::string& uri) const {
    constexpr std::string_view kModel = "model://", kFile = "file://";
    std::error_code error;
    if (uri.starts_with(kModel)) {
      const std::string name = uri.substr(kModel.size());
      std::vector<fs::path> folders{folder_, folder_ / "models", folder_ / ".." / "models",
                                    folder_ / ".."};
      if (const char* listed = std::getenv("GAZEBO_MODEL_PATH")) {
        std::istringstream in(listed);
        for (std::string folder; std::getline(in, folder, ':');) {
          if (!folder.empty()) folders.emplace_back(folder);
        }
      }
      for (const fs::path& folder : folders) {
        if (fs::exists(folder / name, error)) return folder / name;
      }
      refuse(place, element,
             "no model '" + name +
                 "'; expected it beside the file, in models or ../models, or in a "
                 "folder of GAZEBO_MODEL_PATH");
    }
    if (uri.find("://") != std::string::npos && !uri.starts_with(kFile)) {
      refuse(place, element, "the uri '" + uri + "'; expected model://, file:// or a path");
    }
    const fs::path path = fs::path(place.file).parent_path() /
                          (uri.starts_with(kFile) ? uri.substr(kFile.size()) : uri);
    if (!fs::exists(path, error)) refuse(place, element, "no file '" + path.string() + "'");
    return path;
  }

  struct Part {
    TexturedMesh mesh;  // without textures
    std::uint32_t first_texture;
  };
  fs::path folder_;
  std::map<std::string, Part> parts_;
  TexturedMesh mesh_;
};

}  // namespace

TexturedMesh read_gazebo_world(const std::string& path) {
  Reader reader(path);
  reader.read_file(path, Eigen::Affine3d::Identity(), 0, false);
  TexturedMesh mesh = reader.mesh();
  if (mesh.triangles.empty()) throw InputError(path + ": nothing to see; expected <visual>s");
  return mesh;
}

}  // namespace prospect

#else

namespace prospect {

TexturedMesh read_gazebo_world(const std::string&) {
  throw NotBuiltIn("reading of Gazebo worlds",
                   "Assimp and TinyXML-2 (libassimp-dev, libtinyxml2-dev)");
}

}  // namespace prospect

#endif
