// A program of the project as a process of its own, to be talked to by signals.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "program.hpp"

namespace erard::test {

struct ChildSettings {
  std::vector<std::string> environment{};  // NAME=value, beside that of the test
  std::function<bool()> prepare{};         // called in the process before it becomes the program; system calls only
  std::string out{}, error{};              // where they go; empty: into files of the child's folder
};

/// Killed when it goes out of scope, if it still runs.
class Child {
 public:
  /// @param program  in ERARD_PROGRAM_DIR
  Child(const std::string& program, std::vector<std::string> arguments, const ChildSettings& settings = {})
      : out_(settings.out.empty() ? folder_ / "out" : fs::path(settings.out)),
        error_(settings.error.empty() ? folder_ / "error" : fs::path(settings.error)) {
    fs::permissions(folder_.path(), fs::perms::all);
    arguments.insert(arguments.begin(), std::string(ERARD_PROGRAM_DIR) + "/" + program);
    std::vector<std::string> environment;
    for (char** entry = environ; *entry != nullptr; ++entry) environment.emplace_back(*entry);
    environment.insert(environment.begin(), settings.environment.begin(), settings.environment.end());
    const std::vector<char*> argv = pointers(arguments), envp = pointers(environment);
    process_ = fork();
    if (process_ == 0) become(argv, envp, settings);
  }
  ~Child() {
    if (is_running_) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void send(int signal) const { kill(process_, signal); }
  pid_t process() const { return process_; }
  std::string out() const { return text_of(out_); }
  std::string error() const { return text_of(error_); }

  bool is_running() {
    int status = 0;
    if (is_running_ && waitpid(process_, &status, WNOHANG) == process_) end(status);
    return is_running_;
  }

  /// Waits a minute at most. @return what it left
  Outcome wait() {
    const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (is_running() && std::chrono::steady_clock::now() < latest)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_FALSE(is_running_) << "does not end";
    return {exit_code_, out(), error()};
  }

 private:
  static std::string text_of(const fs::path& file) {  // a device may have no end
    return fs::is_regular_file(file) ? read_text(file) : "";
  }
  static std::vector<char*> pointers(std::vector<std::string>& words) {
    std::vector<char*> all;
    for (std::string& word : words) all.push_back(word.data());
    all.push_back(nullptr);
    return all;
  }

  [[noreturn]] void become(const std::vector<char*>& argv, const std::vector<char*>& envp,
                           const ChildSettings& settings) const {
    for (const auto& [path, descriptor] : {std::pair{&out_, STDOUT_FILENO}, {&error_, STDERR_FILENO}}) {
      const int file = open(path->c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
      if (file < 0 || dup2(file, descriptor) < 0) _exit(126);
      close(file);
    }
    if (chdir(folder_.path().c_str()) != 0) _exit(126);
    if (settings.prepare && !settings.prepare()) _exit(125);
    execve(argv[0], argv.data(), envp.data());
    _exit(127);
  }

  void end(int status) {
    is_running_ = false;
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  TemporaryFolder folder_;  // it runs there
  fs::path out_, error_;
  pid_t process_ = -1;
  bool is_running_ = true;
  int exit_code_ = -1;
};

}  // namespace erard::test
