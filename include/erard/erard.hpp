// Table of contents of erard: a mechanism as data, its mechanics, its solver, its touch. Read in this order;
// if in a hurry, start with solver/step.hpp. Header-only, Eigen alone; no heap and no exceptions once built.
#pragma once

#include "erard/version.hpp"

// model: what is loaded and never changes
#include "erard/model/capacity.hpp"
#include "erard/model/name.hpp"
#include "erard/model/heading.hpp"
#include "erard/model/body.hpp"
#include "erard/model/contact.hpp"
#include "erard/model/model.hpp"

// mechanics: geometry, kinematics, dynamics, felts, contacts
#include "erard/mechanics/rows.hpp"
#include "erard/mechanics/mechanism.hpp"
#include "erard/mechanics/state.hpp"
#include "erard/mechanics/frames.hpp"
#include "erard/mechanics/distance.hpp"
#include "erard/mechanics/contact_frames.hpp"
#include "erard/mechanics/felt_law.hpp"
#include "erard/mechanics/dynamics.hpp"
#include "erard/mechanics/energy.hpp"
#include "erard/mechanics/rest.hpp"

// solver: one step
#include "erard/solver/scheme.hpp"
#include "erard/solver/drive.hpp"
#include "erard/solver/branch_factor.hpp"
#include "erard/solver/one_step_problem.hpp"
#include "erard/solver/gauss_seidel.hpp"
#include "erard/solver/workspace.hpp"
#include "erard/solver/row_direction.hpp"
#include "erard/solver/place_middle.hpp"
#include "erard/solver/linearise.hpp"
#include "erard/solver/assemble_rows.hpp"
#include "erard/solver/slide_on.hpp"
#include "erard/solver/step.hpp"

// haptics: what the finger moves and feels
#include "erard/haptics/finger.hpp"
#include "erard/haptics/tick.hpp"
#include "erard/haptics/sleep.hpp"
#include "erard/haptics/keyboard.hpp"
#include "erard/haptics/velocity.hpp"
#include "erard/haptics/events.hpp"
#include "erard/haptics/fault.hpp"
#include "erard/haptics/position_watch.hpp"
#include "erard/haptics/rate_estimator.hpp"
#include "erard/haptics/piston_track.hpp"
#include "erard/haptics/passivity.hpp"
#include "erard/haptics/guard.hpp"
#include "erard/haptics/actuator.hpp"
#include "erard/haptics/hammer_watch.hpp"
#include "erard/haptics/renderer.hpp"
