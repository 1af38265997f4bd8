// SPDX-License-Identifier: Apache-2.0
#include "models/knobs.h"
#include "perception/pipeline/feature_density.h"

namespace prospect {

void describe(Knobs& knobs, FeatureDensityOptions& o) {
  knobs.number("quantile", o.quantile, {0.0, 1.0}, "1", "of the samples that is expected");
  knobs.number("area", o.area, {0.001, 1e4}, "m2", "of new surface that makes a sample");
  knobs.integer("window", o.window, {4, 100000}, "1", "samples that count");
  knobs.number("initial", o.initial, {0.0, 1e6}, "1/m2", "until there are four samples");
}

}  // namespace prospect
