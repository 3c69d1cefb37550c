#include "erard/device/action_file.hpp"

#include "erard/mechanics/contact_frames.hpp"
#include "parameters.hpp"
#include "yaml_file.hpp"

namespace erard {
namespace {

/// Builds the model from the section `mechanism`.
class Builder {
 public:
  Builder(Parameters& parameters, const ActionOptions& options) : parameters_(parameters), options_(options) {}

  ActionFile build(YamlSection mechanism) {
    const std::string name = mechanism.word("name");
    if (name.size() > Name::kCapacity)
      mechanism.reject(mechanism.line("name"),
                       fmt::format("name = {}, must have at most {} letters", printable(name), Name::kCapacity));
    file_.model.name = Name(name);
    file_.model.gravity = {0, -number(mechanism, "gravity", "m/s^2", Rule::not_negative)};
    read_bodies(mechanism.section("bodies"));
    if (mechanism.optional("contacts")) read_contacts(mechanism.section("contacts"));
    check_room(mechanism);
    if (mechanism.optional("finger")) read_finger(mechanism.section("finger"));
    if (mechanism.optional("damper")) read_damper(mechanism.section("damper"));
    if (mechanism.optional("events")) read_events(mechanism.section("events"));
    mechanism.finish();
    take_out_contacts();
    return file_;
  }

 private:
  double number(YamlSection& section, const std::string& key, std::string_view unit, Rule rule) {
    return parameters_.get(section, key, section.word(key), unit, rule);
  }
  double optional_number(YamlSection& section, const std::string& key, std::string_view unit, Rule rule) {
    return section.optional(key) ? number(section, key, unit, rule) : 0.0;
  }
  Vector2 point(YamlSection& section, const std::string& key) {
    const std::vector<std::string> names = section.words(key);
    if (names.size() != 2)
      section.reject(section.line(key), fmt::format("{}{} must be a list of two names [x, y]", key, section.where()));
    return {parameters_.get(section, key, names[0], "m", Rule::any),
            parameters_.get(section, key, names[1], "m", Rule::any)};
  }

  int body(YamlSection& section, const std::string& key) {
    const std::string name = section.word(key);
    if (name == "S" || name == "G") return kGround;
    const int index = find_body(file_.model, name);
    if (index >= 0) return index;
    std::vector<std::string> known{"S"};
    for (int i = 0; i < file_.model.body_count; ++i)
      known.emplace_back(file_.model.bodies[static_cast<std::size_t>(i)].name.view());
    section.reject(section.line(key), fmt::format("{} = {}{}, must be a body declared above or S, the ground ({})", key,
                                                  printable(name), section.where(), fmt::join(known, ", ")));
  }
  int contact(YamlSection& section, const std::string& key, const std::string& name) {
    const int index = find_contact(file_.model, name);
    if (index < 0)
      section.reject(section.line(key), fmt::format("{} = {}{}, must be a contact ({})", key, printable(name),
                                                    section.where(), contact_names()));
    return index;
  }
  std::string contact_names() const {
    std::string names;
    for (int i = 0; i < file_.model.contact_count; ++i)
      names += fmt::format("{}{}", i == 0 ? "" : ", ", file_.model.contacts[static_cast<std::size_t>(i)].name.view());
    return names;
  }
  void check_name(const YamlSection& section, const std::string& name) const {
    if (!std::all_of(name.begin(), name.end(), [](char c) {
          return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '+' || c == '-';
        }))
      section.reject(section.line(name),
                     fmt::format("name {} must be of letters, digits, _, + and -", printable(name)));
    if (name.size() > Name::kCapacity)
      section.reject(section.line(name), fmt::format("name {} is too long, must have at most {} letters",
                                                     printable(name), Name::kCapacity));
  }

  void read_bodies(YamlSection bodies) {
    if (bodies.keys().empty()) bodies.reject(bodies.line(""), "bodies must name at least one body");
    for (const std::string& name : bodies.keys()) {
      check_name(bodies, name);
      if (name == "S" || name == "G")
        bodies.reject(bodies.line(name), fmt::format("body {}: S and G are names of the ground", name));
      if (file_.model.body_count == kMaxBodies)
        bodies.reject(bodies.line(name),
                      fmt::format("body {} is one too many, must be at most {}", printable(name), kMaxBodies));
      // a body joins the list only when it is read: a parent must stand above, so that the tree has no loop
      const Body read = read_body(bodies.section(name), name);
      file_.model.bodies[static_cast<std::size_t>(file_.model.body_count++)] = read;
    }
    bodies.finish();
  }

