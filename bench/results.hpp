// The results as files and as a table for people.
#pragma once

#include <string>
#include <vector>

#include "bench/machine.hpp"
#include "bench/row.hpp"
#include "erard/device/output_file.hpp"

namespace erard::bench {

/// A whole run.
struct Results {
  Circumstances circumstances;
  bool has_damper = true;
  bool is_complete = true;  // false: interrupted
  std::vector<Row> rows;
};

/// Lines of comment (`# key: value`) with the circumstances, a header, a row for each entrant. Empty cell: not measured,
/// or not stated for want of samples. Times in us. docs/performance.md explains the columns.
void write_csv(OutputFile& file, const Results& results);

/// The same and the targets: {"circumstances": {...}, "complete": ..., "rows": [{column: value, ...}, ...],
/// "targets": [...]}; null for an empty cell.
void write_json(OutputFile& file, const Results& results);

/// Circumstances, one line an entrant, how to read it; the thesis's figure and the targets, where they were measured.
std::string table(const Results& results);

/// The tables of docs/performance.md.
std::string markdown(const Results& results);

/// "12.3": three digits that matter; "-" for what is not there.
std::string three_digits(double value);
std::string us_cell(double seconds);  // [us]

/// What the machine itself adds, from the fixed work.
std::string noise_line(const std::vector<Row>& rows);

/// What one action takes: "63392 bytes: ..."
std::string memory_of_an_action();

/// With as many digits after the point; "-" for what is not there.
std::string cell(double value, int digits);

}  // namespace erard::bench
