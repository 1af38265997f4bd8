// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/scene_renderer.h"

#include "adapters/formats/files/not_built_in.h"

#ifdef PROSPECT_WITH_EMBREE

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>

#include "adapters/robots/simulator/texture_kernel.h"
#include "adapters/robots/simulator/texture_pyramid.h"
#include "engine/support/worker_threads.h"

namespace prospect {
namespace {

constexpr std::uint32_t kNothing = 0xffffffffu;
constexpr int kPacket = kPacketPixels;  // rays that are traced abreast: 4 x 4 pixels
constexpr int kRayBand = 8;             // rows that a thread takes at a time
constexpr float kEdge = 8.0f;         // [grey levels] between pixels that show different triangles
constexpr float kFarthestHit = 2e5f;  // [m]; floats tell no more
constexpr float kGloss = 6.0f;        // [px] that a floor's mirror image is blurred over
constexpr std::size_t kViews = 64;    // triangles whose view a thread keeps, a power of two

// A rotated grid: its four points have different rows and different columns.
constexpr std::array<std::array<float, 2>, 4> kSubpixels = {
    {{-0.125f, -0.375f}, {0.375f, -0.125f}, {0.125f, 0.375f}, {-0.375f, 0.125f}}};

// A triangle's plane and texture as functions of a point P in W: normal . P = offset and
// uv = gradient P + origin.
struct Surface {
  Eigen::Vector3d normal;
  double offset;
  Eigen::Matrix<double, 2, 3> gradient;
  Eigen::Vector2d origin;
  std::uint32_t material;
};

// As functions of the pixel.
struct SurfaceView {
  std::uint32_t triangle = kNothing;
  TexturedView textured;
  Eigen::Vector3f normal_C;  // in C, towards the camera
};

// Rays of an image: the pixel x = (u, v, 1) looks along to_ray x, in W.
struct Rays {
  Eigen::Matrix3d to_ray;
  Eigen::Matrix3d R_WC;
  Eigen::Vector3d origin;
  int width, height;
  int u0 = 0, v0 = 0;  // the first pixel of a window
};

Rays rays_of(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC) {
  validate(camera);
  constexpr double kLargest = 16384.0;
  if (camera.width > kLargest || camera.height > kLargest || camera.width < 1.0 ||
      camera.height < 1.0) {
    throw std::invalid_argument("scene renderer: image of " + std::to_string(camera.width) + " x " +
                                std::to_string(camera.height) + ", expected 1..16384 pixels");
  }
  if (!T_WC.matrix().allFinite()) {
    throw std::invalid_argument("scene renderer: the camera's pose is not finite");
  }
  Eigen::Matrix3d inverse_K;
  inverse_K << 1.0 / camera.fx, 0.0, -camera.cx / camera.fx,  //
      0.0, 1.0 / camera.fy, -camera.cy / camera.fy,           //
      0.0, 0.0, 1.0;
  return {T_WC.linear() * inverse_K, T_WC.linear(), T_WC.translation(),
          static_cast<int>(camera.width), static_cast<int>(camera.height)};
}

// The same rays as a mirror at height h sends them on, as if they came from below it.
Rays mirrored(const Rays& rays, double h) {
  const Eigen::Vector3d up_down(1.0, 1.0, -1.0);
  Rays below = rays;
  below.to_ray = up_down.asDiagonal() * rays.to_ray;
  below.R_WC = up_down.asDiagonal() * rays.R_WC;
  below.origin.z() = 2.0 * h - rays.origin.z();
  return below;
}

Image with_contrast(const Image& image, double contrast) {
  double sum = 0.0;
  for (const std::uint8_t grey : image.pixels) sum += grey;
  const double mean = sum / static_cast<double>(std::max<std::size_t>(image.pixels.size(), 1));
  Image out = image;
  for (std::uint8_t& grey : out.pixels) {
    grey = static_cast<std::uint8_t>(std::lround(mean + contrast * (grey - mean)));
  }
  return out;
}

}  // namespace

struct SceneRenderer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  SceneRendererOptions options;
  TextureKernel kernel = texture_kernel(best_instruction_set());
  std::vector<Surface> surfaces;
  std::vector<TexturePyramid> textures;
  std::vector<std::uint8_t> shiny;  // of each triangle; empty: none is
  double floor_height = 0.0;        // [m], of those