  Body read_body(YamlSection section, const std::string& name) {
    Body body;
    body.name = Name(name);
    section.word("what");
    body.parent = this->body(section, "parent");
    const bool is_hinge = section.choice("joint", {"hinge", "prismatic"}) == "hinge";
    body.joint = is_hinge ? JointKind::hinge : JointKind::prismatic;
    body.origin = point(section, "origin");
    if (!is_hinge) body.direction = number(section, "direction", "rad", Rule::any);
    body.mass = number(section, "mass", "kg", Rule::positive);
    body.centre = point(section, "centre");
    body.inertia = number(section, "inertia", "kg m^2", Rule::positive);
    body.viscous = optional_number(section, "viscous", is_hinge ? "N m s/rad" : "N s/m", Rule::not_negative);
    body.dry = optional_number(section, "dry", is_hinge ? "N m" : "N", Rule::not_negative);
    if (section.optional("spring")) {
      YamlSection spring = section.section("spring");
      body.spring.stiffness = number(spring, "stiffness", is_hinge ? "N m/rad" : "N/m", Rule::not_negative);
      body.spring.rest = number(spring, "rest", is_hinge ? "rad" : "m", Rule::any);
      spring.finish();
    }
    if (is_hinge)
      body.initial = number(section, "initial_angle", "rad", Rule::any) - absolute_angle(body.parent);
    else
      body.initial = number(section, "initial_position", "m", Rule::any);
    // on the ground only the inertia about the hinge counts; what is carried must be a possible distribution of mass
    if (is_hinge && body.parent != kGround && body.inertia < body.mass * body.centre.squaredNorm())
      parameters_.reject(section.word("inertia"), fmt::format("must be at least m |G|^2 = {:.4g} kg m^2 of body {}",
                                                              body.mass * body.centre.squaredNorm(), name));
    section.finish();
    return body;
  }

  /// Start angle of a body in the ground frame; files give absolute angles, the model takes relative ones.
  double absolute_angle(int index) const {
    double angle = 0;
    for (; index != kGround; index = file_.model.bodies[static_cast<std::size_t>(index)].parent) {
      const Body& body = file_.model.bodies[static_cast<std::size_t>(index)];
      if (body.joint == JointKind::hinge) angle += body.initial;
    }
    return angle;
  }

  /// A side of a contact; @param zone receives the point `at`, where the body is touched.
  Shape read_side(YamlSection section, int& body_index, Vector2& zone) {
    Shape shape;
    body_index = body(section, "body");
    const bool is_circle = section.choice("shape", {"circle", "segment"}) == "circle";
    zone = point(section, "at");
    shape.direction = number(section, "direction", "rad", Rule::any);
    if (is_circle) {
      shape.radius = number(section, "radius", "m", Rule::positive);
      shape.centre = zone + shape.radius * Vector2(std::cos(shape.direction), std::sin(shape.direction));
    } else {
      shape.kind = ShapeKind::segment;
      const double length = number(section, "length", "m", Rule::positive);
      shape.radius = optional_number(section, "corner_radius", "m", Rule::positive);
      shape.half_length = 0.5 * length - shape.radius;
      if (shape.half_length <= 0)
        parameters_.reject(section.word("corner_radius"),
                           fmt::format("must be less than half the length of {} m", length));
      shape.centre = zone - shape.radius * Vector2(-std::sin(shape.direction), std::cos(shape.direction));
    }
    section.finish();
    return shape;
  }

  void read_contacts(YamlSection contacts) {
    lightened_ = file_.model.bodies;
    for (const std::string& name : contacts.keys()) {
      check_name(contacts, name);
      if (file_.model.contact_count == kMaxContacts)
        contacts.reject(contacts.line(name),
                        fmt::format("contact {} is one too many, must be at most {}", printable(name), kMaxContacts));
      const Contact read = read_contact(contacts.section(name), name);
      file_.model.contacts[static_cast<std::size_t>(file_.model.contact_count++)] = read;
    }
    contacts.finish();
    if (options_.felts == FeltModel::bodies) file_.model.bodies = lightened_;
  }

