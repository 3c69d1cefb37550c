// The complete action as an experimenter sees it: what a key did under a stroke, and what its parts amount to.
#pragma once

#include <string>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/keystroke.hpp"
#include "study/simple_key.hpp"

namespace erard::study::simple {

/// A stroke recorded on the complete action, every 0.5 ms.
struct KeyRecord {
  std::string name;                 // of the keystroke
  KeyMotion motion;                 // with acceleration
  std::vector<double> force;        // of the finger [N]
  std::vector<double> hammer_rate;  // of the hammer, positive towards the string [rad/s]
  double let_off = 0;               // the jack meets the let-off button [s]
  double let_off_angle = 0;         // of the key then [rad]
  double rail = 0;                  // the key meets the front rail punching [s]
  double release = 0;               // the finger lets the key rise: end of (6.3) [s]
};

/// Plays a keystroke on the complete action: piston drive, settings of erard-sim.
/// Throws std::runtime_error when the stroke does not reach let-off and front rail.
KeyRecord record_keystroke(const ActionFile& action, const Keystroke& keystroke, const std::string& name,
                           double release);

/// The parts of this action, got as the thesis got its own: inertias, weights and losses from the separate bodies,
/// lever ratios and F_down, F_up from a press and return of 6 mm/s.
/// Throws std::invalid_argument when the action has not the parameters of config/grand_action.yaml.
KeyParts measure_parts(const ActionFile& action);

/// K of (2.5) as the thesis got it, the average ratio of moment and angle while F < F_down; by least squares,
/// K = sum(L F theta) / sum(theta^2) over all records [N m/rad].
double blocked_stiffness(const std::vector<KeyRecord>& records, const KeyParts& parts);

/// The first row whose force reaches `force` [N].
std::size_t row_of_force(const KeyRecord& record, double force);

/// When the key carries the hammer: from then to the let-off the hammer turns within a tenth of alpha_31 times the
/// key's rate, for which (2.1) holds [s].
double carried_from(const KeyRecord& record, double alpha31);

/// BH and SK of this action. b of the punching is the thesis's, 40 times that of (4.10): it stands for the losses in
/// the backcheck too.
SimpleAction action_model(const ActionFile& action, const KeyParts& parts, double stiffness);

}  // namespace erard::study::simple
