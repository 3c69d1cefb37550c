#include "erard/device/drawing.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "erard/device/error.hpp"

namespace erard {
namespace {

constexpr double kDegree = 0.017453292519943295;  // [rad/deg]

/// Reads one file of hints and tells where it is wrong.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  Drawing read() {
    Drawing drawing;
    const YAML::Node root = load();
    check_keys(root, "the file", {"view_mm", "views", "ground", "bodies", "felts", "finger"});
    if (root["view_mm"]) drawing.view = box(root["view_mm"]);
    for (const auto& entry : root["views"]) drawing.views.push_back({entry.first.as<std::string>(), box(entry.second)});
    if (root["ground"]) drawing.ground = body(root["ground"]);
    for (const auto& entry : root["bodies"]) drawing.bodies[entry.first.as<std::string>()] = body(entry.second);
    for (const auto& entry : root["felts"]) drawing.felts[entry.first.as<std::string>()] = felt(entry.second);
    if (root["finger"]) drawing.finger = part(root["finger"]);
    return drawing;
  }

 private:
  [[noreturn]] void reject(const YAML::Node& node, const std::string& rule) const {
    throw InputError(fmt::format("{}:{}: {}", file_.string(), node.Mark().line + 1, rule));
  }

  YAML::Node load() const {
    try {
      return YAML::LoadFile(file_.string());
    } catch (const YAML::Exception& error) {
      throw InputError(fmt::format("{}:{}: {}", file_.string(), error.mark.line + 1, error.msg));
    }
  }

  void check_keys(const YAML::Node& node, std::string_view what, std::initializer_list<std::string_view> known) const {
    if (!node.IsMap()) reject(node, fmt::format("{} must be a list of keys and values", what));
    for (const auto& entry : node) {
      const auto key = entry.first.as<std::string>();
      if (std::find(known.begin(), known.end(), key) == known.end())
        reject(entry.first, fmt::format("{}: unknown key of {}, must be one of {}", key, what, fmt::join(known, ", ")));
    }
  }

  double number(const YAML::Node& node) const {
    double value = NAN;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value))
      reject(node, "must be a finite number");
    return value;
  }

  std::string text(const YAML::Node& node) const {
    if (!node.IsScalar()) reject(node, "must be a text");
    return node.Scalar();
  }

  Vector2 point(const YAML::Node& node) const {
    if (!node.IsSequence() || node.size() != 2) reject(node, "must be two numbers [x, y] in mm");
    return {number(node[0]), number(node[1])};
  }

  Box box(const YAML::Node& node) const {
    if (!node.IsSequence() || node.size() != 4) reject(node, "must be four numbers [left, bottom, right, top] in mm");
    const Box result{number(node[0]), number(node[1]), number(node[2]), number(node[3])};
    if (result.right <= result.left || result.top <= result.bottom)
      reject(node, "must have left < right and bottom < top");
    return result;
  }

  std::string path(const YAML::Node& node) const {
    std::string result = text(node);
    if (result.empty() || result[0] != 'M' ||
        result.find_first_not_of("MmLlHhVvCcSsQqTtAaZz0123456789.,+- \n") != std::string::npos)
      reject(node, "must be an SVG path that starts with M, in mm, y up");
    return result;
  }

  DrawnPart part(const YAML::Node& node) const {
    check_keys(node, "a part", {"name", "material", "path_mm", "on", "at_mm", "upright", "layer"});
    DrawnPart result;
    if (!node["path_mm"]) reject(node, "a part must have path_mm");
    result.path = path(node["path_mm"]);
    if (node["name"]) result.name = text(node["name"]);
    result.material = node["material"] ? text(node["material"]) : "wood";
    if (result.material.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") != std::string::npos)
      reject(node["material"], "must be a name of small letters");
    if (node["on"]) result.on = text(node["on"]);
    if (node["at_mm"]) result.at = point(node["at_mm"]);
    if (node["upright"] && !YAML::convert<bool>::decode(node["upright"], result.is_upright))
      reject(node["upright"], "must be true or false");
    if (node["layer"]) result.layer = static_cast<int>(number(node["layer"]));
    return result;
  }

  BodyDrawing body(const YAML::Node& node) const {
    check_keys(node, "a body", {"label", "label_at_mm", "view_mm", "spring", "parts"});
    BodyDrawing result;
    if (node["label"]) result.label = text(node["label"]);
    if (node["label_at_mm"]) result.label_at = point(node["label_at_mm"]);
    if (node["view_mm"]) result.view = box(node["view_mm"]);
    if (const YAML::Node spring = node["spring"]) {
      check_keys(spring, "a spring", {"coil_mm", "to_mm", "radius_mm"});
      if (!spring["coil_mm"] || !spring["to_mm"]) reject(spring, "a spring must have coil_mm and to_mm");
      result.spring = SpringDrawing{point(spring["coil_mm"]), point(spring["to_mm"])};
      if (spring["radius_mm"]) result.spring->radius = number(spring["radius_mm"]);
    }
    for (const YAML::Node& entry : node["parts"]) result.parts.push_back(part(entry));
    return result;
  }

  FeltDrawing felt(const YAML::Node& node) const {
    check_keys(node, "a felt", {"material", "thickness_mm", "length_mm", "direction_deg", "layer"});
    FeltDrawing result;
    if (node["material"]) result.material = text(node["material"]);
    if (node["thickness_mm"]) result.thickness = number(node["thickness_mm"]);
    if (node["length_mm"]) result.length = number(node["length_mm"]);
    if (node["direction_deg"]) result.direction = number(node["direction_deg"]) * kDegree;
    if (node["layer"]) result.layer = static_cast<int>(number(node["layer"]));
    return result;
  }

  std::filesystem::path file_;
};

/// The plain words of the action file; whatever else is wrong with it, its own reader tells.
void add_words(const std::filesystem::path& action_file, Drawing& drawing) try {
  const YAML::Node mechanism = YAML::LoadFile(action_file.string())["mechanism"];
  for (const auto& entry : mechanism["bodies"]) {
    BodyDrawing& body = drawing.bodies[entry.first.as<std::string>()];
    if (body.label.empty() && entry.second["what"]) body.label = entry.second["what"].as<std::string>();
  }
  for (const auto& entry : mechanism["contacts"])
    if (entry.second["what"])
      drawing.contact_labels[entry.first.as<std::string>()] = entry.second["what"].as<std::string>();
} catch (const YAML::Exception&) {
}

}  // namespace

Drawing load_drawing(const std::filesystem::path& action_file) {
  const std::filesystem::path hints = action_file.parent_path() / "drawings" / action_file.filename();
  Drawing drawing;
  if (std::filesystem::exists(hints)) drawing = Reader(hints).read();
  add_words(action_file, drawing);
  return drawing;
}

}  // namespace erard
