// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "adapters/formats/worlds/load_progress.h"
#include "adapters/formats/worlds/textured_mesh.h"
#include "adapters/formats/worlds/up_axis.h"

namespace prospect {

/// The part of a mesh file that is meant; without a name, all of it.
struct Submesh {
  std::string name;      ///< of a mesh or a node with meshes in the file
  bool centred = false;  ///< moved so that the middle of its bounding box is the origin
};

/// Whether a file is of a kind that read_mesh_file() reads, by its extension, in any case.
bool is_mesh_file(const std::string& path);

/// A mesh file through Assimp: .obj, .dae, .gltf, .glb, .stl, .ply. All nodes with their
/// transforms, polygons as triangles, in metres with z up.
///
/// Unit and up axis are those that the file states (.dae), or its format (.gltf, .glb: metres, y);
/// .stl and .ply say nothing: metres, z; an .obj says nothing: metres, and `unsaid` is up. With
/// `up` that axis of the file's own coordinates is up, whatever it says. y up becomes z up by (x,
/// y, z)
/// -> (x, -z, y), x up by (x, y, z) -> (-y, -z, x).
/// A COLLADA is read as plain_collada.h makes it.
/// The albedo is the grey of the diffuse or base colour texture (beside the file, inside it, or in
/// ../materials/textures), else that colour. Copies of meshes often lack textures: one that is
/// missing or cannot be read is taken for the plain colour, and told in left_out, as is a missing
/// material file, and what else the file holds: points, lines, free-form curves and surfaces,
/// cameras, lights, animations, vertex colours, extensions and further scenes of a glTF.
/// Backslashes in the names of files separate folders. Transparency, normal maps and the like are
/// left out without a word.
///
/// The library runs in a child process that is limited in memory (1 GB and 40 times the file's
/// size, at most 4 GB) and time (20 s and 1 s a MB, at most two minutes).
///
/// `progress` is told every now and then how long it takes.
///
/// Throws InputError: the file is missing, empty, larger than 512 MB, of another kind, cannot be
/// read within the limits, has no triangles or numbers that are not finite; what gltf_check.h and
/// mesh_check.h refuse, since the library would read it wrong; no such submesh. NotBuiltIn where
/// Assimp was absent.
TexturedMesh read_mesh_file(const std::string& path, UpAxis unsaid = UpAxis::kY,
                            const Submesh& submesh = {}, const LoadProgress& progress = {},
                            const std::optional<UpAxis>& up = {});

/// Adds a moved copy of `part`'s triangles, which use whole.textures from first_texture on where
/// they use part.textures from 0 on. A mirroring T keeps what is the outside of each triangle.
void append_triangles(const TexturedMesh& part, const Eigen::Affine3d& T,
                      std::uint32_t first_texture, TexturedMesh& whole);

}  // namespace prospect
