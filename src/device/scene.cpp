#include "erard/device/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "erard/mechanics/contact_frames.hpp"
#include "shape_paths.hpp"

namespace erard {
namespace {

constexpr double kMargin = 0.08;       // of the view around what moves, without hints [-]
constexpr double kLargestPart = 1000;  // primitives beyond that (a plane) do not widen the view [mm]

/// Where the two primitives of a contact are nearest to each other at rest, in the frames of their bodies.
struct RestContact {
  Vector2 towards_a, towards_b;  // unit vector from this side's primitive to the other one, in this body's frame
};

RestContact rest_contact(const Contact& contact, const Frames& frames) {
  const Vector2 normal = locate_contact(contact, frames, 0.0).normal;
  const auto turned_back = [](const Frame& frame, const Vector2& v) {
    return Vector2(v.dot(frame.x_axis), v.dot(perp(frame.x_axis)));
  };
  return {turned_back(frames.of(contact.body_a), normal), turned_back(frames.of(contact.body_b), Vector2(-normal))};
}

class Builder {
 public:
  Builder(const ActionFile& action, const Drawing& drawing) : drawing_(drawing) {
    scene_.model = action.model;
    scene_.roles = action.roles;
    CoordinateVector x = CoordinateVector::Zero(model().body_count);
    for (int i = 0; i < model().body_count; ++i) x[i] = model().bodies[i].initial;
    place_bodies(model(), x, frames_);
  }

  Scene build() {
    name_things();
    for (int c = 0; c < model().contact_count; ++c) rest_.push_back(rest_contact(model().contacts[c], frames_));
    size_ = reach();
    add_hints(kGround, drawing_.ground);
    for (int i = 0; i < model().body_count; ++i) {
      if (scene_.is_hidden[static_cast<std::size_t>(i)]) continue;
      const BodyDrawing* hints = hints_of(i);
      if (hints != nullptr && !hints->parts.empty())
        add_hints(i, *hints);
      else
        add_bones(i);
    }
    for (int c = 0; c < model().contact_count; ++c)
      if (model().contacts[c].is_active) add_contact(c);
    std::stable_sort(scene_.parts.begin(), scene_.parts.end(),
                     [](const ScenePart& a, const ScenePart& b) { return a.part.layer < b.part.layer; });
    choose_view();
    scene_.finger = drawing_.finger;
    return scene_;
  }

 private:
  const Model& model() const { return scene_.model; }

  const BodyDrawing* hints_of(int body) const {
    if (body == kGround) return &drawing_.ground;
    const auto found = drawing_.bodies.find(std::string(model().bodies[body].name.view()));
    return found == drawing_.bodies.end() ? nullptr : &found->second;
  }
  bool is_drawn_by_hand(int body) const {
    const BodyDrawing* hints = hints_of(body);
    return hints != nullptr && !hints->parts.empty();
  }

  void name_things() {
    for (int i = 0; i < model().body_count; ++i) {
      const BodyDrawing* hints = hints_of(i);
      const std::string name(model().bodies[i].name.view());
      scene_.body_label.push_back(hints != nullptr && !hints->label.empty() ? hints->label : name);
      scene_.label_at.push_back(hints != nullptr ? hints->label_at : std::nullopt);
      scene_.spring.push_back(hints != nullptr ? hints->spring : std::nullopt);
      bool touches = false, has_contacts = false;
      for (int c = 0; c < model().contact_count; ++c) {
        const Contact& contact = model().contacts[c];
        if (contact.body_a != i && contact.body_b != i) continue;
        has_contacts = true;
        touches = touches || contact.is_active;
      }
      scene_.is_hidden.push_back(model().bodies[i].is_held && has_contacts && !touches);
    }
    for (int c = 0; c < model().contact_count; ++c) {
      const std::string name(model().contacts[c].name.view());
      const auto found = drawing_.contact_labels.find(name);
      scene_.contact_label.push_back(found == drawing_.contact_labels.end() ? name : found->second);
    }
  }

  void add_hints(int body, const BodyDrawing& hints) {
    for (DrawnPart part : hints.parts) {
      if (!part.on.empty()) {
        const int c = find_contact(model(), part.on);
        if (c < 0 || !model().contacts[c].is_active) continue;
        const Contact& contact = model().contacts[c];
        if (contact.body_a != body && contact.body_b != body) continue;
        part.at += kMillimetre * (contact.body_a == body ? contact.shape_a : contact.shape_b).centre;
      }
      scene_.parts.push_back({body, std::move(part)});
    }
  }

  /// Size of the mechanism at rest: what the width of bones and the view are measured by [mm].
  Box reach() const {
    Box box{0, 0, 0, 0};
    const auto widen = [&box](const Vector2& metre, double radius) {
      const Vector2 p = kMillimetre * metre;
      box = {std::min(box.left, p.x() - radius), std::min(box.bottom, p.y() - radius),
             std::max(box.right, p.x() + radius), std::max(box.top, p.y() + radius)};
    };
    for (int i = 0; i < model().body_count; ++i) {
      widen(frames_.body[i].origin, 0);
      // a pendulum swings: leave room all around the joint
      widen(frames_.body[i].origin, kMillimetre * model().bodies[i].centre.norm());
    }
    for (int c = 0; c < model().contact_count; ++c) {
      const Contact& contact = model().contacts[c];
      for (const auto& [shape, body] :
           {std::pair{&contact.shape_a, contact.body_a}, {&contact.shape_b, contact.body_b}}) {
        const double half =
            kMillimetre * (shape->half_length + (shape->kind == ShapeKind::segment ? shape->radius : 0));
        if (half < kLargestPart && kMillimetre * shape->radius < kLargestPart)
          widen(frames_.of(body).placed(shape->centre), std::min(half + kMillimetre * shape->radius, 4 * kArc));
      }
    }
    return box;
  }

