#include "erard/device/scene.hpp"
#include "json.hpp"

namespace erard {
namespace {

constexpr double kMillimetre = 1e3;  // [mm/m]

std::string box_json(const Box& box) {
  return fmt::format("[{:.6g},{:.6g},{:.6g},{:.6g}]", box.left, box.bottom, box.right, box.top);
}

std::string part_json(const ScenePart& placed) {
  const DrawnPart& part = placed.part;
  return fmt::format(R"({{"body":{},"name":{},"material":{},"path":{},"at":{},"upright":{}}})", placed.body,
                     json::text(part.name), json::text(part.material), json::text(part.path), json::pair(part.at),
                     json::flag(part.is_upright));
}

std::string body_json(const Scene& scene, std::size_t i) {
  const Body& body = scene.model.bodies[i];
  std::string out = fmt::format(R"({{"name":{},"label":{},"parent":{},"slide":{},"origin":{},"direction":{:.9g})",
                                json::text(body.name.view()), json::text(scene.body_label[i]), body.parent,
                                json::flag(body.joint == JointKind::prismatic), json::pair(kMillimetre * body.origin),
                                body.direction);
  out += fmt::format(R"(,"dry":{},"hidden":{},"held":{})", json::number(body.dry), json::flag(scene.is_hidden[i]),
                     json::flag(body.is_held));
  if (scene.label_at[i]) out += ",\"label_at\":" + json::pair(*scene.label_at[i]);
  if (body.spring.stiffness != 0 && scene.spring[i])
    out += fmt::format(R"(,"spring":{{"coil":{},"to":{},"radius":{:.4g}}})", json::pair(scene.spring[i]->coil),
                       json::pair(scene.spring[i]->to), scene.spring[i]->radius);
  return out + "}";
}

std::string shape_json(const Shape& shape) {
  return fmt::format(R"({{"segment":{},"centre":{},"direction":{:.9g},"half":{:.9g},"radius":{:.9g}}})",
                     json::flag(shape.kind == ShapeKind::segment), json::pair(kMillimetre * shape.centre),
                     shape.direction, kMillimetre * shape.half_length, kMillimetre * shape.radius);
}

std::string contact_json(const Scene& scene, std::size_t c) {
  const Contact& contact = scene.model.contacts[c];
  const char* felt = !contact.has_felt ? "null" : contact.felt.is_carried_by_a ? "\"a\"" : "\"b\"";
  return fmt::format(
      R"({{"name":{},"label":{},"a":{},"b":{},"shape_a":{},"shape_b":{},"mu":{},"felt":{},"active":{}}})",
      json::text(contact.name.view()), json::text(scene.contact_label[c]), contact.body_a, contact.body_b,
      shape_json(contact.shape_a), shape_json(contact.shape_b), json::number(contact.friction), felt,
      json::flag(contact.is_active));
}

template <typename Write>
std::string each(int count, Write&& write) {
  std::string out = "[";
  for (int i = 0; i < count; ++i) {
    if (i > 0) out += ',';
    out += write(static_cast<std::size_t>(i));
  }
  return out + "]";
}

}  // namespace

std::string scene_json(const Scene& scene) {
  const Model& model = scene.model;
  const ActionRoles& roles = scene.roles;
  std::string out = fmt::format(R"({{"name":{},"view":{},"felt_magnification":{},"arrow_length":{})",
                                json::text(model.name.view()), box_json(scene.view), kFeltMagnification, kArrowLength);
  out += ",\"views\":" + json::list(scene.views, [](const NamedView& v) {
           return fmt::format(R"({{"name":{},"box":{}}})", json::text(v.name), box_json(v.box));
         });
  out += ",\"bodies\":" + each(model.body_count, [&](std::size_t i) { return body_json(scene, i); });
  out += ",\"contacts\":" + each(model.contact_count, [&](std::size_t c) { return contact_json(scene, c); });
  out += ",\"parts\":" + json::list(scene.parts, part_json);
  out += fmt::format(R"(,"finger":{{"body":{},"arm":{:.9g}}})", model.finger.body, kMillimetre * model.finger.arm);
  if (scene.finger) out += ",\"fingertip\":" + part_json({model.finger.body, *scene.finger});
  out += fmt::format(
      R"(,"roles":{{"let_off":{},"escapement":{},"front_rail":{},"string":{},"backcheck":{},"jack_rest":{},"hammer":{}}}}})",
      roles.let_off, roles.escapement, roles.front_rail, roles.string, roles.backcheck, roles.jack_rest, roles.hammer);
  return out;
}

}  // namespace erard
