// What a mechanism looks like beyond what its mechanics needs: outlines, names, views; from a file beside the action.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "erard/model/model.hpp"

namespace erard {

/// A rectangle of the drawing, x to the right, y up [mm].
struct Box {
  double left = 0, bottom = 0, right = 0, top = 0;
};

/// A filled outline in the frame of its body.
struct DrawnPart {
  std::string name;      // shown when pointed at
  std::string material;  // class of the style sheet web/drawing.css: maple, leather, steel ...
  std::string path;      // SVG path, y up [mm]
  std::string on;        // contact: the part sits on this body's primitive of it, moves with it and goes with it
  Vector2 at = Vector2::Zero();  // where the path's origin is, in the frame of the body or from the centre of `on` [mm]
  bool is_upright = false;       // follows the point `at`, does not turn (a damper's wire)
  int layer = 0;                 // higher ones cover lower ones
};

/// A coupling spring drawn as a coil on the parent with a leg that leans on the body.
struct SpringDrawing {
  Vector2 coil = Vector2::Zero();  // in the frame of the parent [mm]
  Vector2 to = Vector2::Zero();    // in the frame of the body [mm]
  double radius = 2.5;             // of the coil [mm]
};

struct BodyDrawing {
  std::string label;  // "repetition lever"
  std::vector<DrawnPart> parts;
  std::optional<Vector2> label_at;  // in the frame of the body [mm]
  std::optional<Box> view;          // widens the view when the body is drawn
  std::optional<SpringDrawing> spring;
};

struct FeltDrawing {
  std::string material = "felt";
  double thickness = 2;             // 0: no layer is drawn, only what is pressed [mm]
  double length = 0;                // along the surface; 0: the whole segment, or 10 mm of a circle [mm]
  std::optional<double> direction;  // middle of the felt on a circle; else where the two touch first at rest [rad]
  int layer = 0;
};

struct NamedView {
  std::string name;
  Box box;
};

/// All hints of one mechanism; empty when there is no file: then it is drawn from its primitives.
struct Drawing {
  std::optional<Box> view;
  std::vector<NamedView> views;
  BodyDrawing ground;
  std::map<std::string, BodyDrawing> bodies;          // by the body's name
  std::map<std::string, FeltDrawing> felts;           // by the contact's name
  std::map<std::string, std::string> contact_labels;  // "jack top under the knuckle"
  std::optional<DrawnPart> finger;                    // its path's origin is the tip, `at` in the frame of the key
};

/// Reads drawings/X.yaml beside the action file X.yaml, if it exists, and the plain words (`what`) that the action file
/// has for bodies and contacts.
/// Throws InputError: one sentence with file, line, key and rule.
Drawing load_drawing(const std::filesystem::path& action_file);

}  // namespace erard
