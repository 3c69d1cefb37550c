// A mechanism ready to be drawn: what the report's page and the SVG writer both place on the paper.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/drawing.hpp"
#include "erard/device/simulation.hpp"

namespace erard {

// the same numbers on the page and in the SVG
inline constexpr double kFeltMagnification = 5;  // compressions are drawn that much larger [-]
inline constexpr double kArrowLength = 7;        // of a force of 1 N, growing with its square root [mm/sqrt(N)]

/// A part of the picture with its place, in drawing order.
struct ScenePart {
  int body = kGround;
  DrawnPart part;  // `on` resolved into `at`
};

/// Everything that does not change while the mechanism moves. Lengths in the model in m, in the parts in mm.
struct Scene {
  Model model;
  ActionRoles roles;
  std::vector<ScenePart> parts;
  std::vector<std::string> body_label;
  std::vector<std::string> contact_label;
  std::vector<std::optional<Vector2>> label_at;      // of each body [mm]
  std::vector<std::optional<SpringDrawing>> spring;  // of each body
  std::vector<bool> is_hidden;                       // bodies out of play: held and touching nothing
  std::optional<DrawnPart> finger;
  Box view;
  std::vector<NamedView> views;
};

/// Puts model and hints together. Bodies without hints get bones from their joint to their primitives; felts get pads.
Scene build_scene(const ActionFile& action, const Drawing& drawing);

/// The scene as one JSON object; its keys are explained in web/scene.js.
std::string scene_json(const Scene& scene);

/// One pose as an SVG document that needs nothing else: forces, contacts open, closed, sticking and sliding, pressed felts.
/// @param caption  one line under the picture; may be empty
std::string draw_svg(const Scene& scene, const Snapshot& pose, DriveKind drive, const std::string& caption);

/// Coordinates of the bodies (relative) from the absolute angles of a snapshot.
CoordinateVector body_coordinates(const Model& model, const std::vector<double>& absolute_angle);

}  // namespace erard
