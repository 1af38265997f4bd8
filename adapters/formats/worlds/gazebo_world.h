// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/worlds/load_progress.h"
#include "adapters/formats/worlds/textured_mesh.h"

namespace prospect {

/// What a Gazebo world or model file (.world, .sdf; SDF 1.4 to 1.12) looks like: the visuals of all
/// models, with their poses and scales, in the world's frame (z up).
///
/// A visual is a mesh (read_mesh_file; an .obj is taken with z up, as Gazebo does; <submesh> is
/// kept), a box, plane, cylinder, sphere, ellipsoid, capsule, cone or polyline; of all but meshes
/// the grey is that of the material's diffuse, else ambient colour. Poses are x y z roll pitch yaw,
/// in degrees or with a quaternion if they say so, against the element that holds them or the frame
/// that they name (relative_to, attached_to, placement_frame). The last <state> of a world moves
/// its models and links, as Gazebo does; scaled models in it are refused.
///
/// `model://NAME` is the folder NAME, with the SDF that its model.config names, else model.sdf:
/// beside the file, in the folder `models` there or one or two above, in ~/.gazebo/models, or in a
/// folder of GAZEBO_MODEL_PATH or of those below; `package://NAME` and a model of Fuel are looked
/// for there by their names, too. Where they are not found, `sun` is a light and `ground_plane` a
/// plane of 100 x 100 m. `file://NAME` is, as in Gazebo, from where the program runs, then from a
/// folder of GAZEBO_RESOURCE_PATH (or `models`, `media/models`, `media` in it),
/// GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH or SDF_PATH; then from the file, the models'
/// folders, and where the world lies or one or two above. Other names are from the file first.
///
/// Told in left_out: models and meshes that are not found, included files and meshes that cannot be
/// read, with the reason, other shapes (heightmaps), lights, plug-ins, sensors, actors, the
/// collisions of links that show nothing, elements that are not known, and what read_mesh_file
/// tells. Physics and the like are not told.
///
/// Throws InputError with file and line: the file is missing or no SDF, or still to be expanded by
/// xacro; numbers that are none, frames that are not there or in a circle; <population>; models
/// that include each other, more than 20 000 models, 200 000 shapes or 20 million triangles; meshes
/// that take two minutes in vain; nothing to see. NotBuiltIn where its libraries were absent.
/// `progress` is told of the meshes that it reads.
TexturedMesh read_gazebo_world(const std::string& path, const LoadProgress& progress = {});

}  // namespace prospect
