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
/// or not stated for want of samples. Times in us. docs/performance.md tells the columns.
void write_csv(OutputFile& file, const Results& results);

/// The same: {"circumstances": {...}, "complete": ..., "rows": [{column: value, ...}, ...]}; null for an empty cell.
void write_json(OutputFile& file, const Results& results);

/// Circumstances, one line an entrant, how to read it.
std::string table(const Results& results);

}  // namespace erard::bench
