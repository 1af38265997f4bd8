// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "adapters/formats/worlds/textured_mesh.h"
#include "models/camera.h"
#include "models/image.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

/// Pixels [u, u + width) x [v, v + height) of an image.
struct PixelWindow {
  int u = 0, v = 0, width = 0, height = 0;
};

/// What the centres of a window's pixels show, row by row: grey levels, depth along the optical
/// axis [m] and the cosine of the ray to the surface's normal; NaN depth: nothing is hit.
struct PixelLayer {
  std::vector<float> grey, depth, cosine;
};

struct SceneRendererOptions {
  /// Contrast of the textures, each about its own mean: 1 as they are, 0 plain.
  double texture_contrast = 1.0;
  double background = 180.0;  ///< grey where nothing is hit
  /// Share of the light that comes from everywhere; the rest depends on the surface's direction n,
  /// turned towards the camera: shade = ambient + (1 - ambient) (1 + n . light) / 2.
  double ambient = 0.6;
  Eigen::Vector3d light = {0.35, 0.2, 0.9};  ///< towards the light, in W; any length but zero
  /// Share of light that the floor reflects as a mirror, straight down: see SceneRenderer.
  double floor_shine = 0.0;
};

/// Pictures of a textured mesh by ray tracing (Embree): grey images and exact depth, from any pose.
///
/// Grey of a pixel = shade x albedo of what its centre's ray meets; the albedo is looked up
/// trilinearly in a pyramid of the texture, with up to four taps along the longer axis of the
/// pixel's footprint. Where neighbouring pixels show different triangles in different greys (8
/// levels apart), four rays of a rotated grid give the pixel's mean instead: edges are smoothed,
/// too. Pixel (u, v) of an image is the ray ((u - cx) / fx, (v - cy) / fy, 1) in C, at whole u and
/// v.
///
/// A floor that shines: the largest level surface within 10 cm of z = 0. Its grey is
///   (1 - R) grey + R mirrored,  R = min(1, floor_shine (1 + 24 (1 - c)^5)),
/// c the cosine of the ray to the vertical: Schlick's law where floor_shine is 0.04. `mirrored` is
/// what the mirrored ray meets, of every second pixel each way, six pixels wide: no floor is a
/// mirror.
///
/// Immutable: concurrent calls are safe. Deterministic: the same bits with any number of threads.
/// Errors: the constructor throws std::invalid_argument on a mesh that is not whole (indices,
/// sizes, numbers that are not finite) or options out of range, NotBuiltIn where Embree was absent;
/// pictures throw std::invalid_argument on a camera that validate() refuses or a pose that is not
/// finite.
class SceneRenderer {
 public:
  /// Keeps what it needs; the mesh may go.
  explicit SceneRenderer(const TexturedMesh& mesh, const SceneRendererOptions& options = {});
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  Image grey(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, int threads = 1) const;
  /// The same, not yet rounded: grey levels, rows without gaps.
  std::vector<float> intensity(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                               int threads = 1) const;

  /// Of a window of the image alone; edges are not smoothed, and no floor shines.
  PixelLayer look(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                  const PixelWindow& window, int threads = 1) const;

  /// Its depth alone.
  std::vector<float> depth(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC,
                           const PixelWindow& window, int threads = 1) const;

  /// Depth along the optical axis [m]; NaN, as in all depth images, where nothing is hit.
  /// `incidence`, if given, receives the cosine of each ray to the surface's normal (0..1).
  DepthImage depth(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, int threads = 1,
                   std::vector<float>* incidence = nullptr) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
