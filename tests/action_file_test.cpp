// Actions as files: what a good one becomes, and what is said of a bad one.
#include "erard/device/action_file.hpp"

#include <gtest/gtest.h>

#include "support/program.hpp"

namespace erard {
namespace {

const std::filesystem::path kGrandAction = std::filesystem::path(ERARD_CONFIG_DIR) / "grand_action.yaml";

const Body& body(const ActionFile& action, const char* name) {
  return action.model.bodies[static_cast<std::size_t>(find_body(action.model, name))];
}
const Contact& contact(const ActionFile& action, const char* name) {
  return action.model.contacts[static_cast<std::size_t>(find_contact(action.model, name))];
}

TEST(ActionFile, GrandActionHasSixBodiesAndFourteenFelts) {
  ActionOptions options;
  options.felts = FeltModel::bodies;
  const ActionFile action = load_action(kGrandAction, options);
  EXPECT_EQ(action.model.body_count, 6);
  EXPECT_EQ(action.model.contact_count, 14);
  EXPECT_EQ(build_mechanism(action.model).coordinate_count, 20);
  EXPECT_EQ(build_mechanism(load_action(kGrandAction).model).coordinate_count, 6);  // felts without mass
  options.felts = FeltModel::rigid;
  EXPECT_FALSE(load_action(kGrandAction, options).model.contacts[0].has_felt);
  int frictional = 0;
  for (int c = 0; c < 14; ++c) {
    EXPECT_TRUE(action.model.contacts[static_cast<std::size_t>(c)].has_felt);
    frictional += action.model.contacts[static_cast<std::size_t>(c)].friction > 0;
  }
  EXPECT_EQ(frictional, 3);  // JG, JH, KH
  EXPECT_EQ(find_contact(action.model, "KS+"), 0);
  EXPECT_EQ(find_contact(action.model, "DG"), 13);
}

TEST(ActionFile, EveryParameterSaysWhereItComesFrom) {
  for (const Parameter& p : load_action(kGrandAction).parameters) {
    const bool is_known = p.source.starts_with("thesis") || p.source.starts_with("derived: ") ||
                          p.source.starts_with("reconstructed: ") || p.name == "g";
    EXPECT_TRUE(is_known) << p.name << ": " << p.source;
    EXPECT_GT(p.line, 0);
  }
}

TEST(ActionFile, AnglesBecomeRelativeToTheParent) {
  const ActionFile action = load_action(kGrandAction);
  EXPECT_DOUBLE_EQ(body(action, "K").initial, 0.03);
  EXPECT_DOUBLE_EQ(body(action, "J").initial, 0.222075645 + 0.0299451507);  // on the whippen
}

TEST(ActionFile, CircleCentresLieOneRadiusFromTheirPoint) {
  // W_K: point (0.0605511631, -0.0173565144), radius 0.012, direction 1.62079633 rad
  const Shape shape = contact(load_action(kGrandAction), "KW").shape_b;
  EXPECT_NEAR(shape.centre.x(), 0.0605511631 + 0.012 * std::cos(1.62079633), 1e-15);
  EXPECT_NEAR(shape.centre.y(), -0.0173565144 + 0.012 * std::sin(1.62079633), 1e-15);
}

TEST(ActionFile, JackTopIsACapsuleThatLiesBelowItsFace) {
  // J_H: (0.0001, 0.054), 6 mm long with corners of 0.4 mm
  const Shape shape = contact(load_action(kGrandAction), "JH").shape_a;
  EXPECT_DOUBLE_EQ(shape.half_length, 0.0026);
  EXPECT_DOUBLE_EQ(shape.radius, 0.0004);
  EXPECT_NEAR(shape.centre.x(), 0.0001, 1e-15);
  EXPECT_NEAR(shape.centre.y(), 0.0536, 1e-15);
}

TEST(ActionFile, BodiesAndTheirFeltsKeepTheTotalsOfTheFile) {
  const ActionFile action = load_action(kGrandAction);
  double mass = body(action, "H").mass, inertia = body(action, "H").inertia;
  Vector2 moment = mass * body(action, "H").centre;
  // felts carried by the hammer and the points where it is touched there
  for (const auto& [name, x, y] :
       {std::tuple{"JH", -0.0208951479, -0.0179192185}, {"LH", -0.02, -0.018}, {"HG", -0.13, 0.028}}) {
    const double m = contact(action, name).felt.mass;
    mass += m;
    moment += m * Vector2(x, y);
    inertia += m * Vector2(x, y).squaredNorm();
  }
  EXPECT_NEAR(mass, 0.0125233504, 1e-15);
  EXPECT_NEAR((moment / mass - Vector2(-0.115, 0.006)).norm(), 0, 1e-14);
  EXPECT_NEAR(inertia, 1.65e-4, 1e-15);
}

TEST(ActionFile, WithoutHeldTotalsFeltsComeOnTop) {
  ActionOptions options;
  options.keep_totals = false;
  EXPECT_DOUBLE_EQ(body(load_action(kGrandAction, options), "H").mass, 0.0125233504);
}

TEST(ActionFile, SetReplacesAParameterEverywhere) {
  ActionOptions options;
  options.settings = {{"S_Jy", 0.06}, {"nu_JH", 0.5}};
  const ActionFile action = load_action(kGrandAction, options);
  EXPECT_DOUBLE_EQ(contact(action, "JG").shape_b.centre.y(), 0.06);
  EXPECT_DOUBLE_EQ(contact(action, "JH").friction, 0.5);
}

TEST(ActionFile, DamperOffClampsItAndItsContacts) {
  EXPECT_TRUE(body(load_action(kGrandAction), "D").is_held);
  EXPECT_FALSE(contact(load_action(kGrandAction), "KD").is_active);
  ActionOptions on;
  on.damper = true;
  EXPECT_FALSE(body(load_action(kGrandAction, on), "D").is_held);
  EXPECT_TRUE(contact(load_action(kGrandAction, on), "DG").is_active);
}

// ---- bad files, made of the good one by one edit

struct BadFile {
  const char* what;
  std::string from, to;             // edit
  std::string line_of;              // text whose line must be named; empty: no particular one
  std::vector<std::string> pieces;  // of the sentence
};

int line_number(const std::string& text, const std::string& piece) {
  const std::size_t at = text.find(piece);
  return at == std::string::npos
             ? -1
             : 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

std::string complaint_of(const std::filesystem::path& file, const ActionOptions& options = {}) {
  try {
    load_action(file, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "(accepted)";
}

TEST(ActionFile, BadFilesAreRefusedInOneSentenceWithTheirPlace) {
  const std::string good = test::read_text(kGrandAction);
  const std::vector<BadFile> cases{
      {"missing key", "      inertia: I_W\n", "", "    W:\n", {"inertia", "missing", "bodies W"}},
      {"misspelt key",
       "      inertia: I_W\n",
       "      inertai: I_W\n",
       "inertai: I_W",
       {"inertai is not known", "did you mean inertia?"}},
      {"unknown key",
       "      what: whippen\n",
       "      what: whippen\n      colour: I_W\n",
       "colour: I_W",
       {"colour", "not known"}},
      {"doubled key",
       "      inertia: I_W\n",
       "      inertia: I_W\n      inertia: I_K\n",
       "inertia: I_K\n      viscous: c_vW",
       {"inertia", "twice"}},
      {"unknown section", "mechanism:\n", "machine: {}\nmechanism:\n", "machine:", {"machine", "not known"}},
      {"unknown parameter",
       "inertia: I_W\n",
       "inertia: I_Wh\n",
       "inertia: I_Wh",
       {"inertia = I_Wh", "must name a parameter", "I_W"}},
      {"nan", "m_H: {value: 0.0125233504", "m_H: {value: nan", "m_H:", {"m_H = nan", "finite number"}},
      {"infinity", "m_H: {value: 0.0125233504", "m_H: {value: .inf", "m_H:", {"m_H = .inf", "finite number"}},
      {"word", "m_H: {value: 0.0125233504", "m_H: {value: heavy", "m_H:", {"m_H = heavy", "finite number"}},
      {"trailing unit", "m_H: {value: 0.0125233504", "m_H: {value: 12.5 g", "m_H:", {"m_H = 12.5 g", "finite number"}},
      {"list for a number", "m_H: {value: 0.0125233504", "m_H: {value: [1, 2]", "m_H:", {"m_H", "finite number"}},
      {"negative mass",
       "m_H: {value: 0.0125233504",
       "m_H: {value: -0.0125",
       "m_H:",
       {"m_H = -0.0125 kg", "must be > 0"}},
      {"zero radius", "W_Krho: {value: 0.012", "W_Krho: {value: 0", "W_Krho:", {"W_Krho = 0 m", "must be > 0"}},
      {"negative friction", "nu_JH: {value: 0.2", "nu_JH: {value: -0.2", "nu_JH:", {"nu_JH = -0.2", "must be >= 0"}},
      {"exponent below one", "r_KW: {value: 2.7", "r_KW: {value: 0.5", "r_KW:", {"r_KW = 0.5", "must be >= 1"}},
      {"corner larger than the jack's top",
       "J_Hrc: {value: 0.0004",
       "J_Hrc: {value: 0.004",
       "J_Hrc:",
       {"J_Hrc = 0.004 m", "half the length"}},
      {"felt heavier than its hammer",
       "m_fHG: {value: 1.28e-05",
       "m_fHG: {value: 0.02",
       "m_fHG:",
       {"m_fHG = 0.02 kg", "lighter"}},
      {"wrong unit",
       "m_H: {value: 0.0125233504, unit: \"kg\"",
       "m_H: {value: 0.0125233504, unit: \"g\"",
       "m_H:",
       {"m_H", "unit g", "must have kg"}},
      {"missing source",
       "m_H: {value: 0.0125233504, unit: \"kg\", source:",
       "m_H: {value: 0.0125233504, unit: \"kg\", origin:",
       "m_H:",
       {"source", "missing"}},
      {"parameter that nothing uses",
       "  # finger\n",
       "  # finger\n  S_Jz: {value: 1, unit: \"m\", source: \"x\"}\n",
       "S_Jz:",
       {"S_Jz", "used nowhere"}},
      {"contact that names no body",
       "a: {body: J, shape: segment, at: [J_Hx",
       "a: {body: X, shape: segment, at: [J_Hx",
       "a: {body: X",
       {"body = X", "must be a body"}},
      {"contact of a body with itself",
       "b: {body: H, shape: circle, at: [H_Jx",
       "b: {body: J, shape: circle, at: [H_Jx",
       "b: {body: J, shape: circle, at: [H_Jx",
       {"JH", "itself"}},
      {"two segments",
       "b: {body: H, shape: circle, at: [H_Jx, H_Jy], direction: H_Jtheta, radius: H_Jrho}",
       "b: {body: H, shape: segment, at: [H_Jx, H_Jy], direction: H_Jtheta, length: H_Jrho}",
       "b: {body: H, shape: segment",
       {"JH", "circle"}},
      {"loop in the tree",
       "      what: whippen\n      parent: S\n",
       "      what: whippen\n      parent: J\n",
       "parent: J",
       {"parent = J", "declared above"}},
      {"its own parent",
       "      what: whippen\n      parent: S\n",
       "      what: whippen\n      parent: W\n",
       "parent: W\n      joint: hinge\n      origin: [W_O",
       {"parent = W", "declared above"}},
      {"unknown joint",
       "      what: whippen\n      parent: S\n      joint: hinge\n",
       "      what: whippen\n      parent: S\n      joint: ball\n",
       "joint: ball",
       {"joint = ball", "hinge, prismatic"}},
      {"unknown event", "{let_off: JG,", "{letoff: JG,", "events:", {"letoff", "did you mean let_off"}},
      {"jack with less inertia than its mass has",
       "J_Gy: {value: 0,",
       "J_Gy: {value: 0.03,",
       "I_J:",
       {"I_J = 1.5e-06", "at least"}},
      {"damper contact elsewhere",
       "contacts: [KD, DG]",
       "contacts: [KD, HG]",
       "damper:",
       {"HG", "contacts of its body"}},
      {"hammer that never meets the string", "hammer: H}", "hammer: L}", "events:", {"hammer = L", "HG"}},
      {"felt axis into its carrier",
       "mass: m_fHG, axis: contact_normal",
       "mass: m_fHG, axis: fixed, direction: H_Stheta",
       "axis: fixed",
       {"direction = H_Stheta", "must point"}},
      {"name with a comma",
       "    W:\n      what: whippen",
       "    \"W,x\":\n      what: whippen",
       "\"W,x\"",
       {"W,x", "letters, digits"}},
      {"friction and restitution",
       "      felt: {carrier: b, stiffness: k_JG, exponent: r_JG, damping: b_JG, mass: m_fJG, axis: contact_normal}\n",
       "      restitution: nu_JG\n",
       "restitution: nu_JG",
       {"JG", "only one of them"}},
      {"name too long",
       "name: grand action",
       "name: the grand action of 1821",
       "name: the grand",
       {"name", "at most 15"}},
      {"event of no contact", "{let_off: JG,", "{let_off: JX,", "{let_off: JX", {"let_off = JX", "must be a contact"}},
  };
  const test::TemporaryFolder folder;
  for (const BadFile& bad : cases) {
    ASSERT_NE(good.find(bad.from), std::string::npos) << bad.what;
    std::string text = good;
    text.replace(text.find(bad.from), bad.from.size(), bad.to);
    const auto file = folder / "action.yaml";
    test::write_text(file, text);
    const std::string said = complaint_of(file);
    EXPECT_EQ(said.find('\n'), std::string::npos) << bad.what << ": " << said;
    EXPECT_NE(said.find(file.string() + ":" + std::to_string(line_number(text, bad.line_of)) + ": "), std::string::npos)
        << bad.what << " (line " << line_number(text, bad.line_of) << "): " << said;
    for (const std::string& piece : bad.pieces)
      EXPECT_NE(said.find(piece), std::string::npos) << bad.what << ": " << said;
  }
}

TEST(ActionFile, FilesThatAreNoActionsAreRefusedInOneSentence) {
  const std::string good = test::read_text(kGrandAction);
  const test::TemporaryFolder folder;
  const auto refuse = [&](const std::string& text, const std::string& piece) {
    test::write_text(folder / "bad.yaml", text);
    const std::string said = complaint_of(folder / "bad.yaml");
    EXPECT_NE(said.find("bad.yaml"), std::string::npos) << said;
    EXPECT_NE(said.find(piece), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  };
  refuse("", "must be a mapping");
  refuse("just words", "must be a mapping");
  refuse("- 1\n- 2\n", "must be a mapping");
  refuse("parameters: {}\n", "mechanism is missing");
  refuse("parameters: [1]\nmechanism: {}\n", "parameters");
  refuse(std::string("\x7f"
                     "ELF\x02\x01\x00\x00",
                     8),
         "not text");
  refuse("a: [1, 2\nb: {c", "not valid YAML");
  refuse("\t\t: : :", "");
  refuse(good + "\n---\na: 1\n", "second YAML document");
  // cut after any line, it is refused: the sections that may be left out stand first
  for (std::size_t cut = 0; cut + 10 < good.size(); cut = good.find('\n', cut) + 1) {
    test::write_text(folder / "cut.yaml", good.substr(0, cut));
    const std::string said = complaint_of(folder / "cut.yaml");
    EXPECT_NE(said, "(accepted)") << cut;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

TEST(ActionFile, SettingsMustBeFinite) {
  ActionOptions options;
  options.settings = {{"S_Jy", std::nan("")}};
  EXPECT_NE(complaint_of(kGrandAction, options).find("--set S_Jy=nan: must be a finite number"), std::string::npos);
}

TEST(ActionFile, PlacesThatAreNoFilesAreRefused) {
  EXPECT_NE(complaint_of("/no/such/action.yaml").find("/no/such/action.yaml: cannot be read"), std::string::npos);
  EXPECT_NE(complaint_of("/tmp").find("/tmp: is a folder"), std::string::npos);
  EXPECT_NE(complaint_of("/dev/zero").find("/dev/zero"), std::string::npos);
}

TEST(ActionFile, TooManyFeltsWithMassAreToldAgainstTheCapacity) {
  std::string text = test::read_text(kGrandAction);  // 6 bodies, 14 felts: room for four more
  const std::string key_front = "\n    KS+:";
  const std::size_t at = text.find(key_front);
  ASSERT_NE(at, std::string::npos);
  const std::size_t end = text.find("\n    KW:", at);  // the next contact
  ASSERT_NE(end, std::string::npos);
  const std::string contact = text.substr(at + key_front.size(), end - at - key_front.size());
  std::string more;
  for (int i = 0; i < 5; ++i) more += "\n    more" + std::to_string(i) + ":" + contact;
  text.insert(end, more);
  const test::TemporaryFolder folder;
  test::write_text(folder / "felts.yaml", text);
  ActionOptions options;
  EXPECT_EQ(load_action(folder / "felts.yaml", options).model.contact_count, 19);
  options.felts = FeltModel::bodies;
  const std::string complaint = complaint_of(folder / "felts.yaml", options);
  EXPECT_NE(complaint.find("has 25 coordinates"), std::string::npos) << complaint;
  EXPECT_NE(complaint.find("at most " + std::to_string(kMaxCoordinates)), std::string::npos) << complaint;
}

TEST(ActionFile, TooManyBodiesAreToldAgainstTheCapacity) {
  std::string text =
      "parameters:\n  z: {value: 0, unit: \"m\", source: \"x\"}\n  r: {value: 0, unit: \"rad\", source: \"x\"}\n"
      "  m: {value: 1, unit: \"kg\", source: \"x\"}\n  i: {value: 1, unit: \"kg m^2\", source: \"x\"}\n"
      "  g: {value: 9.81, unit: \"m/s^2\", source: \"x\"}\nmechanism:\n  name: chain\n  gravity: g\n  bodies:\n";
  for (int i = 0; i <= kMaxBodies; ++i)
    text += "    B" + std::to_string(i) +
            ": {what: link, parent: S, joint: hinge, origin: [z, z], mass: m, centre: [z, z], inertia: i, "
            "initial_angle: r}\n";
  const test::TemporaryFolder folder;
  test::write_text(folder / "chain.yaml", text);
  EXPECT_NE(complaint_of(folder / "chain.yaml").find("at most " + std::to_string(kMaxBodies)), std::string::npos);
}

}  // namespace
}  // namespace erard