  Contact read_contact(YamlSection section, const std::string& name) {
    Contact contact;
    contact.name = Name(name);
    section.word("what");
    Vector2 zone_a, zone_b;
    contact.shape_a = read_side(section.section("a"), contact.body_a, zone_a);
    contact.shape_b = read_side(section.section("b"), contact.body_b, zone_b);
    if (contact.body_a == contact.body_b)
      section.reject(section.line("b"),
                     fmt::format("contact {} is between a body and itself, must be between two", name));
    if (contact.shape_a.kind == ShapeKind::segment && contact.shape_b.kind == ShapeKind::segment)
      section.reject(section.line("b"),
                     fmt::format("contact {} is between two segments, one side must be a circle", name));
    contact.friction = optional_number(section, "friction", "-", Rule::not_negative);
    contact.restitution = optional_number(section, "restitution", "-", Rule::zero_to_one);
    if (section.optional("felt")) read_felt(section.section("felt"), contact, zone_a, zone_b);
    if (section.optional("felt") && contact.restitution > 0)
      section.reject(section.line("restitution"),
                     fmt::format("contact {} has a felt and a restitution, may have only one of them", name));
    if (contact.friction > 0 && contact.restitution > 0)
      section.reject(section.line("restitution"),
                     fmt::format("contact {} has a restitution and a friction, may have only one of them: "
                                 "together they can create energy",
                                 name));
    section.finish();
    return contact;
  }

  void read_felt(YamlSection section, Contact& contact, const Vector2& zone_a, const Vector2& zone_b) {
    Felt& felt = contact.felt;
    contact.has_felt = true;
    felt.is_carried_by_a = section.choice("carrier", {"a", "b"}) == "a";
    felt.stiffness = number(section, "stiffness", "N/m^r", Rule::positive);
    felt.exponent = number(section, "exponent", "-", Rule::at_least_one);
    felt.damping = number(section, "damping", "N s/m^3", Rule::not_negative);
    felt.mass = number(section, "mass", "kg", Rule::positive);
    if (section.choice("axis", {"contact_normal", "fixed"}) == "fixed") {
      felt.axis = FeltAxis::fixed;
      felt.direction = number(section, "direction", "rad", Rule::any);
      check_axis(section, contact);
    }
    if (options_.felts == FeltModel::massless && felt.axis == FeltAxis::fixed)
      section.reject(section.line("axis"),
                     fmt::format("axis = fixed{}, is for felts with mass: --felts bodies", section.where()));
    felt.place = felt.is_carried_by_a ? zone_a : zone_b;
    const int holder = carrier(contact);
    if (options_.keep_totals && holder != kGround) take_from(section, felt.mass, felt.place, holder);
    if (options_.felts != FeltModel::bodies) {  // read and checked all the same
      note_idle_setting(section.word("mass"));
      felt.mass = 0;
    }
    contact.has_felt = options_.felts != FeltModel::rigid;
    section.finish();
  }

  /// A fixed axis must point to the other body, or its felt could not be pressed.
  void check_axis(YamlSection& section, const Contact& contact) const {
    constexpr double kLeastLever = 0.5;  // 60 degrees from the normal
    CoordinateVector x(file_.model.body_count);
    for (int i = 0; i < file_.model.body_count; ++i) x[i] = file_.model.bodies[static_cast<std::size_t>(i)].initial;
    Frames frames;
    place_bodies(file_.model, x, frames);
    if (locate_contact(contact, frames, 0).felt_lever >= kLeastLever) return;
    section.reject(
        section.line("direction"),
        fmt::format("direction = {}{}, must point from the carrier to the other body, within 60 degrees of the "
                    "contact's normal at the start",
                    section.word("direction"), section.where()));
  }

  /// The file's mass, centre and inertia of a body include its felts: takes one of them out.
  void take_from(YamlSection& section, double mass, const Vector2& place, int holder) {
    Body& body = lightened_[static_cast<std::size_t>(holder)];
    const Vector2 moment = body.mass * body.centre - mass * place;
    if (mass >= body.mass || mass * place.squaredNorm() >= body.inertia)
      parameters_.reject(section.word("mass"),
                         fmt::format("must be lighter than body {} that carries it", body.name.view()));
    body.mass -= mass;
    body.centre = moment / body.mass;
    body.inertia -= mass * place.squaredNorm();
  }

