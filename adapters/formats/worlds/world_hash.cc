// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/world_hash.h"

#include "adapters/formats/files/content_hash.h"
#include "adapters/formats/worlds/textured_mesh.h"

namespace prospect {
namespace {

template <typename T>
void add_all(ContentHash& hash, const std::vector<T>& values) {
  hash.add(static_cast<std::uint64_t>(values.size()));
  hash.add(values.data(), values.size() * sizeof(T));
}

void add(ContentHash& hash, const TexturedMesh& mesh) {
  add_all(hash, mesh.vertices);
  add_all(hash, mesh.uv);
  add_all(hash, mesh.triangles);
  add_all(hash, mesh.material);
  for (const Image& image : mesh.textures) {
    hash.add(static_cast<std::uint64_t>(image.width)).add(static_cast<std::uint64_t>(image.height));
    add_all(hash, image.pixels);
  }
}

}  // namespace

std::uint64_t world_hash(const World& world) {
  ContentHash hash;
  const VoxelGrid& voxels = world.voxels;
  const GridFrame& frame = voxels.frame();
  hash.add(frame.resolution);
  for (const int n : {frame.i0, frame.j0, frame.width, frame.height, voxels.k0(), voxels.depth()}) {
    hash.add(static_cast<std::uint64_t>(static_cast<std::int64_t>(n)));
  }
  add_all(hash, voxels.data());
  add_all(hash, world.texture_density);
  add_all(hash, world.texture_class);
  for (const double x : {world.start.position.x(), world.start.position.y(),
                         world.start.position.z(), world.start.yaw}) {
    hash.add(x);
  }
  if (world.mesh) add(hash, *world.mesh);
  for (const Slope& slope : world.slopes) {
    for (const double x : {slope.low.x(), slope.low.y(), slope.high.x(), slope.high.y(),
                           slope.height, slope.rise.x(), slope.rise.y()}) {
      hash.add(x);
    }
  }
  return hash.value();
}

}  // namespace prospect
