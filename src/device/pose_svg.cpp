#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "erard/device/scene.hpp"
#include "erard/mechanics/contact_frames.hpp"
#include "json.hpp"
#include "web_assets.hpp"

namespace erard {
namespace {

constexpr double kMillimetre = 1e3;            // [mm/m]
constexpr double kDegree = 57.29577951308232;  // [deg/rad]
constexpr double kPixels = 3;                  // nominal size of the picture [px/mm]
constexpr double kSlidingShare = 0.999;        // of the bound, from which a contact or hinge counts as sliding [-]
constexpr double kSmallestForce = 1e-3;        // below, no arrow [N]
constexpr double kLongestArrow = 70;           // [mm]

std::string escaped(std::string_view raw) {
  std::string out;
  for (const char c : raw) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// The style sheet with its variables replaced by their values.
std::string plain_style() {
  std::string css(web_asset("drawing.css"));
  std::vector<std::pair<std::string, std::string>> variables;
  const std::size_t end = css.find('}');
  for (std::size_t at = css.find("--"); at < end; at = css.find("--", at + 2)) {
    const std::size_t colon = css.find(':', at), stop = css.find(';', at);
    variables.emplace_back("var(" + css.substr(at, colon - at) + ")", css.substr(colon + 2, stop - colon - 2));
  }
  css.erase(0, end + 1);
  for (const auto& [name, value] : variables)
    for (std::size_t at = css.find(name); at != std::string::npos; at = css.find(name, at))
      css.replace(at, name.size(), value);
  for (std::size_t at = css.find(".drawing "); at != std::string::npos; at = css.find(".drawing ")) css.erase(at, 9);
  return css;
}

/// Shaft and head along +x, `length` mm long.
std::string arrow_path(double length) {
  const double head = std::min(3.2, 0.6 * length), width = 0.45 * head;
  return fmt::format("M 0 -0.5 L {0:.4g} -0.5 L {0:.4g} {1:.4g} L {2:.4g} 0 L {0:.4g} {3:.4g} L {0:.4g} 0.5 L 0 0.5 Z",
                     length - head, -width, length, width);
}

class Writer {
 public:
  Writer(const Scene& scene, const Snapshot& pose, DriveKind drive) : scene_(scene), pose_(pose), drive_(drive) {
    place_bodies(scene.model, body_coordinates(scene.model, pose.angle), frames_);
  }

  std::string write(const std::string& caption) {
    const Box& v = scene_.view;
    const double width = v.right - v.left, height = v.top - v.bottom, foot = caption.empty() ? 0 : 9;
    out_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"drawing\" width=\"{:.0f}\" height=\"{:.0f}\" "
        "viewBox=\"{:.6g} {:.6g} {:.6g} {:.6g}\">\n<style>{}</style>\n",
        kPixels * width, kPixels * (height + foot), v.left, -v.top, width, height + foot, plain_style());
    out_ += fmt::format(
        "<rect x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\" fill=\"#ffffff\"/>\n<g "
        "transform=\"scale(1,-1)\">\n",
        v.left, -v.top, width, height + foot);
    for (const ScenePart& part : scene_.parts) draw_part(part);
    draw_fingertip();
    for (int i = 0; i < scene_.model.body_count; ++i) draw_spring(i);
    for (int c = 0; c < scene_.model.contact_count; ++c) draw_pressed(c);
    for (int i = 0; i < scene_.model.body_count; ++i) draw_pin(i);
    for (int c = 0; c < scene_.model.contact_count; ++c) draw_contact(c);
    draw_finger_force();
    out_ += "</g>\n";
    for (int i = 0; i < scene_.model.body_count; ++i) draw_label(i);
    if (!caption.empty())
      out_ += fmt::format("<text x=\"{:.6g}\" y=\"{:.6g}\">{}</text>\n", 0.5 * (v.left + v.right), -v.bottom + 6,
                          escaped(caption));
    return out_ + "</svg>\n";
  }

 private:
  void path(std::string_view material, std::string_view d, const Vector2& at, double angle,
            std::string_view name = {}) {
    out_ += fmt::format("<path class=\"{}\" d=\"{}\" transform=\"translate({:.3f} {:.3f}) rotate({:.4f})\"", material,
                        d, at.x(), at.y(), kDegree * angle);
    out_ += name.empty() ? "/>\n" : fmt::format("><title>{}</title></path>\n", escaped(name));
  }

  Vector2 placed(int body, const Vector2& millimetre) const {
    return kMillimetre * frames_.of(body).placed(millimetre / kMillimetre);
  }
  bool is_hidden(int body) const { return body != kGround && scene_.is_hidden[static_cast<std::size_t>(body)]; }

  void draw_part(const ScenePart& placed_part) {
    const DrawnPart& part = placed_part.part;
    path(part.material, part.path, placed(placed_part.body, part.at),
         part.is_upright ? 0 : frames_.of(placed_part.body).angle, part.name);
  }

  void draw_fingertip() {
    if (!scene_.finger || drive_ == DriveKind::none) return;
    const double indent = drive_ == DriveKind::force ? 0 : kMillimetre * (pose_.input.value - pose_.key_position);
    const Vector2 tip = placed(scene_.model.finger.body, scene_.finger->at);
    path(scene_.finger->material, scene_.finger->path, tip - Vector2(0, indent), 0, scene_.finger->name);
  }

  void draw_spring(int i) {
    const auto& spring = scene_.spring[static_cast<std::size_t>(i)];
    if (!spring || is_hidden(i) || scene_.model.bodies[i].spring.stiffness == 0) return;
    const Vector2 c = placed(scene_.model.bodies[i].parent, spring->coil), to = placed(i, spring->to);
    const double r = spring->radius;
    path("spring",
         fmt::format(
             "M {0:.5g} {1:.5g} A {2} {2} 0 1 0 {3:.5g} {4:.5g} A {2} {2} 0 0 0 {0:.5g} {1:.5g} L {5:.5g} {6:.5g}",
             c.x(), c.y() + r, r, c.x(), c.y() - r, to.x(), to.y()),
         Vector2::Zero(), 0, "spring of " + scene_.body_label[static_cast<std::size_t>(i)]);
  }

  ContactFrame locate(int c) const { return locate_contact(scene_.model.contacts[c], frames_, 0.0); }
  bool is_drawn(int c) const {
    const Contact& contact = scene_.model.contacts[c];
    return contact.is_active && !is_hidden(contact.body_a) && !is_hidden(contact.body_b);
  }

  /// What the felt has given way by, from the surface of its carrier inwards.
  void draw_pressed(int c) {
    const Contact& contact = scene_.model.contacts[c];
    const double d = kFeltMagnification * kMillimetre * pose_.compression[static_cast<std::size_t>(c)];
    if (!is_drawn(c) || !contact.has_felt || !(d > 0)) return;
    const ContactFrame at = locate(c);
    const Vector2 inwards = contact.felt.is_carried_by_a ? Vector2(-at.normal) : at.normal;
    const double half = 1.5 + 1.2 * d;
    path("pressed", fmt::format("M 0 {:.4g} Q {:.4g} 0 0 {:.4g} Z", -half, 2 * d, half), kMillimetre * at.felt_point,
         std::atan2(inwards.y(), inwards.x()),
         fmt::format("{} pressed by {:.3f} mm", contact.name.view(), d / kFeltMagnification));
  }

  void draw_pin(int i) {
    const Body& body = scene_.model.bodies[i];
    if (is_hidden(i) || body.joint != JointKind::hinge) return;
    const double moment = std::abs(pose_.hinge_moment[static_cast<std::size_t>(i)]);
    const char* kind = body.dry <= 0 || body.is_held       ? "pin"
                       : moment < kSlidingShare * body.dry ? "pin-stick"
                                                           : "pin-slide";
    path(kind, "M 1.7 0 A 1.7 1.7 0 0 1 -1.7 0 A 1.7 1.7 0 0 1 1.7 0 Z", kMillimetre * frames_.of(i).origin, 0,
         "joint of " + scene_.body_label[static_cast<std::size_t>(i)]);
  }

  void draw_contact(int c) {
    if (!is_drawn(c)) return;
    const auto k = static_cast<std::size_t>(c);
    const Contact& contact = scene_.model.contacts[c];
    const ContactFrame at = locate(c);
    const double normal = pose_.normal[k], tangential = pose_.tangential[k];
    const bool has_friction = contact.friction > 0;
    const bool slides = std::abs(tangential) >= kSlidingShare * contact.friction * normal;
    const std::string kind = normal <= 0 ? "open" : !has_friction ? "closed" : slides ? "slide" : "stick";
    const char* mark = kind == "stick"   ? "M -1.1 -1.1 L 1.1 -1.1 L 1.1 1.1 L -1.1 1.1 Z"
                       : kind == "slide" ? "M -1.2 -1.1 L 1.4 0 L -1.2 1.1 Z"
                                         : "M 1.1 0 A 1.1 1.1 0 0 1 -1.1 0 A 1.1 1.1 0 0 1 1.1 0 Z";
    const Vector2 along = (tangential < 0 ? -1 : 1) * perp(at.normal);
    const Vector2 point = kMillimetre * at.point;
    const Vector2 force = (contact.body_b == kGround ? -1 : 1) * (normal * at.normal + tangential * perp(at.normal));
    if (force.norm() > kSmallestForce)
      path("arrow-" + kind, arrow_path(std::min(kLongestArrow, kArrowLength * std::sqrt(force.norm()))), point,
           std::atan2(force.y(), force.x()), fmt::format("{} {:.2f} N", contact.name.view(), force.norm()));
    path("mark-" + kind, mark, point, std::atan2(along.y(), along.x()),
         fmt::format("{}, {}", contact.name.view(), scene_.contact_label[k]));
  }

  void draw_finger_force() {
    if (scene_.model.finger.body == kGround || std::abs(pose_.force) < kSmallestForce) return;
    const Vector2 local = scene_.finger ? scene_.finger->at : Vector2(kMillimetre * scene_.model.finger.arm, 0);
    const double length = std::min(kLongestArrow, kArrowLength * std::sqrt(std::abs(pose_.force)));
    const double turn = pose_.force > 0 ? -std::acos(0.0) : std::acos(0.0);
    path("arrow-finger", arrow_path(length),
         placed(scene_.model.finger.body, local) + Vector2(0, pose_.force > 0 ? length : 0), turn,
         fmt::format("finger {:.2f} N", pose_.force));
  }

  void draw_label(int i) {
    const auto k = static_cast<std::size_t>(i);
    if (is_hidden(i) || !scene_.label_at[k]) return;
    const Vector2 at = placed(i, *scene_.label_at[k]);
    for (const char* kind : {"halo", ""})
      out_ += fmt::format("<text class=\"{}\" x=\"{:.5g}\" y=\"{:.5g}\" dy=\"1.5\">{}</text>\n", kind, at.x(), -at.y(),
                          escaped(scene_.body_label[k]));
  }

  const Scene& scene_;
  const Snapshot& pose_;
  DriveKind drive_;
  Frames frames_;
  std::string out_;
};

}  // namespace

std::string draw_svg(const Scene& scene, const Snapshot& pose, DriveKind drive, const std::string& caption) {
  return Writer(scene, pose, drive).write(caption);
}

}  // namespace erard
