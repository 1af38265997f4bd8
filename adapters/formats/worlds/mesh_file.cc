// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/mesh_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <iterator>

#include "adapters/formats/files/extension.h"
#include "adapters/formats/files/not_built_in.h"
#include "adapters/formats/images/image_codec.h"

namespace prospect {
namespace {

/// Of a file's name, in small letters, with its dot.
}  // namespace

bool is_mesh_file(const std::string& path) {
  constexpr std::array kKinds = {".obj", ".dae", ".gltf", ".glb", ".stl", ".ply"};
  return std::find(kKinds.begin(), kKinds.end(), lower_case_extension(path)) != kKinds.end();
}

}  // namespace prospect

#ifdef PROSPECT_WITH_ASSIMP

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "adapters/formats/files/bounded_child.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/formats/worlds/gltf_check.h"
#include "adapters/formats/worlds/mesh_check.h"
#include "adapters/formats/worlds/plain_collada.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestMesh = 512u << 20;

/// The bytes of a PNG without its colour profile, of which the decoder complains on standard error
/// and which a grey image does not need; anything else as it is.
std::vector<std::uint8_t> without_colour_profile(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint8_t kSignature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  std::vector<std::uint8_t> kept;
  if (size < 8 || std::memcmp(data, kSignature, 8) != 0) return {data, data + size};
  kept.assign(data, data + 8);
  for (std::size_t at = 8; at < size;) {
    const std::size_t left = size - at;
    std::size_t chunk = left;  // the rest, where it is torn
    if (left >= 12) {
      std::size_t length = 0;
      for (int n = 0; n < 4; ++n) length = length << 8 | data[at + static_cast<std::size_t>(n)];
      chunk = std::min(left, length + 12);
    }
    const bool profile = left >= 8 && std::memcmp(data + at + 4, "iCCP", 4) == 0;
    if (!profile) kept.insert(kept.end(), data + at, data + at + chunk);
    at += chunk;
  }
  return kept;
}

std::optional<Image> decode_texture(const std::uint8_t* data, std::size_t size) {
  try {
    std::vector<std::uint8_t> bytes = without_colour_profile(data, size);
    if (bytes.empty()) return std::nullopt;
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
    const cv::Mat grey = decode_pixels(raw, cv::IMREAD_GRAYSCALE);
    if (grey.empty()) return std::nullopt;
    Image image(grey.cols, grey.rows);
    for (int v = 0; v < grey.rows; ++v) {
      std::copy_n(grey.ptr<std::uint8_t>(v), grey.cols, &image.at(0, v));
    }
    return image;
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}

std::uint8_t grey_of(double red, double green, double blue) {
  const double grey = 255.0 * (0.299 * red + 0.587 * green + 0.114 * blue);
  return static_cast<std::uint8_t>(
      std::lround(std::isfinite(grey) ? std::clamp(grey, 0.0, 255.0) : 128.0));
}

std::optional<Image> embedded_texture(const aiTexture& texture) {
  if (texture.mHeight == 0) {
    return decode_texture(reinterpret_cast<const std::uint8_t*>(texture.pcData), texture.mWidth);
  }
  if (texture.mWidth == 0) return std::nullopt;
  Image image(static_cast<int>(texture.mWidth), static_cast<int>(texture.mHeight));
  for (std::size_t n = 0; n < image.pixels.size(); ++n) {
    const aiTexel& t = texture.pcData[n];
    image.pixels[n] = grey_of(t.r / 255.0, t.g / 255.0, t.b / 255.0);
  }
  return image;
}

/// The image file beside a mesh; names come with backslashes and with %20, too.
/// Sets `there` if there is one.
std::optional<Image> texture_file(const fs::path& folder, std::string name, bool& there) {
  std::replace(name.begin(), name.end(), '\\', '/');
  if (name.starts_with("file://")) name.erase(0, 7);
  std::string plain;
  for (std::size_t n = 0; n < name.size(); ++n) {
    const auto hex = [&](std::size_t k) {
      return k < name.size() && std::isxdigit(static_cast<unsigned char>(name[k])) != 0;
    };
    if (name[n] == '%' && hex(n + 1) && hex(n + 2)) {
      plain += static_cast<char>(std::stoi(name.substr(n + 1, 2), nullptr, 16));
      n += 2;
    } else {
      plain += name[n];
    }
  }
  // Beside the mesh, or where Gazebo keeps textures.
  for (const fs::path& place : {folder, folder / ".." / "materials" / "textures"}) {
    for (const std::string& candidate : {name, plain}) {
      const fs::path path = place / candidate;
      std::error_code error;
      if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > kLargestMesh) continue;
      there = true;
      std::ifstream in(path, std::ios::binary);
      const std::vector<char> bytes{std::istreambuf_iterator<char>(in),
                                    std::istreambuf_iterator<char>()};
      return decode_texture(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
  }
  return std::nullopt;
}

Image albedo(const aiScene& scene, const aiMaterial& material, const fs::path& folder,
             LeftOut& left_out) {
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    aiString name;
    if (material.GetTexture(type, 0, &name) != aiReturn_SUCCESS || name.length == 0) continue;
    const aiTexture* embedded = scene.GetEmbeddedTexture(name.C_Str());
    bool there = embedded != nullptr;
    std::optional<Image> image =
        there ? embedded_texture(*embedded) : texture_file(folder, name.C_Str(), there);
    if (image) return *std::move(image);
    left_out.name("texture " + in_quotes(name.C_Str()) +
                  (there ? " (cannot be read)" : " (absent)"));
  }
  aiColor4D colour(0.7f, 0.7f, 0.7f, 1.0f);
  if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS) {
    material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
  }
  return Image(1, 1, grey_of(colour.r, colour.g, colour.b));
}

