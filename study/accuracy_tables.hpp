// The tables and the diagram of docs/accuracy.md. They take the time of every run: bench_accuracy writes them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/work_precision.hpp"

namespace erard::study {

/// A stroke and what is right about it.
struct Reference {
  JudgedStroke stroke;
  JudgedRun truth;  // converged
  JudgedRun half;   // with half as many steps
};
Reference make_reference(const ActionFile& action, const JudgedStroke& stroke);

/// tick() with the settings that it has if nobody touches them.
Candidate default_ticks();

/// Every scheme that was compared, one family after the other.
std::vector<Candidate> candidates();

/// One scheme on several strokes.
struct Judgement {
  Candidate candidate;
  std::vector<ForceError> error;  // of each stroke
  std::vector<double> cost;       // [us a tick]
};
Judgement judge(const ActionFile& action, const Candidate& candidate, const std::vector<Reference>& references);

ForceError error_of(const JudgedRun& run, const Reference& reference);

// Of the default: force and cost; events; the key on the rail (of piano and forte, the first two references).
std::string default_table(const ActionFile& action, const std::vector<Reference>& references);
std::string event_table(const ActionFile& action, const std::vector<Reference>& references);
std::string ringing_table(const ActionFile& action, const std::vector<Reference>& references);

/// Piano and forte, the first two references, against the curves of another program: NAME.csv in the folder.
std::string independent_table(const ActionFile& action, const std::vector<Reference>& references,
                              const std::filesystem::path& folder);

// Of the candidates. The diagram is drawn by gnuplot.
std::string judgement_table(const std::vector<Judgement>& all, const std::vector<Reference>& references);
void draw_diagram(const std::filesystem::path& svg, const std::vector<Judgement>& all,
                  const std::vector<Reference>& references);

// Of the default's settings: when a step is refused and into how many it is split; tolerances and limits.
std::string surprise_table(const ActionFile& action, const std::vector<Reference>& references);
std::string tolerance_table(const ActionFile& action, const std::vector<Reference>& references);

}  // namespace erard::study
