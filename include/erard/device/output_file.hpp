// Files that are whole or not there.
#pragma once

#include <filesystem>
#include <fstream>
#include <initializer_list>
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
  void close();    // all of it on the disk, still as NAME.part; throws std::runtime_error when the disk did not take it
  void publish();  // gives it its name; after close()
  void commit() {
    close();
    publish();
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::filesystem::path part_;
  std::ofstream stream_;
  bool is_committed_ = false;
};

/// Files that belong together: all are whole before the first of them gets its name, so that a full disk leaves none.
void commit_together(std::initializer_list<OutputFile*> files);

}  // namespace erard