/// The triangles of a node and those below it, not yet moved: each node is a part of its own. Of a
/// submesh, only what bears its name.
void add_node(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& T_parent,
              const std::string& submesh, bool within, TexturedMesh& whole) {
  Eigen::Affine3d T = T_parent;
  const aiMatrix4x4& m = node.mTransformation;
  Eigen::Matrix4d local;
  local << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3,
      m.d4;
  T = T * Eigen::Affine3d(local);
  within = within || submesh.empty() || submesh == node.mName.C_Str();
  for (unsigned n = 0; n < node.mNumMeshes; ++n) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[n]];
    if (!within && submesh != mesh.mName.C_Str()) continue;
    if (mesh.HasVertexColors(0) && !mesh.HasTextureCoords(0))
      whole.left_out.name("colours of vertices");
    if (mesh.HasBones()) whole.left_out.count("skeleton");
    if (mesh.mNumAnimMeshes > 0) whole.left_out.count("set of morph targets");
    TexturedMesh part;
    const bool textured = mesh.HasTextureCoords(0);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      part.vertices.emplace_back(p.x, p.y, p.z);
      const aiVector3D uv = textured ? mesh.mTextureCoords[0][v] : aiVector3D(0.0f, 0.0f, 0.0f);
      part.uv.emplace_back(uv.x, uv.y);
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      part.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
      part.material.push_back(mesh.mMaterialIndex);
    }
    append_triangles(part, T, 0, whole);
  }
  for (unsigned n = 0; n < node.mNumChildren; ++n) {
    add_node(scene, *node.mChildren[n], T, submesh, within, whole);
  }
}

/// The names that a submesh can have, for a message.
std::string names_in(const aiScene& scene) {
  std::string names;
  for (unsigned n = 0; n < scene.mNumMeshes && names.size() < 200; ++n) {
    const aiString& name = scene.mMeshes[n]->mName;
    if (name.length > 0) names += (names.empty() ? "" : ", ") + in_quotes(name.C_Str());
  }
  return names.empty() ? "none" : names;
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Opens the files that a mesh names, also those with backslashes; no pipe and no device, whose
/// reading might never end. What stands in `content`, if anything, is read in place of the mesh.
class MeshFiles : public Assimp::DefaultIOSystem {
 public:
  explicit MeshFiles(std::string mesh, std::string content = "")
      : mesh_(std::move(mesh)), content_(std::move(content)) {}
  bool Exists(const char* name) const override { return !found(name).empty(); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (!content_.empty() && name == mesh_) {
      return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(content_.data()),
                                        content_.size());
    }
    const std::string path = found(name);
    return path.empty() ? nullptr : DefaultIOSystem::Open(path.c_str(), mode);
  }
  using DefaultIOSystem::Exists;
  using DefaultIOSystem::Open;

 private:
  std::string found(std::string name) const {
    std::error_code error;
    for (int n = 0; n < 2; ++n) {
      if (fs::is_regular_file(name, error)) return name;
      if (fs::exists(name, error) && !fs::is_directory(name, error)) {
        fail(mesh_, "names " + in_quotes(name) + ", which is not a regular file; expected one");
      }
      std::replace(name.begin(), name.end(), '\\', '/');
    }
    return "";
  }

  std::string mesh_, content_;
};