  double bone_width() const { return 0.012 * std::max({size_.right - size_.left, size_.top - size_.bottom, 1.0}); }

  void add(int body, std::string name, std::string material, std::string path, int layer) {
    DrawnPart part;
    part.name = std::move(name);
    part.material = std::move(material);
    part.path = std::move(path);
    part.layer = layer;
    scene_.parts.push_back({body, std::move(part)});
  }

  void add_bones(int body) {
    const std::string label = scene_.body_label[static_cast<std::size_t>(body)];
    const Vector2 centre = kMillimetre * model().bodies[body].centre;
    for (int c = 0; c < model().contact_count; ++c) {
      const Contact& contact = model().contacts[c];
      for (const auto& [shape, owner] :
           {std::pair{&contact.shape_a, contact.body_a}, {&contact.shape_b, contact.body_b}})
        if (owner == body && shape->radius < 0.1)
          add(body, label, "bone", bone_path(kMillimetre * shape->centre, bone_width()), 0);
    }
    for (int child = 0; child < model().body_count; ++child)
      if (model().bodies[child].parent == body)
        add(body, label, "bone", bone_path(kMillimetre * model().bodies[child].origin, bone_width()), 0);
    if (model().bodies[body].spring.stiffness != 0 && !scene_.spring[static_cast<std::size_t>(body)])
      add(body, "spring of " + label, "spring", spiral_path(bone_width()), 1);
    if (centre.norm() > 0) {
      add(body, label, "bone", bone_path(centre, bone_width()), 0);
      add(body, label + ", centre of gravity", "steel", circle_path(centre, 1.8 * bone_width()), 0);
    }
  }

  void add_contact(int c) {
    const Contact& contact = model().contacts[c];
    const auto k = static_cast<std::size_t>(c);
    const std::string name(contact.name.view());
    for (const bool is_a : {true, false}) {
      const int body = is_a ? contact.body_a : contact.body_b;
      const Shape& shape = is_a ? contact.shape_a : contact.shape_b;
      const Vector2& towards = is_a ? rest_[k].towards_a : rest_[k].towards_b;
      if (body != kGround && scene_.is_hidden[static_cast<std::size_t>(body)]) continue;
      if (contact.has_felt && contact.felt.is_carried_by_a == is_a) {
        const auto hint = drawing_.felts.find(name);
        const FeltDrawing felt = hint == drawing_.felts.end() ? FeltDrawing{} : hint->second;
        if (felt.thickness > 0)
          add(body, "felt " + name + ", " + scene_.contact_label[k], felt.material, pad_path(shape, towards, felt),
              felt.layer);
      }
      if (!is_drawn_by_hand(body)) add(body, scene_.contact_label[k], "primitive", primitive_path(shape, towards), 1);
    }
  }

  void choose_view() {
    if (drawing_.view) {
      scene_.view = *drawing_.view;
      for (int i = 0; i < model().body_count; ++i) {
        const BodyDrawing* hints = hints_of(i);
        if (hints == nullptr || !hints->view || scene_.is_hidden[static_cast<std::size_t>(i)]) continue;
        Box& view = scene_.view;
        view = {std::min(view.left, hints->view->left), std::min(view.bottom, hints->view->bottom),
                std::max(view.right, hints->view->right), std::max(view.top, hints->view->top)};
      }
    } else {
      const double margin = kMargin * std::max({size_.right - size_.left, size_.top - size_.bottom, 1.0});
      scene_.view = {size_.left - margin, size_.bottom - margin, size_.right + margin, size_.top + margin};
    }
    scene_.views = drawing_.views;
  }

  const Drawing& drawing_;
  Scene scene_;
  Frames frames_;
  std::vector<RestContact> rest_;
  Box size_;
};

}  // namespace

Scene build_scene(const ActionFile& action, const Drawing& drawing) { return Builder(action, drawing).build(); }

CoordinateVector body_coordinates(const Model& model, const std::vector<double>& absolute_angle) {
  CoordinateVector x = CoordinateVector::Zero(model.body_count);
  for (int i = 0; i < model.body_count; ++i) {
    x[i] = absolute_angle[static_cast<std::size_t>(i)];
    // a slide keeps the angle of the hinge above it
    int above = model.bodies[i].parent;
    while (above != kGround && model.bodies[above].joint != JointKind::hinge) above = model.bodies[above].parent;
    if (above != kGround && model.bodies[i].joint == JointKind::hinge)
      x[i] -= absolute_angle[static_cast<std::size_t>(above)];
  }
  return x;
}

}  // namespace erard
