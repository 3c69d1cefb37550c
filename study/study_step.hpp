// The step of the studies.
#pragma once

namespace erard::study {

/// Fixed internal step of the runs whose rows are looked at one by one or replayed [s]: forte within 0.05 N rms.
inline constexpr double kStudyStep = 1.25e-4;

}  // namespace erard::study