/// Whether a line "v x y z ..." holds at least three numbers and nothing else: the library takes
/// "1,5" for 1, and what is no number for 0. One that goes on in the next line is not looked at.
bool is_vertex(std::string_view line) {
  if (line.find('\\') != std::string_view::npos) return true;
  constexpr std::string_view kBlank = " \t\r";
  int numbers = 0;
  for (std::size_t at = line.find_first_not_of(kBlank, 2); at != std::string_view::npos;
       at = line.find_first_not_of(kBlank, at)) {
    if (line[at] == '#') break;
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    std::string_view word = line.substr(at, end - at);
    if (word.starts_with('+')) word.remove_prefix(1);
    double number = 0.0;
    if (!parse_number(word, number)) return false;
    ++numbers;
    at = end;
  }
  return numbers >= 3;
}

/// What an .obj names that is not there or not read. Throws for a vertex that is none.
void tell_what_obj_lacks(const std::string& path, LeftOut& left_out) {
  std::ifstream in(path, std::ios::binary);
  const MeshFiles files(path);
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    constexpr std::string_view kKey = "mtllib ";
    if (line.starts_with("surf ") || line.starts_with("curv ")) {
      left_out.count("free-form " + std::string(line[0] == 's' ? "surface" : "curve"));
    }
    ++number;
    if (line.starts_with("v ") && !is_vertex(line)) {
      fail(path + ":" + std::to_string(number),
           "the line " + in_quotes(line.substr(0, 60)) + "; expected v and three numbers");
    }
    if (!line.starts_with(kKey)) continue;
    std::string name = line.substr(kKey.size());
    name.erase(0, name.find_first_not_of(" \t"));
    name.erase(name.find_last_not_of(" \t\r") + 1);
    if (!files.Exists((fs::path(path).parent_path() / name).c_str())) {
      left_out.name("material file " + in_quotes(name) + " (absent)");
    }
  }
}

/// What crosses from the child: numbers as they lie in memory, lists after their length.
class Packer {
 public:
  template <typename T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  template <typename T>
  void list(const std::vector<T>& values) {
    value(static_cast<std::uint64_t>(values.size()));
    if (!values.empty()) {
      bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    }
  }
  void text(const std::string& t) { list(std::vector<char>(t.begin(), t.end())); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}
  template <typename T>
  T value() {
    T v{};
    std::memcpy(&v, take(sizeof v), sizeof v);
    return v;
  }
  template <typename T>
  std::vector<T> list() {
    const auto count = value<std::uint64_t>();
    if (count > bytes_.size() / sizeof(T)) throw std::runtime_error("a torn answer");
    std::vector<T> values(static_cast<std::size_t>(count));
    if (count > 0)
      std::memcpy(static_cast<void*>(values.data()), take(values.size() * sizeof(T)),
                  values.size() * sizeof(T));
    return values;
  }
  std::string text() {
    const std::vector<char> c = list<char>();
    return {c.begin(), c.end()};
  }

 private:
  const char* take(std::size_t size) {
    if (size > bytes_.size()) throw std::runtime_error("a torn answer");
    const char* at = bytes_.data();
    bytes_.remove_prefix(size);
    return at;
  }
  std::string_view bytes_;
};

std::string packed(const TexturedMesh& mesh) {
  Packer out;
  const auto floats = [&](const auto& points) {
    std::vector<float> numbers;
    numbers.reserve(points.size() * 3);
    for (const auto& p : points) numbers.insert(numbers.end(), p.data(), p.data() + p.size());
    out.list(numbers);
  };
  floats(mesh.vertices);
  floats(mesh.uv);
  out.list(mesh.triangles);
  out.list(mesh.material);
  out.value(static_cast<std::uint64_t>(mesh.textures.size()));
  for (const Image& texture : mesh.textures) {
    out.value(texture.width);
    out.value(texture.height);
    out.list(texture.pixels);
  }
  out.value(static_cast<std::uint64_t>(mesh.left_out.items().size()));
  for (const auto& [times, words] : mesh.left_out.items()) {
    out.value(static_cast<std::uint64_t>(times));
    out.text(words);
  }
  return out.take();
}

