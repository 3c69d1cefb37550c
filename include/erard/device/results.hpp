// What a run leaves behind: trajectory.csv, events.yaml, summary.yaml, one-step problems.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "erard/device/force_curve.hpp"
#include "erard/device/output_file.hpp"
#include "erard/device/simulation.hpp"

namespace erard {

/// DIR/trajectory.csv, one row a period, written while the run goes on.
/// Columns: t_s, input, y_m, force_N, theta_<body>.., omega_<body>.., delta_<contact>_m, normal_<contact>_N ..
/// theta absolute [rad]; delta: compression of a closed felt, minus the gap of an open contact.
class TrajectoryFile {
 public:
  TrajectoryFile(OutputFile& file, const Model& model);
  void add(const Snapshot& row);

 private:
  OutputFile& file_;
  std::string line_;
};

/// One JSON object a line and internal step: {"time_s", "W", "q", "r", "cone"}; W by rows; cone: for each row
/// {"kind": "half_line"} | {"kind": "friction", "normal", "mu"} | {"kind": "interval", "bound"}, "angular": true on hinges.
/// Law: u = W r + q; half_line 0 <= r, 0 <= u, r u = 0; the others |r| <= bound, u against r (u = 0 inside).
class ProblemFile {
 public:
  explicit ProblemFile(OutputFile& file) : file_(file) {}
  void add(const OneStepProblem& problem, const RowVector& impulse, double time);

 private:
  OutputFile& file_;
};

struct Comparison {
  std::string file;
  double from = 0;  // window [s]
  double until = 0;
  double eta = 0;  // [-]
};

/// What summary.yaml and the terminal tell.
struct RunSummary {
  std::string action;
  std::string keystroke;
  TickSettings tick;
  double start = 0;
  RunResult result;
  std::optional<Comparison> comparison;
};

const char* name_of(DriveKind drive);

void write_events(OutputFile& file, const std::vector<Event>& events);
void write_summary(OutputFile& file, const RunSummary& summary);

/// The summary for a person at a terminal.
std::string describe(const RunSummary& summary);

}  // namespace erard
