// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "models/image.h"

namespace prospect {

/// Standard deviation of the noise of an image's pixels [grey levels], from what its surfaces and
/// straight edges do not show: the difference of second differences
///   L = [1 -2 1]^T [1 -2 1] * I,
/// which noise of deviation s makes 6 s (Immerkaer 1996), at every third pixel of every third row.
/// Texture makes some of them larger, so the lower quartile of |L| tells. At least that of rounding
/// to whole grey levels, 0.29. Deterministic; no state.
double image_noise(const ImageView& image);

}  // namespace prospect
