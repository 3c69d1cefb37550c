// Runs a program of the project and keeps what it says.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace erard::test {

namespace fs = std::filesystem;

struct Outcome {
  int exit_code = -1;
  std::string out;    // stdout
  std::string error;  // stderr
};

/// A folder of this test's own, empty, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "erard-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  fs::path operator/(const std::string& name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

inline std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_text(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

/// @param command  of a shell, the first word a program in ERARD_PROGRAM_DIR
inline Outcome run_program(const std::string& command) {
  const TemporaryFolder folder;
  const std::string error_file = folder / "stderr";
  const std::string line = std::string(ERARD_PROGRAM_DIR) + "/" + command + " 2>" + error_file;
  Outcome outcome;
  std::FILE* pipe = popen(line.c_str(), "r");
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    outcome.out.append(buffer.data(), n);
  const int status = pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.error = read_text(error_file);
  return outcome;
}

/// Exit code 2 and exactly one line that holds every one of the pieces.
inline void expect_one_sentence(const Outcome& outcome, const std::vector<std::string>& pieces) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.error;
  EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  for (const std::string& piece : pieces) EXPECT_NE(outcome.error.find(piece), std::string::npos) << outcome.error;
}

}  // namespace erard::test
