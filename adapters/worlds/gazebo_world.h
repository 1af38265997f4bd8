#pragma once

#include <string>

#include "adapters/worlds/textured_mesh.h"

namespace prospect {

/// What a Gazebo world or model file (.world, .sdf; SDF 1.4 to 1.7) looks like: the visuals of all
/// models, with their poses and scales, in the world's frame (z up).
///
/// A visual is a mesh (read_mesh_file; an .obj is taken with z up, as Gazebo does), a box, a plane
/// or a cylinder; of the last three the grey is that of the material's diffuse, else ambient
/// colour. Poses are x y z roll pitch yaw against the element that holds them. `model://NAME` is
/// the folder NAME with a model.sdf: beside the file, in the folder `models` there or one above, or
/// in a folder of GAZEBO_MODEL_PATH; other names are relative to the file. Lights, collisions,
/// physics and plug-ins are left out.
///
/// Throws InputError with file and line: the file is missing or no SDF; a model or mesh is missing;
/// poses that are not six numbers or are relative to a named frame; other shapes; models that
/// include each other; nothing to see. NotBuiltIn where its libraries were absent.
TexturedMesh read_gazebo_world(const std::string& path);

}  // namespace prospect
