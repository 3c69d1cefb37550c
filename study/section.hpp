// One section of docs/validation.md: what every study gives.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace erard::study {

struct Section {
  std::string title;  // heading of the second level
  std::string text;   // Markdown: tables, and pictures as ![](images/validation/NAME.svg)
};

/// Where a study puts its pictures, and how its text refers to them.
struct Pictures {
  std::filesystem::path folder;  // must exist
  std::string link;              // of that folder, as seen from the document
};

/// Markdown table: `head` and the cells of each row.
std::string table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);

}  // namespace erard::study
