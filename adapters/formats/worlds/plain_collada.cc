// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/plain_collada.h"

#ifdef PROSPECT_WITH_ASSIMP

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/polygon_triangles.h"

namespace prospect {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

std::string_view trimmed(std::string_view text) {
  constexpr const char* kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) + 1 - first);
}

/// The texts of an element as one, without white space about it; so its attributes.
void plain_texts(XMLElement& element) {
  for (const tinyxml2::XMLAttribute* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view value = a->Value(), plain = trimmed(value);
    if (plain.size() != value.size()) element.SetAttribute(a->Name(), std::string(plain).c_str());
  }
  tinyxml2::XMLText* first = nullptr;
  std::string whole;
  bool other = false;
  for (XMLNode *node = element.FirstChild(), *next = nullptr; node != nullptr; node = next) {
    next = node->NextSibling();
    if (tinyxml2::XMLText* text = node->ToText()) {
      if (first != nullptr) whole += std::string(whole.empty() ? "" : " ") + text->Value();
      if (first == nullptr) {
        first = text;
        whole = text->Value();
      } else {
        element.DeleteChild(node);
      }
      other = other || trimmed(whole).size() != std::strlen(first->Value());
    } else if (node->ToComment() != nullptr) {
      element.DeleteChild(node);
    }
  }
  if (first != nullptr && other) first->SetValue(std::string(trimmed(whole)).c_str());
}

void each(XMLElement& element, const auto& visit) {
  visit(element);
  for (XMLElement* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    each(*e, visit);
  }
}

/// Deletes what bears a name, anywhere; how many they were.
std::size_t without(XMLElement& root, const std::vector<std::string_view>& names) {
  std::size_t count = 0;
  each(root, [&](XMLElement& parent) {
    for (XMLElement *e = parent.FirstChildElement(), *next = nullptr; e != nullptr; e = next) {
      next = e->NextSiblingElement();
      if (std::find(names.begin(), names.end(), e->Name()) == names.end()) continue;
      parent.DeleteChild(e);
      ++count;
    }
  });
  return count;
}

template <typename Number>
std::vector<Number> numbers(const char* text) {
  std::vector<Number> values;
  const std::string_view all = text != nullptr ? text : "";
  for (std::size_t at = 0; at < all.size();) {
    at = all.find_first_not_of(" \t\r\n", at);
    if (at == std::string_view::npos) break;
    std::size_t end = all.find_first_of(" \t\r\n", at);
    end = end == std::string_view::npos ? all.size() : end;
    Number value{};
    const auto parsed = std::from_chars(all.data() + at, all.data() + end, value);
    if (parsed.ec != std::errc()) break;
    values.push_back(value);
    at = end;
  }
  return values;
}

/// As plain_collada() says.
void check_lists(const XMLElement& element, const std::string& source) {
  const std::string_view name = element.Name();
  const std::string_view text = element.GetText() != nullptr ? element.GetText() : "";
  const auto fail = [&](const std::string& what) {
    throw InputError(source + ":" + std::to_string(element.GetLineNum()) + ": <" +
                     std::string(name) + "> " + what);
  };
  if (name == "up_axis" && text != "X_UP" && text != "Y_UP" && text != "Z_UP") {
    fail("is '" + std::string(text.substr(0, 40)) + "'; expected X_UP, Y_UP or Z_UP");
  }
  if (name == "p" || name == "h" || name == "v" || name == "vcount") {
    const std::size_t bad = text.find_first_not_of("0123456789- \t\r\n");
    if (bad != std::string_view::npos) {
      fail("holds '" + std::string(text.substr(bad, 20)) + "'; expected whole numbers");
    }
  }
}

/// An accessor of more than its array holds has what it holds.
void keep_within_array(XMLElement& source) {
  const XMLElement* array = source.FirstChildElement("float_array");
  XMLElement* common = source.FirstChildElement("technique_common");
  XMLElement* accessor = common != nullptr ? common->FirstChildElement("accessor") : nullptr;
  if (array == nullptr || accessor == nullptr) return;
  const std::uint64_t all = array->Unsigned64Attribute("count"),
                      offset = accessor->Unsigned64Attribute("offset"),
                      stride =
                          std::max<std::uint64_t>(1, accessor->Unsigned64Attribute("stride", 1));
  const std::uint64_t most = offset < all ? (all - offset) / stride : 0;
  if (accessor->Unsigned64Attribute("count") > most) accessor->SetAttribute("count", most);
}

