// Contacts of an action without their felt.
#pragma once

#include "erard/device/action_file.hpp"

namespace erard::study {

/// Takes the felt out of one contact: the bodies then touch directly. The felt's mass goes back to its carrier, from
/// which load_action() took it:
///   m = m' + m_f      m B_G = m' B_G' + m_f P      I = I' + m_f |P|^2
/// @param contact      of `model`, with a felt
/// @param restitution  e in [0, 1]; only where the contact has no friction
void remove_felt(Model& model, int contact, double restitution = 0);

/// Sets the surface of a contact back by `depth` [m]: what pressed a felt that deep just touches. It is the circle of the
/// contact whose radius shrinks.
void set_back(Model& model, int contact, double depth);

}  // namespace erard::study
