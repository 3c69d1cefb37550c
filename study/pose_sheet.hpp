// Poses of an action side by side on one sheet.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "erard/device/scene.hpp"

namespace erard::study {

struct Pose {
  Snapshot snapshot;
  std::string caption;  // one line
};

/// Draws the grand action in each pose into one SVG file, row by row: forces, contacts and pressed felts as draw_svg().
/// @param view  what of the action is shown [mm]
void draw_poses(const std::filesystem::path& svg, const ActionFile& action, const std::vector<Pose>& poses,
                DriveKind drive, const Box& view, int columns);

}  // namespace erard::study
