// Chapter 2 of the thesis: which comparison can tell a bad model from a good one? One degree of freedom against the
// complete action, driven by its force and driven by its motion.
#pragma once

#include <array>
#include <vector>

#include "study/key_record.hpp"
#include "study/section.hpp"
#include "study/simple_key.hpp"

namespace erard::study::simple {

/// Distance of two curves over a window of time.
struct Error {
  double eta = 0;      // relative, thesis (6.3) [-]
  double largest = 0;  // [m] or [N]
};

/// Error by phase of the stroke. Phases that the model's curve does not cover are left out.
struct PhaseErrors {
  Error pick_up;  // until the key carries the hammer
  Error carried;  // from then to the let-off
  Error after;    // from the let-off to the release
  Error whole;    // from the start to the release, as (6.3)
};

/// The two comparisons.
struct Verdict {
  PhaseErrors motion;  // force given, motion compared
  PhaseErrors force;   // motion given, force compared
};

/// BH, then SK, from rest.
/// @param carried  end of the pick-up, carried_from() [s]
Verdict judge(const SimpleAction& model, const KeyRecord& record, double carried);

/// SK alone, from the recorded position and rate where the force reaches `down_force` [N].
Verdict judge_alone(SimpleAction model, const KeyRecord& record, double carried, double down_force);

/// What the record would be if SK alone were the truth from `down_force` [N] on: the same force, SK's motion.
KeyRecord simple_record(SimpleAction model, const KeyRecord& record, double down_force);

/// Whether another inertia would do: the whole-stroke errors (6.3) of models that differ from one in J alone.
struct InertiaScan {
  double best_factor = 0;   // of J, where the motion is nearest [-]
  double least_motion = 0;  // eta of the motion there [-]
  double least_force = 0;   // eta of the force, wherever it is least [-]
};

/// J times 0.1, 0.15 .. 1.5.
InertiaScan scan_inertia(const SimpleAction& model, const KeyRecord& record);

/// Columns of Table 2.3: what is given, what comes out.
enum class Path { force_to_motion, motion_to_force, position_to_force, acceleration_to_force };
inline constexpr std::array kPaths{Path::force_to_motion, Path::motion_to_force, Path::position_to_force,
                                   Path::acceleration_to_force};

/// One column of Table 2.3: relative changes (6.3) of what comes out of SK alone.
struct Sensitivity {
  double model = 0;    // against the complete action
  double initial = 0;  // the start moved by 0.1 mm and 10 mm/s
  double noise = 0;    // what is given rounded to 1/200 of its largest value: the laser's 50 um are that of the dip
};

/// @param down_force  SK starts where the force reaches it [N]
/// @param until       end of the comparison [s]
Sensitivity sensitivity(Path path, SimpleAction model, const KeyRecord& record, double down_force, double until);

/// One stroke of the complete action and when it carries the hammer.
struct Stroke {
  KeyRecord record;
  double carried = 0;  // carried_from() [s]
};

/// What the section and its tests start from.
struct SimpleModelsStudy {
  KeyParts parts;      // of this action
  SimpleAction model;  // BH and SK of this action
  Stroke piano, forte;
};

/// Cost: 3 s simulated.
SimpleModelsStudy study_simple_models();

}  // namespace erard::study::simple

namespace erard::study {

Section simple_models_section(const Pictures& pictures);

}  // namespace erard::study
