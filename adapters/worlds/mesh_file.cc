#include "adapters/worlds/mesh_file.h"

#include <algorithm>

#include "adapters/config/not_built_in.h"

#ifdef PROSPECT_WITH_ASSIMP

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "adapters/config/input_error.h"

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
    const std::vector<std::uint8_t> bytes = without_colour_profile(data, size);
    if (bytes.empty()) return std::nullopt;
    const cv::Mat grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
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
std::optional<Image> texture_file(const fs::path& folder, std::string name) {
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
      std::ifstream in(path, std::ios::binary);
      const std::vector<char> bytes{std::istreambuf_iterator<char>(in),
                                    std::istreambuf_iterator<char>()};
      return decode_texture(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
  }
  return std::nullopt;
}

Image albedo(const aiScene& scene, const aiMaterial& material, const fs::path& folder) {
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    aiString name;
    if (material.GetTexture(type, 0, &name) != aiReturn_SUCCESS || name.length == 0) continue;
    const aiTexture* embedded = scene.GetEmbeddedTexture(name.C_Str());
    std::optional<Image> image =
        embedded != nullptr ? embedded_texture(*embedded) : texture_file(folder, name.C_Str());
    if (image) return *std::move(image);
  }
  aiColor4D colour(0.7f, 0.7f, 0.7f, 1.0f);
  if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS) {
    material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
  }
  return Image(1, 1, grey_of(colour.r, colour.g, colour.b));
}

/// The triangles of a node and those below it, not yet moved: each node is a part of its own.
void add_node(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& T_parent,
              TexturedMesh& whole) {
  Eigen::Affine3d T = T_parent;
  const aiMatrix4x4& m = node.mTransformation;
  Eigen::Matrix4d local;
  local << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3,
      m.d4;
  T = T * Eigen::Affine3d(local);
  for (unsigned n = 0; n < node.mNumMeshes; ++n) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[n]];
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
    add_node(scene, *node.mChildren[n], T, whole);
  }
}

}  // namespace

TexturedMesh read_mesh_file(const std::string& path, UpAxis unsaid) {
  const auto refuse = [&](const std::string& what) { throw InputError(path + ": " + what); };
  std::string extension = fs::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  constexpr const char* kKinds[] = {".obj", ".dae", ".gltf", ".glb"};
  if (std::find(std::begin(kKinds), std::end(kKinds), extension) == std::end(kKinds)) {
    refuse("unknown kind of mesh '" + extension + "'; expected .obj, .dae, .gltf or .glb");
  }
  std::error_code error;
  if (!fs::exists(path, error)) refuse("no such file; expected a mesh");
  if (!fs::is_regular_file(path, error)) refuse("is not a file; expected a mesh");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size == 0) refuse("is empty; expected a mesh");
  if (size > kLargestMesh) refuse("is larger than 512 MB");

  TexturedMesh mesh;
  try {
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFile(
        path, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_JoinIdenticalVertices |
                  aiProcess_FlipUVs | aiProcess_ValidateDataStructure);
    if (scene == nullptr || scene->mRootNode == nullptr) {
      std::string reason = importer.GetErrorString();
      std::replace(reason.begin(), reason.end(), '\n', ' ');
      refuse("cannot be read (" + reason + "); expected a whole mesh file");
    }
    const fs::path folder = fs::path(path).parent_path();
    for (unsigned n = 0; n < scene->mNumMaterials; ++n) {
      mesh.textures.push_back(albedo(*scene, *scene->mMaterials[n], folder));
    }
    // Assimp hands .dae and .gltf over with y up, in metres.
    Eigen::Affine3d T = Eigen::Affine3d::Identity();
    if (extension != ".obj" || unsaid == UpAxis::kY) {
      T.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    }
    add_node(*scene, *scene->mRootNode, T, mesh);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& failure) {
    refuse(std::string("cannot be read (") + failure.what() + "); expected a whole mesh file");
  }
  if (mesh.triangles.empty()) refuse("has no triangles");
  for (const std::uint32_t material : mesh.material) {
    if (material >= mesh.textures.size()) refuse("names a material that is not there");
  }
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    if (!mesh.vertices[n].allFinite()) refuse("has a vertex that is not finite");
    if (!mesh.uv[n].allFinite()) mesh.uv[n].setZero();
  }
  return mesh;
}

}  // namespace prospect

#else

namespace prospect {

TexturedMesh read_mesh_file(const std::string&, UpAxis) {
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
