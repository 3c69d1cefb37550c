// Files that are whole or not there.
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

namespace erard {

/// Makes the folder (and those above) and checks that a file can be written in it. Throws InputError.
void prepare_output_folder(const std::filesystem::path& folder);

/// A file written beside its final name (NAME.part) and renamed at the end: readers never see half of it.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path path);  // throws InputError when it cannot be created
  ~OutputFile();                                    // without commit() nothing is left behind
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text) { stream_.write(text.data(), static_cast<std::streamsize>(text.size())); }
  void commit();  // throws std::runtime_error when the disk did not take all of it
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::filesystem::path part_;
  std::ofstream stream_;
  bool is_committed_ = false;
};

}  // namespace erard