TexturedMesh unpacked(std::string_view bytes) {
  Unpacker in(bytes);
  TexturedMesh mesh;
  const std::vector<float> vertices = in.list<float>(), uv = in.list<float>();
  for (std::size_t n = 0; n + 2 < vertices.size(); n += 3) {
    mesh.vertices.emplace_back(vertices[n], vertices[n + 1], vertices[n + 2]);
  }
  for (std::size_t n = 0; n + 1 < uv.size(); n += 2) mesh.uv.emplace_back(uv[n], uv[n + 1]);
  mesh.triangles = in.list<std::array<std::uint32_t, 3>>();
  mesh.material = in.list<std::uint32_t>();
  const auto textures = in.value<std::uint64_t>();
  for (std::uint64_t n = 0; n < textures; ++n) {
    const int width = in.value<int>(), height = in.value<int>();
    std::vector<std::uint8_t> pixels = in.list<std::uint8_t>();
    if (width < 1 || height < 1 ||
        pixels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
      throw std::runtime_error("a torn answer");
    }
    Image image(1, 1);
    image.width = width;
    image.height = height;
    image.pixels = std::move(pixels);
    mesh.textures.push_back(std::move(image));
  }
  const auto items = in.value<std::uint64_t>();
  for (std::uint64_t n = 0; n < items; ++n) {
    const auto times = in.value<std::uint64_t>();
    const std::string words = in.text();
    if (times > 0) {
      mesh.left_out.count(words, static_cast<std::size_t>(times));
    } else {
      mesh.left_out.name(words);
    }
  }
  return mesh;
}

/// The mesh as the library reads it; to be run in a child process.
TexturedMesh import(const std::string& path, const std::string& extension, UpAxis unsaid,
                    const Submesh& submesh, const std::optional<UpAxis>& up) {
  TexturedMesh mesh;
  std::string content;
  if (extension == ".gltf" || extension == ".glb") {
    check_gltf(bytes_of(path), path, mesh.left_out);
  } else if (extension == ".stl") {
    check_stl(bytes_of(path), path);
  } else if (extension == ".ply") {
    check_ply(bytes_of(path), path);
  } else if (extension == ".dae") {
    content = plain_collada(bytes_of(path), path, mesh.left_out);
    check_collada(content, path);
  } else {
    tell_what_obj_lacks(path, mesh.left_out);
  }
  Assimp::Importer importer;
  importer.SetIOHandler(new MeshFiles(path, std::move(content)));  // which owns it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, up.has_value());
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  // Read as it is first: what the next step drops is to be told.
  const aiScene* scene =
      importer.ReadFile(path, aiProcess_FlipUVs | aiProcess_ValidateDataStructure);
  std::size_t points = 0, lines = 0;
  if (scene != nullptr) {
    for (unsigned n = 0; n < scene->mNumMeshes; ++n) {
      const aiMesh& part = *scene->mMeshes[n];
      if ((part.mPrimitiveTypes & (aiPrimitiveType_POINT | aiPrimitiveType_LINE)) == 0) continue;
      for (unsigned f = 0; f < part.mNumFaces; ++f) {
        points += part.mFaces[f].mNumIndices == 1;
        lines += part.mFaces[f].mNumIndices == 2;
      }
    }
    mesh.left_out.count("point", points);
    mesh.left_out.count("line", lines);
    mesh.left_out.count("camera", scene->mNumCameras);
    mesh.left_out.count("light", scene->mNumLights);
    mesh.left_out.count("animation", scene->mNumAnimations);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType |
                                         aiProcess_JoinIdenticalVertices);
  }
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    if (points + lines > 0) reason = "only points and lines";
    if (reason.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    fail(path, "cannot be read (" + reason + "); expected a whole mesh file");
  }
  const fs::path folder = fs::path(path).parent_path();
  for (unsigned n = 0; n < scene->mNumMaterials; ++n) {
    mesh.textures.push_back(albedo(*scene, *scene->mMaterials[n], folder, mesh.left_out));
  }
  // Assimp hands .dae and .gltf over with y up, in metres.
  const bool says = extension == ".dae" || extension == ".gltf" || extension == ".glb";
  const UpAxis its = says ? UpAxis::kY : extension == ".obj" ? unsaid : UpAxis::kZ;
  Eigen::Affine3d T = Eigen::Affine3d::Identity();
  T.linear() = upright(up.value_or(its));
  add_node(*scene, *scene->mRootNode, T, submesh.name, false, mesh);
  if (mesh.triangles.empty() && !submesh.name.empty()) {
    fail(path, "no submesh " + in_quotes(submesh.name) + "; expected one of: " + names_in(*scene));
  }
  return mesh;
}

}  // namespace