  Impl(const TexturedMesh& mesh, const SceneRendererOptions& o) : options(o) {
    check(mesh);
    options.light.normalize();
    textures.reserve(mesh.textures.size());
    for (const Image& image : mesh.textures) {
      textures.emplace_back(
          options.texture_contrast == 1.0 ? image : with_contrast(image, options.texture_contrast));
    }
    std::vector<std::uint32_t> kept;  // triangles that have an area
    for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n) {
      if (add_surface(mesh, n)) kept.push_back(n);
    }
    if (options.floor_shine > 0.0) find_floor(mesh, kept);
    build(mesh, kept);
  }
  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void check(const TexturedMesh& mesh) const {
    const auto refuse = [](const std::string& what) {
      throw std::invalid_argument("scene renderer: " + what);
    };
    if (!(options.ambient >= 0.0 && options.ambient <= 1.0)) refuse("ambient outside 0..1");
    if (!(options.texture_contrast >= 0.0 && options.texture_contrast <= 1.0)) {
      refuse("texture_contrast outside 0..1");
    }
    if (!(options.background >= 0.0 && options.background <= 255.0)) {
      refuse("background outside 0..255");
    }
    if (!(options.floor_shine >= 0.0 && options.floor_shine <= 1.0)) {
      refuse("floor_shine outside 0..1");
    }
    if (!options.light.allFinite() || !(options.light.norm() > 0.0)) {
      refuse("light: expected a finite direction");
    }
    if (mesh.uv.size() != mesh.vertices.size()) refuse("mesh: expected as many uv as vertices");
    if (mesh.material.size() != mesh.triangles.size()) {
      refuse("mesh: expected as many materials as triangles");
    }
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
      for (const std::uint32_t v : mesh.triangles[n]) {
        if (v >= mesh.vertices.size()) {
          refuse("mesh: triangle " + std::to_string(n) + " names a vertex that is not there");
        }
      }
      if (mesh.material[n] >= mesh.textures.size()) {
        refuse("mesh: triangle " + std::to_string(n) + " names a texture that is not there");
      }
    }
    for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
      const bool sound = mesh.vertices[n].cwiseAbs().maxCoeff() < 0.5f * kFarthestHit &&
                         mesh.uv[n].cwiseAbs().maxCoeff() < 0.5f * kFarthestHit;
      if (!sound) refuse("mesh: vertex " + std::to_string(n) + " is not finite or too far away");
    }
  }

  bool add_surface(const TexturedMesh& mesh, std::uint32_t n) {
    const auto& [a, b, c] = mesh.triangles[n];
    const Eigen::Vector3d A = mesh.vertices[a].cast<double>();
    const Eigen::Vector3d e1 = mesh.vertices[b].cast<double>() - A;
    const Eigen::Vector3d e2 = mesh.vertices[c].cast<double>() - A;
    const Eigen::Vector3d N = e1.cross(e2);
    const double doubled_area = N.norm();
    if (!(doubled_area > 1e-12)) return false;
    Surface surface;
    surface.normal = N / doubled_area;
    surface.offset = surface.normal.dot(A);
    // Dual basis of the edges: e1 . b1 = 1, e2 . b1 = 0 and so on.
    const Eigen::Vector3d b1 = e2.cross(N) / (doubled_area * doubled_area);
    const Eigen::Vector3d b2 = N.cross(e1) / (doubled_area * doubled_area);
    const Eigen::Vector2d uv = mesh.uv[a].cast<double>();
    surface.gradient = (mesh.uv[b].cast<double>() - uv) * b1.transpose() +
                       (mesh.uv[c].cast<double>() - uv) * b2.transpose();
    surface.origin = uv - surface.gradient * A;
    surface.material = mesh.material[n];
    surfaces.push_back(surface);
    return true;
  }

  void find_floor(const TexturedMesh& mesh, const std::vector<std::uint32_t>& kept) {
    constexpr double kReach = 0.1, kSame = 0.002;  // [m]
    const auto height = [](const Surface& s) { return s.offset / s.normal.z(); };
    const auto level = [&](const Surface& s) {
      return std::abs(s.normal.z()) > 0.999 && std::abs(height(s)) < kReach;
    };
    std::map<long, double> areas;  // by the height, in steps of kSame
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
      if (!level(surfaces[n])) continue;
      const auto& [a, b, c] = mesh.triangles[kept[n]];
      const Eigen::Vector3f e1 = mesh.vertices[b] - mesh.vertices[a];
      const Eigen::Vector3f e2 = mesh.vertices[c] - mesh.vertices[a];
      areas[std::lround(height(surfaces[n]) / kSame)] += e1.cross(e2).norm();
    }
    if (areas.empty()) return;
    const auto largest =
        std::max_element(areas.begin(), areas.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    floor_height = kSame * static_cast<double>(largest->first);
    shiny.assign(surfaces.size(), 0);
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
      shiny[n] = level(surfaces[n]) && std::abs(height(surfaces[n]) - floor_height) < kSame;
    }
  }

  bool shines(std::uint32_t triangle) const { return triangle != kNothing && shiny[triangle] != 0; }

  void build(const TexturedMesh& mesh, const std::vector<std::uint32_t>& kept) {
    device = rtcNewDevice(nullptr);
    if (device == nullptr) throw std::runtime_error("scene renderer: Embree gives no device");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    if (!kept.empty()) {
      RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                  3 * sizeof(float), mesh.vertices.size()));
      auto* indices = static_cast<std::uint32_t*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                  3 * sizeof(std::uint32_t), kept.size()));
      if (vertices == nullptr || indices == nullptr) {
        rtcReleaseGeometry(geometry);
        throw std::runtime_error("scene renderer: Embree has no memory for the mesh");
      }
      for (const Eigen::Vector3f& p : mesh.vertices) vertices = std::copy_n(p.data(), 3, vertices);
      for (const std::uint32_t n : kept) {
        indices = std::copy_n(mesh.triangles[n].data(), 3, indices);
      }
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE) {
      throw std::runtime_error("scene renderer: Embree reports error " + std::to_string(error));
    }
  }

  SurfaceView view(const Rays& rays, std::uint32_t triangle) const {
    const Surface& surface = surfaces[triangle];
    // The camera's distance to the plane; a plane through the camera shows no pixel.
    double distance = surface.offset - surface.normal.dot(rays.origin);
    if (std::abs(distance) < 1e-9) distance = 1e-9;
    const Eigen::Vector3d inverse_depth = rays.to_ray.transpose() * surface.normal / distance;
    const Eigen::Vector2d at_camera = surface.gradient * rays.origin + surface.origin;
    const Eigen::Vector3d towards = distance < 0.0 ? surface.normal : -surface.normal;
    SurfaceView view;
    view.triangle = triangle;
    TexturedView& textured = view.textured;
    textured.inverse_depth = inverse_depth.cast<float>();
    textured.s = (at_camera.x() * inverse_depth +
                  rays.to_ray.transpose() * surface.gradient.row(0).transpose())
                     .cast<float>();
    textured.t = (at_camera.y() * inverse_depth +
                  rays.to_ray.transpose() * surface.gradient.row(1).transpose())
                     .cast<float>();
    view.normal_C = (rays.R_WC.transpose() * towards).cast<float>();
    textured.shade = static_cast<float>(options.ambient + (1.0 - options.ambient) * 0.5 *
                                                              (1.0 + towards.dot(options.light)));
    const TexturePyramid& texture = textures[surface.material];
    textured.texels = texture.texels();
    textured.width = static_cast<float>(texture.width());
    textured.height = static_cast<float>(texture.height());
    return view;
  }

  // The views that a thread has met last; neighbouring pixels mostly show the same triangle.
  struct ViewCache {
    std::array<SurfaceView, kViews> views;
    const SurfaceView& get(const Impl& impl, const Rays& rays, std::uint32_t triangle) {
      SurfaceView& view = views[triangle % kViews];
      if (view.triangle != triangle) view = impl.view(rays, triangle);
      return view;
    }
  };

  static std::span<const std::uint32_t> first(const std::uint32_t* triangles, int count) {
    return {triangles, static_cast<std::size_t>(count)};
  }

  // Greys of the squares of `size` pixels about a packet's pixels, which show these triangles.
  void look_up(ViewCache& cache, const Rays& rays, std::span<const std::uint32_t> triangles,
               const float* u, const float* v, float size, float* grey) const {
    alignas(64) float of_one[kPacket];
    std::uint32_t left = (1u << triangles.size()) - 1u;  // pixels that are to be looked up
    while (left != 0) {
      const std::uint32_t triangle = triangles[static_cast<std::size_t>(std::countr_zero(left))];
      if (triangle != kNothing)
        kernel(cache.get(*this, rays, triangle).textured, u, v, size, of_one);
      for (std::size_t n = 0; n < triangles.size(); ++n) {
        if (triangles[n] != triangle) continue;
        grey[n] = triangle == kNothing ? static_cast<float>(options.background) : of_one[n];
        left &= ~(1u << n);
      }
    }
  }

  // The triangle that each of a packet's rays, through (u, v), meets first, from the depths `near`
  // on, if given.
  void trace(const Rays& rays, const float* u, const float* v, int count, std::uint32_t* triangles,
             const float* near = nullptr) const {
    alignas(64) RTCRayHit16 packet;
    alignas(64) int valid[kPacket];
    const Eigen::Matrix3f A = rays.to_ray.cast<float>();
    const Eigen::Vector3f origin = rays.origin.cast<float>();
    for (int n = 0; n < kPacket; ++n) {
      const int m = n < count ? n : 0;
      valid[n] = n < count ? -1 : 0;
      packet.ray.org_x[n] = origin.x();
      packet.ray.org_y[n] = origin.y();
      packet.ray.org_z[n] = origin.z();
      packet.ray.dir_x[n] = A(0, 0) * u[m] + A(0, 1) * v[m] + A(0, 2);
      packet.ray.dir_y[n] = A(1, 0) * u[m] + A(1, 1) * v[m] + A(1, 2);
      packet.ray.dir_z[n] = A(2, 0) * u[m] + A(2, 1) * v[m] + A(2, 2);
      packet.ray.tnear[n] = near != nullptr ? near[m] : 1e-4f;
      packet.ray.tfar[n] = 1e6f;
      packet.ray.time[n] = 0.0f;
      packet.ray.mask[n] = 0xffffffffu;
      packet.ray.id[n] = 0;
      packet.ray.flags[n] = 0;
      packet.hit.geomID[n] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.primID[n] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][n] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &context, &packet);
    for (int n = 0; n < count; ++n) {
      triangles[n] =
          packet.hit.geomID[n] == RTC_INVALID_GEOMETRY_ID ? kNothing : packet.hit.primID[n];
    }
  }

  // Up to 4 x 4 pixels and what they show; places in the image.
  struct Packet {
    int count = 0;
    alignas(64) float u[kPacket] = {}, v[kPacket] = {};
    std::size_t at[kPacket];
    std::uint32_t triangles[kPacket];
  };

  // visit(cache, packet) for all pixels, bands of rows in parallel.
  template <typename Visitor>
  void each_packet(const Rays& rays, int threads, const Visitor& visit) const {
    const int bands = (rays.height + kRayBand - 1) / kRayBand;
    WorkerThreads(threads).run(bands, [&](int band) {
      ViewCache cache;
      Packet packet;
      const int end = std::min(rays.height, (band + 1) * kRayBand);
      for (int v0 = band * kRayBand; v0 < end; v0 += 4) {
        const int rows = std::min(4, end - v0);
        for (int u0 = 0; u0 < rays.width; u0 += 4) {
          const int columns = std::min(4, rays.width - u0);
          packet.count = 0;
          for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column, ++packet.count) {
              packet.u[packet.count] = static_cast<float>(rays.u0 + u0 + column);
              packet.v[packet.count] = static_cast<float>(rays.v0 + v0 + row);
              packet.at[packet.count] =
                  static_cast<std::size_t>((v0 + row) * rays.width + u0 + column);
            }
          }
          trace(rays, packet.u, packet.v, packet.count, packet.triangles);
          visit(cache, packet);
        }
      }
    });
  }

  // measure(view, place in the image, in the packet, z) for each pixel that shows something, at the
  // depth z.
  template <typename Measure>
  void each_depth(const Rays& rays, ViewCache& cache, const Packet& packet,
                  const Measure& measure) const {
    for (int n = 0; n < packet.count; ++n) {
      if (packet.triangles[n] == kNothing) continue;
      const float u = packet.u[n], v = packet.v[n];
      const SurfaceView& view = cache.get(*this, rays, packet.triangles[n]);
      const Eigen::Vector3f& f = view.textured.inverse_depth;
      const float z = 1.0f / (f[0] * u + f[1] * v + f[2]);
      // Edge-on: rounding alone.
      if (z > 0.0f && z < kFarthestHit) measure(view, packet.at[n], n, z);
    }
  }

  std::vector<float> intensity(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                               int threads) const {
    const Rays rays = rays_of(camera, T_WC);
    const auto size = static_cast<std::size_t>(rays.width) * static_cast<std::size_t>(rays.height);
    std::vector<float> centres(size);
    std::vector<std::uint32_t> shown(size);
    each_packet(rays, threads, [&](ViewCache& cache, const Packet& packet) {
      float grey[kPacket];
      look_up(cache, rays, first(packet.triangles, packet.count), packet.u, packet.v, 1.0f, grey);
      for (int n = 0; n < packet.count; ++n) {
        shown[packet.at[n]] = packet.triangles[n];
        centres[packet.at[n]] = grey[n];
      }
    });
    // Edges. What is written must not be what a neighbour reads.
    std::vector<float> grey = centres;
    const int bands = (rays.height + kRayBand - 1) / kRayBand;
    const auto stride = static_cast<std::size_t>(rays.width);
    WorkerThreads(threads).run(bands, [&](int band) {
      ViewCache cache;
      constexpr int kSubs = static_cast<int>(kSubpixels.size());
      constexpr int kPixels = kPacket / kSubs;  // in a packet
      std::size_t pending[kPixels];
      int pixels = 0;
      const auto flush = [&] {
        if (pixels == 0) return;
        float u[kPacket] = {}, v[kPacket] = {};
        std::uint32_t triangles[kPacket];
        for (int p = 0; p < pixels; ++p) {
          for (int k = 0; k < kSubs; ++k) {
            const auto sub = kSubpixels[static_cast<std::size_t>(k)];
            u[p * kSubs + k] = static_cast<float>(pending[p] % stride) + sub[0];
            v[p * kSubs + k] = static_cast<float>(pending[p] / stride) + sub[1];
          }
        }
        trace(rays, u, v, pixels * kSubs, triangles);
        float greys[kPacket];
        look_up(cache, rays, first(triangles, pixels * kSubs), u, v, 0.5f, greys);
        for (int p = 0; p < pixels; ++p) {
          float sum = 0.0f;
          for (int n = p * kSubs; n < (p + 1) * kSubs; ++n) sum += greys[n];
          grey[pending[p]] = sum / static_cast<float>(kSubs);
        }
        pixels = 0;
      };
      const auto edge = [&](std::size_t a, std::size_t b) {
        return shown[a] != shown[b] && std::abs(centres[a] - centres[b]) > kEdge;
      };
      for (int v = band * kRayBand; v < std::min(rays.height, (band + 1) * kRayBand); ++v) {
        for (int u = 0; u < rays.width; ++u) {
          const std::size_t at = static_cast<std::size_t>(v) * stride + static_cast<std::size_t>(u);
          if ((u > 0 && edge(at, at - 1)) || (u + 1 < rays.width && edge(at, at + 1)) ||
              (v > 0 && edge(at, at - stride)) || (v + 1 < rays.height && edge(at, at + stride))) {
            pending[pixels++] = at;
            if (pixels == kPixels) flush();
          }
        }
      }
      flush();
    });
    if (!shiny.empty()) add_shine(rays, threads, shown, grey);
    return grey;
  }

  // What the floor mirrors, at every second pixel each way; NaN beside the floor.
  std::vector<float> mirror_image(const Rays& rays, int threads,
                                  const std::vector<std::uint32_t>& shown) const {
    const Rays below = mirrored(rays, floor_height);
    const int columns = (rays.width + 1) / 2, rows = (rays.height + 1) / 2;
    std::vector<float> mirror(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
                              std::numeric_limits<float>::quiet_NaN());
    const double drop = floor_height - rays.origin.z();
    const int bands = (rows + kRayBand - 1) / kRayBand;
    WorkerThreads(threads).run(bands, [&](int band) {
      ViewCache cache;
      float u[kPacket] = {}, v[kPacket] = {}, near[kPacket] = {};
      std::size_t at[kPacket] = {};
      int count = 0;
      const auto flush = [&] {
        std::uint32_t triangles[kPacket] = {};
        float greys[kPacket];
        if (count > 0) {
          trace(below, u, v, count, triangles, near);
          look_up(cache, below, first(triangles, count), u, v, kGloss, greys);
        }
        for (int n = 0; n < count; ++n) mirror[at[n]] = greys[n];
        count = 0;
      };
      for (int j = band * kRayBand; j < std::min(rows, (band + 1) * kRayBand); ++j) {
        for (int i = 0; i < columns; ++i) {
          if (!shines(shown[static_cast<std::size_t>(2 * j * rays.width + 2 * i)])) continue;
          u[count] = static_cast<float>(2 * i);
          v[count] = static_cast<float>(2 * j);
          // Of depth 1, so the ray's parameter is the depth at which it meets the floor.
          const double depth =
              drop / rays.to_ray.row(2).dot(Eigen::Vector3d(2.0 * i, 2.0 * j, 1.0));
          near[count] = static_cast<float>(1.0001 * depth + 0.001);
          at[count] = static_cast<std::size_t>(j * columns + i);
          if (++count == kPacket) flush();
        }
      }
      flush();
    });
    return mirror;
  }

  void add_shine(const Rays& rays, int threads, const std::vector<std::uint32_t>& shown,
                 std::vector<float>& grey) const {
    const std::vector<float> mirror = mirror_image(rays, threads, shown);
    const int columns = (rays.width + 1) / 2, rows = (rays.height + 1) / 2;
    const Eigen::Matrix3f A = rays.to_ray.cast<float>();
    const auto shine = static_cast<float>(options.floor_shine);
    const int bands = (rays.height + kRayBand - 1) / kRayBand;
    WorkerThreads(threads).run(bands, [&](int band) {
      for (int v = band * kRayBand; v < std::min(rays.height, (band + 1) * kRayBand); ++v) {
        for (int u = 0; u < rays.width; ++u) {
          const auto at = static_cast<std::size_t>(v * rays.width + u);
          if (!shines(shown[at])) continue;
          // The mean of the points of the mirror image about it that lie on the floor.
          float sum = 0.0f;
          int count = 0;
          for (int j = v / 2; j <= std::min((v + 1) / 2, rows - 1); ++j) {
            for (int i = u / 2; i <= std::min((u + 1) / 2, columns - 1); ++i) {
              const float m = mirror[static_cast<std::size_t>(j * columns + i)];
              if (std::isnan(m)) continue;
              sum += m;
              ++count;
            }
          }
          if (count == 0) continue;
          const Eigen::Vector3f ray =
              A * Eigen::Vector3f(static_cast<float>(u), static_cast<float>(v), 1.0f);
          const float past = 1.0f - std::abs(ray.z()) / ray.norm();
          const float power = past * past * past * past * past;
          const float share = std::min(1.0f, shine * (1.0f + 24.0f * power));
          grey[at] += share * (sum / static_cast<float>(count) - grey[at]);
        }
      }
    });
  }

  static Rays rays_of_window(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                             const PixelWindow& window) {
    Rays rays = rays_of(camera, T_WC);
    if (window.u < 0 || window.v < 0 || window.width < 0 || window.height < 0 ||
        window.width > rays.width - window.u || window.height > rays.height - window.v) {
      throw std::invalid_argument("scene renderer: a window beyond the image");
    }
    rays.u0 = window.u;
    rays.v0 = window.v;
    rays.width = window.width;
    rays.height = window.height;
    return rays;
  }

  std::vector<float> depth_of_window(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                                     const PixelWindow& window, int threads) const {
    const Rays rays = rays_of_window(camera, T_WC, window);
    std::vector<float> depth(
        static_cast<std::size_t>(rays.width) * static_cast<std::size_t>(rays.height),
        DepthImage::kInvalid);
    each_packet(rays, threads, [&](ViewCache& cache, const Packet& packet) {
      each_depth(rays, cache, packet,
                 [&](const SurfaceView&, std::size_t at, int, float z) { depth[at] = z; });
    });
    return depth;
  }

  PixelLayer look(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                  const PixelWindow& window, int threads) const {
    const Rays rays = rays_of_window(camera, T_WC, window);
    const auto size = static_cast<std::size_t>(rays.width) * static_cast<std::size_t>(rays.height);
    PixelLayer layer{std::vector<float>(size, static_cast<float>(options.background)),
                     std::vector<float>(size, DepthImage::kInvalid),
                     std::vector<float>(size, 0.0f)};
    const Eigen::Matrix3f to_C = (rays.R_WC.transpose() * rays.to_ray).cast<float>();
    each_packet(rays, threads, [&](ViewCache& cache, const Packet& packet) {
      float grey[kPacket];
      const auto nothing = [](std::uint32_t triangle) { return triangle == kNothing; };
      if (std::all_of(packet.triangles, packet.triangles + packet.count, nothing)) return;
      look_up(cache, rays, first(packet.triangles, packet.count), packet.u, packet.v, 1.0f, grey);
      each_depth(rays, cache, packet, [&](const SurfaceView& view, std::size_t at, int n, float z) {
        const Eigen::Vector3f ray = to_C * Eigen::Vector3f(packet.u[n], packet.v[n], 1.0f);
        layer.grey[at] = grey[n];
        layer.depth[at] = z;
        layer.cosine[at] = std::abs(view.normal_C.dot(ray)) / ray.norm();
      });
    });
    return layer;
  }

  DepthImage depth(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, int threads,
                   std::vector<float>* incidence) const {
    const Rays rays = rays_of(camera, T_WC);
    DepthImage image(rays.width, rays.height);
    if (incidence != nullptr) incidence->assign(image.depth.size(), 0.0f);
    const auto inverse_fx = static_cast<float>(1.0 / camera.fx);
    const auto inverse_fy = static_cast<float>(1.0 / camera.fy);
    const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
    each_packet(rays, threads, [&](ViewCache& cache, const Packet& packet) {
      each_depth(rays, cache, packet, [&](const SurfaceView& view, std::size_t at, int k, float z) {
        image.depth[at] = z;
        if (incidence == nullptr) return;
        const float x = (packet.u[k] - cx) * inverse_fx, y = (packet.v[k] - cy) * inverse_fy;
        const Eigen::Vector3f& n = view.normal_C;
        (*incidence)[at] = std::abs(n[0] * x + n[1] * y + n[2]) / std::sqrt(x * x + y * y + 1.0f);
      });
    });
    return image;
  }
};

