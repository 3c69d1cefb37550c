// The action as a file: YAML, SI, every number with its unit and its source.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "erard/device/config_text.hpp"
#include "erard/haptics/events.hpp"
#include "erard/model/model.hpp"

namespace erard {

/// One number of the file, under its thesis name. `value` is what is in force, after --set.
struct Parameter {
  std::string name;
  double value = 0;
  std::string unit;    // SI, "-" for none
  std::string source;  // "thesis ...", "derived: ...", "reconstructed: ...", or whatever the author wrote
  int line = 0;        // in the file, from 1
};

/// An action, ready to be simulated, and what a person wants to know about it.
struct ActionFile {
  Model model;
  ActionRoles roles;
  std::vector<Parameter> parameters;  // in order of the file
  std::vector<std::string> notes;     // what somebody who set the options should know
};

/// One `--set NAME=VALUE`: absolute, in the unit of the file.
struct Setting {
  std::string name;
  double value = 0;
};

/// What lies between the bodies of a contact that has a felt in the file.
enum class FeltModel {
  massless,  // a felt without mass, its compression kept as history: the same force to 0.4 %, several times faster
  bodies,    // the felt as a light body on a slide                                     thesis 5.4.2
  rigid,     // nothing: an inelastic contact of rigid bodies                           thesis 6.3.3
};

struct ActionOptions {
  std::vector<Setting> settings;     // replace values before anything is derived from them
  std::vector<std::string> without;  // names of contacts to take out of play
  bool damper = false;
  FeltModel felts = FeltModel::massless;
  /// The masses, first moments and moments of inertia in the file include the felts.
  ///   true   the felt's mass is taken out of its carrier, so that heavier felts leave the totals as they are
  ///   false  the felt's mass comes on top of them
  bool keep_totals = true;
};

/// Reads config/grand_action.yaml or another action of that form; docs/action_file.md has the keys.
/// Strict: keys that are not known, missing or doubled, numbers without the right unit, impossible values, parameters
/// that nothing uses, all are refused.
/// Taking a felt of mass m at P (the middle of its zone on the carrier) out of the carrier:
///   m' = m_B - m      m' B_G' = m_B B_G - m P      I' = I_B - m |P|^2
/// Throws InputError with one sentence "file:line: key = value, rule", or "--set NAME=VALUE: ..." where that is to blame.
/// Nothing is half-loaded: the result exists only when all of it is right.
ActionFile load_action(const std::filesystem::path& file, const ActionOptions& options = {});
ActionFile load_action(const ConfigText& config, const ActionOptions& options = {});

}  // namespace erard
