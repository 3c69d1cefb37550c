// The part of a Markdown file that a program writes; the rest is written by people.
#pragma once

#include <filesystem>
#include <string>

namespace erard::bench {

/// A block is what stands between the two lines
///   <!-- NAME: written by the program, do not edit -->
///   <!-- end of NAME -->
class MarkdownBlock {
 public:
  /// Reads the file; one that does not exist becomes one with this block alone.
  /// Throws InputError when it exists and has not both lines once and in this order, or cannot be written.
  MarkdownBlock(std::filesystem::path file, const std::string& name);

  /// Writes the file with `text` in the block: whole, or not at all. Throws std::runtime_error.
  void replace(const std::string& text) const;

 private:
  std::filesystem::path file_;
  std::string before_, after_;  // with the lines of the block
};

}  // namespace erard::bench