SceneRenderer::SceneRenderer(const TexturedMesh& mesh, const SceneRendererOptions& options)
    : impl_(std::make_unique<Impl>(mesh, options)) {}

std::vector<float> SceneRenderer::intensity(const PinholeCamera& camera,
                                            const Eigen::Isometry3d& T_WC, int threads) const {
  return impl_->intensity(camera, T_WC, threads);
}

PixelLayer SceneRenderer::look(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                               const PixelWindow& window, int threads) const {
  return impl_->look(camera, T_WC, window, threads);
}

std::vector<float> SceneRenderer::depth(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                                        const PixelWindow& window, int threads) const {
  return impl_->depth_of_window(camera, T_WC, window, threads);
}

DepthImage SceneRenderer::depth(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                                int threads, std::vector<float>* incidence) const {
  return impl_->depth(camera, T_WC, threads, incidence);
}

Image SceneRenderer::grey(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                          int threads) const {
  const std::vector<float> grey = intensity(camera, T_WC, threads);
  Image image(static_cast<int>(camera.width), static_cast<int>(camera.height));
  std::transform(grey.begin(), grey.end(), image.pixels.begin(), [](float g) {
    return static_cast<std::uint8_t>(std::clamp(g, 0.0f, 255.0f) + 0.5f);
  });
  return image;
}

}  // namespace prospect

#else

namespace prospect {

struct SceneRenderer::Impl {};
SceneRenderer::SceneRenderer(const TexturedMesh&, const SceneRendererOptions&) {
  throw NotBuiltIn("rendering of cameras", "Embree 3 (libembree-dev)");
}
std::vector<float> SceneRenderer::intensity(const PinholeCamera&, const Eigen::Isometry3d&,
                                            int) const {
  return {};
}
PixelLayer SceneRenderer::look(const PinholeCamera&, const Eigen::Isometry3d&, const PixelWindow&,
                               int) const {
  return {};
}
std::vector<float> SceneRenderer::depth(const PinholeCamera&, const Eigen::Isometry3d&,
                                        const PixelWindow&, int) const {
  return {};
}
DepthImage SceneRenderer::depth(const PinholeCamera&, const Eigen::Isometry3d&, int,
                                std::vector<float>*) const {
  return {};
}
Image SceneRenderer::grey(const PinholeCamera&, const Eigen::Isometry3d&, int) const { return {}; }

}  // namespace prospect

#endif

namespace prospect {
SceneRenderer::~SceneRenderer() = default;
}  // namespace prospect
