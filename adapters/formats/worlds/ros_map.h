// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/worlds/load_world.h"

namespace prospect {

/// A ROS map: `path` is the .yaml (image, resolution, origin, negate, occupied_thresh, free_thresh,
/// mode: trinary, scale or raw), in the spellings that yaml-cpp takes. Further keys are left out
/// and told, unless they are nearly one of these. The image is a PGM, PBM or PPM (P1 to P6, up to
/// 16 bits), a PNG or a BMP without compression. If it is not where its name says, but a file of
/// that name is beside the .yaml, that is read and told; no other image is taken.
///
/// Pixel value v in 0..255 (grey; colour is averaged, a transparent pixel is unknown) becomes
/// occupied where p > occupied_thresh, free where p < free_thresh, else unknown, with p = (255 - v)
/// / 255, or v / 255 with negate; in mode raw p = v / 100 up to 100, above unknown. 205,
/// map_saver's value for unknown, is unknown whatever free_thresh says if the image also has white
/// pixels (>= 250), but in mode raw.
///
/// Fine maps are merged to about resolution (WorldOptions).
///
/// Occupied cells become walls of wall_height, free cells free columns over a floor, unknown cells
/// unknown columns; wall_height is rounded up to whole voxels. The origin is moved to the nearest
/// whole voxel; one more than 10 km away, as of UTM, is left out and told: W's is the lower left
/// corner then. A map with a yaw is turned into cells along the axes of W: such a cell is occupied
/// if it meets an occupied one, free if all that it meets are. start is left at the origin of W:
/// see place_start.
World world_from_ros_map(const std::string& path, const WorldOptions& options = {});

/// A bare image, pixel_size (or voxel_size, if given) metres a pixel, lower left corner at the
/// origin. A .pgm is read with map_saver's thresholds (0.65, 0.196). A .png or .bmp is a drawn
/// plan: white (>= 240) is free; grey values that fill at least 4 % of the image (and those within
/// 8 of one) are unknown; all else, and so thin grey lines and furniture, is occupied.
World world_from_image(const std::string& path, const WorldOptions& options = {});

/// A MovingAI grid (`type octile`, `height`, `width`, `map`): '.', 'G', 'S' are free, 'W' (water)
/// and everything else is occupied; pixel_size metres a cell.
World world_from_movingai(const std::string& path, const WorldOptions& options = {});

}  // namespace prospect
