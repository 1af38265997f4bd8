// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect::topic {

// Names of topics and metadata that are read back from a mission's log (docs/reference/log.md).
inline constexpr const char* kMap = "/map";
inline constexpr const char* kMapUpdates = "/map_updates";
inline constexpr const char* kPlan = "/plan";
inline constexpr const char* kMarkers = "/plan/markers";
inline constexpr const char* kFrontiers = "/plan/frontiers";
inline constexpr const char* kStep = "/plan/step";
inline constexpr const char* kCostToGo = "/plan/cost_to_go";
inline constexpr const char* kPlannerCalls = "/planner/calls";
inline constexpr const char* kPictures = "/camera/landmarks/compressed";
inline constexpr const char* kPictureFeatures = "/camera/landmarks/features";

// Metadata.
inline constexpr const char* kRun = "run";          ///< what it was started with
inline constexpr const char* kSummary = "summary";  ///< at the end
inline constexpr const char* kDropped = "dropped";  ///< at the end, messages by topic

}  // namespace prospect::topic
