#pragma once

#include <Eigen/Geometry>
#include <string>

#include "adapters/worlds/textured_mesh.h"

namespace prospect {

/// The direction that is up in a file that does not say.
enum class UpAxis { kY, kZ };

/// A mesh file through Assimp: .obj, .dae, .gltf, .glb. All nodes with their transforms, polygons
/// as triangles, in metres with z up.
///
/// Unit and up axis are those that the file states (.dae), or its format (.gltf, .glb: metres, y);
/// an .obj says nothing: metres, and `unsaid` is up. y up becomes z up by (x, y, z) -> (x, -z, y).
/// The albedo is the grey of the diffuse or base colour texture (beside the file, inside it, or in
/// ../materials/textures), else that colour. A texture that is missing or cannot be read is taken
/// for the plain colour: copies of meshes often lack some. Transparency, normal maps and the like
/// are left out, as are points, lines, cameras, lights and animations.
///
/// Throws InputError: the file is missing, empty, larger than 512 MB, of another kind, cannot be
/// read, or has no triangles or numbers that are not finite; NotBuiltIn where Assimp was absent.
TexturedMesh read_mesh_file(const std::string& path, UpAxis unsaid = UpAxis::kY);

/// Adds a moved copy of `part`'s triangles, which use whole.textures from first_texture on where
/// they use part.textures from 0 on. A mirroring T keeps what is the outside of each triangle.
void append_triangles(const TexturedMesh& part, const Eigen::Affine3d& T,
                      std::uint32_t first_texture, TexturedMesh& whole);

}  // namespace prospect