  void note_idle_setting(const std::string& mass) {
    for (const Setting& setting : options_.settings)
      if (setting.name == mass)
        file_.notes.push_back(
            fmt::format("--set {}={} changes nothing: it is the mass of a felt, and only --felts bodies has such",
                        setting.name, setting.value));
  }

  void check_room(YamlSection& mechanism) {
    const auto check = [&](const char* what, int count, int most) {
      if (count > most)
        mechanism.reject(mechanism.line("contacts"),
                         fmt::format("the action has {} {}, must be at most {}", count, what, most));
    };
    check("coordinates (one for each body and, with --felts bodies, each felt)", count_coordinates(file_.model),
          kMaxCoordinates);
    check("laws (contacts, their friction, dry joints; with --felts bodies one more for each felt)",
          count_rows(file_.model), kMaxRows);
  }

  void read_finger(YamlSection section) {
    Finger& finger = file_.model.finger;
    finger.body = body(section, "body");
    const bool is_fit = finger.body != kGround &&
                        file_.model.bodies[static_cast<std::size_t>(finger.body)].parent == kGround &&
                        file_.model.bodies[static_cast<std::size_t>(finger.body)].joint == JointKind::hinge;
    if (!is_fit)
      section.reject(section.line("body"),
                     fmt::format("body = {} in finger, must hang on the ground by a hinge", section.word("body")));
    finger.arm = number(section, "arm", "m", Rule::positive);
    finger.stiffness = number(section, "stiffness", "N/m", Rule::positive);
    finger.damping = number(section, "damping", "N s/m", Rule::not_negative);
    section.finish();
  }

  void read_damper(YamlSection section) {
    const int damper = body(section, "body");
    if (damper == kGround) section.reject(section.line("body"), "body = S in damper, must be a body that moves");
    for (const std::string& name : section.words("contacts")) {
      Contact& part = file_.model.contacts[static_cast<std::size_t>(contact(section, "contacts", name))];
      if (part.body_a != damper && part.body_b != damper)
        section.reject(section.line("contacts"),
                       fmt::format("contacts = {} in damper, must be contacts of its body", name));
      part.is_active = options_.damper;
    }
    file_.model.bodies[static_cast<std::size_t>(damper)].is_held = !options_.damper;
    section.finish();
  }

  void read_events(YamlSection section) {
    ActionRoles& roles = file_.roles;
    for (const auto& [key, role] : {std::pair{"let_off", &roles.let_off},
                                    {"escapement", &roles.escapement},
                                    {"front_rail", &roles.front_rail},
                                    {"string", &roles.string},
                                    {"backcheck", &roles.backcheck},
                                    {"jack_rest", &roles.jack_rest}})
      if (section.optional(key)) *role = contact(section, key, section.word(key));
    if (section.optional("hammer")) roles.hammer = body(section, "hammer");
    if (roles.hammer != kGround && roles.string >= 0) {
      const Contact& string = file_.model.contacts[static_cast<std::size_t>(roles.string)];
      if (string.body_a != roles.hammer && string.body_b != roles.hammer)
        section.reject(section.line("hammer"),
                       fmt::format("hammer = {} in events, must be a body of the string's contact {}",
                                   section.word("hammer"), string.name.view()));
    }
    section.finish();
  }

  void take_out_contacts() {
    for (const std::string& name : options_.without) {
      const int index = find_contact(file_.model, name);
      if (index < 0)
        throw InputError(
            fmt::format("--without {}: there is no such contact, must be one of {}", printable(name), contact_names()));
      file_.model.contacts[static_cast<std::size_t>(index)].is_active = false;
    }
  }

  Parameters& parameters_;
  const ActionOptions& options_;
  ActionFile file_;
  std::array<Body, kMaxBodies> lightened_;  // the bodies without the felts that they carry
};

}  // namespace

ActionFile load_action(const std::filesystem::path& file, const ActionOptions& options) {
  return load_action(read_config(file, "an action file"), options);
}

ActionFile load_action(const ConfigText& config, const ActionOptions& options) {
  const YAML::Node root = parse_yaml(config);
  const std::string& file = config.name;
  YamlSection sections(file, "", root, 1);
  YamlSection parameter_section = sections.section("parameters");
  YamlSection mechanism = sections.section("mechanism");
  sections.finish();
  Parameters parameters(file, parameter_section, options.settings);
  ActionFile action = Builder(parameters, options).build(std::move(mechanism));
  parameters.finish();
  action.parameters = parameters.list();
  return action;
}

}  // namespace erard
