#include <iostream>
#include <nlohmann/json.hpp>

#include "adapters/cli/commands.h"
#include "adapters/datasets/inspection.h"

namespace prospect {

int inspect(const InspectArguments& arguments) {
  Found found = Found::kUnknown;
  DepthDatasetOptions depth = arguments.depth;
  depth.topics = arguments.stereo.topics;
  const auto json = inspect_path(arguments.path, arguments.stereo, depth, found);
  std::cout << (arguments.json ? json.dump(2) + "\n" : inspection_text(json));
  return found == Found::kUsable ? kDone : found == Found::kIncomplete ? kFailed : kBadInput;
}

}  // namespace prospect