/// What a uri "#NAME" names.
std::string name_in(const XMLElement& element, const char* attribute) {
  const char* value = element.Attribute(attribute);
  return value != nullptr && value[0] == '#' ? value + 1 : "";
}

const XMLElement* input_of(const XMLElement& parent, std::string_view semantic) {
  for (const XMLElement* e = parent.FirstChildElement("input"); e != nullptr;
       e = e->NextSiblingElement("input")) {
    const char* its = e->Attribute("semantic");
    if (its != nullptr && semantic == its) return e;
  }
  return nullptr;
}

/// The <polygons> of a document, whose holes need the places of their corners.
class Polygons {
 public:
  explicit Polygons(XMLElement& root) {
    each(root, [&](XMLElement& e) {
      const char* id = e.Attribute("id");
      if (id != nullptr) named_.emplace(id, &e);
      if (std::string_view(e.Name()) == "polygons" && e.FirstChildElement("ph") != nullptr) {
        with_holes_.push_back(&e);
      }
    });
  }

  /// Makes triangles of all that have holes.
  void fill_holes() {
    for (XMLElement* polygons : with_holes_) to_triangles(*polygons);
  }

 private:
  struct Corners {
    int stride = 1;  ///< numbers a corner, in <p>
    int offset = 0;  ///< of the one that counts positions
    std::vector<Eigen::Vector3d> places;
  };

  std::optional<Corners> corners_of(const XMLElement& polygons) const {
    Corners corners;
    for (const XMLElement* e = polygons.FirstChildElement("input"); e != nullptr;
         e = e->NextSiblingElement("input")) {
      const int offset = e->IntAttribute("offset");
      if (offset < 0 || offset > 1000) return std::nullopt;
      corners.stride = std::max(corners.stride, offset + 1);
    }
    const XMLElement* vertex = input_of(polygons, "VERTEX");
    if (vertex == nullptr) return std::nullopt;
    corners.offset = vertex->IntAttribute("offset");
    const XMLElement* vertices = find(name_in(*vertex, "source"));
    const XMLElement* position = vertices != nullptr ? input_of(*vertices, "POSITION") : nullptr;
    const XMLElement* source = position != nullptr ? find(name_in(*position, "source")) : nullptr;
    const XMLElement* array =
        source != nullptr ? source->FirstChildElement("float_array") : nullptr;
    if (array == nullptr) return std::nullopt;
    std::size_t stride = 3;
    std::size_t first = 0;
    if (const XMLElement* common = source->FirstChildElement("technique_common")) {
      if (const XMLElement* accessor = common->FirstChildElement("accessor")) {
        stride = std::max(3U, accessor->UnsignedAttribute("stride", 3));
        first = accessor->UnsignedAttribute("offset", 0);
      }
    }
    const std::vector<double> all = numbers<double>(array->GetText());
    for (std::size_t n = first; n + 3 <= all.size(); n += stride) {
      corners.places.emplace_back(all[n], all[n + 1], all[n + 2]);
    }
    return corners;
  }

  const XMLElement* find(const std::string& name) const {
    const auto found = named_.find(name);
    return found == named_.end() ? nullptr : found->second;
  }