TexturedMesh read_mesh_file(const std::string& path, UpAxis unsaid, const Submesh& submesh,
                            const LoadProgress& progress, const std::optional<UpAxis>& up) {
  const auto refuse = [&](const std::string& what) { throw InputError(path + ": " + what); };
  const std::string extension = lower_case_extension(path);
  if (!is_mesh_file(path)) {
    refuse("unknown kind of mesh '" + extension +
           "'; expected .obj, .dae, .gltf, .glb, .stl or .ply");
  }
  std::error_code error;
  if (!fs::exists(path, error)) refuse("no such file; expected a mesh");
  if (!fs::is_regular_file(path, error)) refuse("is not a file; expected a mesh");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size == 0) refuse("is empty; expected a mesh");
  if (size > kLargestMesh) refuse("is larger than 512 MB");
  if (!std::ifstream(path)) refuse("cannot be read; expected a readable file");

  constexpr std::uintmax_t kMegabyte = std::uintmax_t{1} << 20;
  ChildLimits limits;
  limits.memory =
      static_cast<std::size_t>(std::min(4096 * kMegabyte, 1024 * kMegabyte + 40 * size));
  limits.seconds = std::min(120.0, 20.0 + static_cast<double>(size / kMegabyte));
  // Here, or each child would load them by itself, within its limits.
  load_image_codecs();
  TexturedMesh mesh;
  const std::string bytes = run_in_child(
      path, [&] { return packed(import(path, extension, unsaid, submesh, up)); }, limits,
      [&](double seconds) {
        if (progress)
          progress("reading " + path + ", " + std::to_string(std::lround(seconds)) + " s");
      });
  try {
    mesh = unpacked(bytes);
  } catch (const std::runtime_error&) {
    refuse("cannot be read (the reader crashed); expected a whole mesh file");
  }
  if (mesh.triangles.empty()) refuse("has no triangles; expected surfaces");
  bool sound =
      mesh.uv.size() == mesh.vertices.size() && mesh.material.size() == mesh.triangles.size();
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) sound = sound && vertex < mesh.vertices.size();
  }
  for (const std::uint32_t material : mesh.material) {
    sound = sound && material < mesh.textures.size();
  }
  if (!sound) refuse("names a vertex or material that is not there; expected a whole mesh file");
  Eigen::AlignedBox3f box;
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    if (!mesh.vertices[n].allFinite()) refuse("has a vertex that is not finite");
    box.extend(mesh.vertices[n]);
    if (!mesh.uv[n].allFinite()) mesh.uv[n].setZero();
  }
  if (submesh.centred) {
    for (Eigen::Vector3f& p : mesh.vertices) p -= box.center();
  }
  return mesh;
}

}  // namespace prospect

#else

namespace prospect {

TexturedMesh read_mesh_file(const std::string&, UpAxis, const Submesh&, const LoadProgress&,
                            const std::optional<UpAxis>&) {
  throw NotBuiltIn("reading of meshes", "Assimp (libassimp-dev)");
}

}  // namespace prospect

#endif

namespace prospect {

void append_triangles(const TexturedMesh& part, const Eigen::Affine3d& T,
                      std::uint32_t first_texture, TexturedMesh& whole) {
  const auto first = static_cast<std::uint32_t>(whole.vertices.size());
  for (const Eigen::Vector3f& p : part.vertices) {
    whole.vertices.emplace_back((T * p.cast<double>()).cast<float>());
  }
  whole.uv.insert(whole.uv.end(), part.uv.begin(), part.uv.end());
  const bool mirrored = T.linear().determinant() < 0.0;
  for (std::array<std::uint32_t, 3> triangle : part.triangles) {
    if (mirrored) std::swap(triangle[1], triangle[2]);
    for (std::uint32_t& vertex : triangle) vertex += first;
    whole.triangles.push_back(triangle);
  }
  for (const std::uint32_t material : part.material) {
    whole.material.push_back(first_texture + material);
  }
}

}  // namespace prospect
