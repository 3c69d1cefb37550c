// One section of docs/validation.md: what every study gives.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace erard::study {

/// A printed number of the thesis that a computed one contradicts by more than kContradiction.
struct Contradiction {
  std::string quantity;    // with its unit and place
  std::string printed;     // as in the thesis
  std::string computed;    // here
  std::string difference;  // computed / printed - 1
  std::string why;
};
inline constexpr double kContradiction = 0.02;

struct Section {
  std::string title;   // heading of the second level
  std::string result;  // what came out, in one line, for the table of contents
  std::string text;    // Markdown: tables, and pictures as ![](images/validation/NAME.svg)
  std::vector<Contradiction> contradictions;
};

/// Where a study puts its pictures, and how its text refers to them.
struct Pictures {
  std::filesystem::path folder;  // must exist
  std::string link;              // of that folder, as seen from the document
};

/// Markdown table: `head` and the cells of each row.
std::string table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);

/// A number as the thesis prints it beside what its own definition gives.
struct Recomputed {
  std::string quantity;
  double printed = 0;
  double computed = 0;
  std::string why;  // of a difference

  /// computed / printed - 1; 0 where both are infinite.
  double difference() const noexcept { return printed == computed ? 0 : computed / printed - 1; }
  bool is_contradicted() const noexcept;
};

/// Those of them that are contradicted.
std::vector<Contradiction> contradictions_of(const std::vector<Recomputed>& all);

std::string table(const std::vector<Contradiction>& contradictions);

/// Those that are not, without a reason.
std::string table_of_confirmed(const std::vector<Recomputed>& all);

// Numbers in text and tables.
std::string fixed(double value, int digits);  // never "-0.0"; "-" where there is none
std::string three_digits(double value);       // significant ones; "infinite"
std::string signed_percent(double share);     // "+1.3 %"
std::string percent(double share);            // "1.3", from 10 on "13"
inline std::string milliseconds(double time, int digits = 1) { return fixed(1e3 * time, digits); }

}  // namespace erard::study