  void to_triangles(XMLElement& polygons) const {
    const std::optional<Corners> corners = corners_of(polygons);
    std::string indices;
    std::size_t count = 0;
    for (XMLElement *ph = polygons.FirstChildElement("ph"), *next = nullptr; ph != nullptr;
         ph = next) {
      next = ph->NextSiblingElement("ph");
      if (corners) count += add_triangles(*ph, *corners, indices);
      polygons.DeleteChild(ph);
    }
    if (count == 0) return;
    XMLElement* triangles = polygons.GetDocument()->NewElement("triangles");
    if (const char* material = polygons.Attribute("material")) {
      triangles->SetAttribute("material", material);
    }
    triangles->SetAttribute("count", static_cast<unsigned>(count));
    for (const XMLElement* e = polygons.FirstChildElement("input"); e != nullptr;
         e = e->NextSiblingElement("input")) {
      triangles->InsertEndChild(e->DeepClone(polygons.GetDocument()));
    }
    triangles->InsertNewChildElement("p")->SetText(indices.c_str());
    XMLNode* parent = polygons.Parent();
    parent->InsertAfterChild(&polygons, triangles);
    unsigned left = 0;
    for (const XMLElement* p = polygons.FirstChildElement("p"); p != nullptr;
         p = p->NextSiblingElement("p")) {
      ++left;
    }
    if (left > 0) {
      polygons.SetAttribute("count", left);
    } else {
      parent->DeleteChild(&polygons);
    }
  }

  /// The triangles of a polygon with holes, as the numbers of <p>; how many they are.
  static std::size_t add_triangles(const XMLElement& ph, const Corners& corners,
                                   std::string& indices) {
    std::vector<std::vector<std::uint32_t>> rings;  // the outer one first
    for (const XMLElement* e = ph.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      const std::string_view name = e->Name();
      if (name == "p") rings.insert(rings.begin(), numbers<std::uint32_t>(e->GetText()));
      if (name == "h") rings.push_back(numbers<std::uint32_t>(e->GetText()));
    }
    if (rings.empty()) return 0;
    const auto stride = static_cast<std::size_t>(corners.stride);
    const auto place = [&](const std::vector<std::uint32_t>& ring, std::size_t n) {
      const std::uint32_t at = ring[n * stride + static_cast<std::size_t>(corners.offset)];
      return at < corners.places.size() ? corners.places[at] : Eigen::Vector3d::Zero();
    };
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::size_t n = 0, size = rings[0].size() / stride; n < size; ++n) {
      normal += place(rings[0], n).cross(place(rings[0], (n + 1) % size));
    }
    // Seen along the axis that it faces most, from outside.
    int up = 0;
    normal.cwiseAbs().maxCoeff(&up);
    int right = (up + 1) % 3, ahead = (up + 2) % 3;
    if (normal[up] < 0.0) std::swap(right, ahead);
    std::vector<Ring> flat;
    std::vector<std::pair<const std::vector<std::uint32_t>*, std::size_t>> counted;
    for (const std::vector<std::uint32_t>& ring : rings) {
      Ring& on = flat.emplace_back();
      for (std::size_t n = 0; n < ring.size() / stride; ++n) {
        const Eigen::Vector3d p = place(ring, n);
        on.emplace_back(p[right], p[ahead]);
        counted.emplace_back(&ring, n);
      }
    }
    const Ring outer = flat.front();
    flat.erase(flat.begin());
    const auto triangles = polygon_triangles(outer, flat);
    for (const std::array<std::uint32_t, 3>& triangle : triangles) {
      for (const std::uint32_t corner : triangle) {
        const auto& [ring, n] = counted[corner];
        for (std::size_t k = 0; k < stride; ++k) {
          indices += std::to_string((*ring)[n * stride + k]) + ' ';
        }
      }
    }
    return triangles.size();
  }

  std::map<std::string, const XMLElement*> named_;
  std::vector<XMLElement*> with_holes_;
};

}  // namespace

std::string plain_collada(std::string text, const std::string& source, LeftOut& left_out) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return text;
  XMLElement* root = document.RootElement();
  if (root == nullptr) return text;
  each(*root, plain_texts);
  each(*root, [&](XMLElement& element) {
    check_lists(element, source);
    if (std::string_view(element.Name()) == "source") keep_within_array(element);
  });
  without(*root, {"instance_camera", "instance_light"});
  left_out.count("camera", without(*root, {"camera"}));
  left_out.count("light", without(*root, {"light"}));
  without(*root, {"library_cameras", "library_lights"});
  Polygons(*root).fill_holes();
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  return {printer.CStr(), static_cast<std::size_t>(printer.CStrSize() - 1)};
}

}  // namespace prospect

#endif
