// report.html: one run to be looked at, in one file that needs no network.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "erard/device/regulation.hpp"
#include "erard/device/results.hpp"
#include "erard/device/scene.hpp"

namespace erard {

/// What the report compares with.
struct OtherRun {
  std::string name;  // as given on the command line
  ForceCurve force;
  std::string run_json;  // of the other's report.html: poses, events and all columns; else empty
};

/// Reads a folder of results (its report.html if it has one, else its trajectory.csv) or a CSV with t_s and force_N.
/// Throws InputError.
OtherRun read_other_run(const std::filesystem::path& path);

struct Report {
  const RunSummary* summary = nullptr;
  const Scene* scene = nullptr;
  const ReportRows* rows = nullptr;
  std::vector<Measure> measures;
  const OtherRun* other = nullptr;  // or none
};

/// Writes the page. A run that was stopped or did not converge says so on top.
/// Size: 0.8 MB for a stroke of one second at 2 kHz with 14 contacts.
void write_report(OutputFile& file, const Report& report);

/// Writes single poses as SVG: pose_<word>.svg in `folder` for each word, a time in s or the name of an event (its first).
/// @return the files. Throws InputError when a word is neither or the run has no such event.
std::vector<std::filesystem::path> write_poses(const std::filesystem::path& folder,
                                               const std::vector<std::string>& words, const Report& report);

}  // namespace erard
