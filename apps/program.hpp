// What every program does alike: it parses its arguments, runs, and says in one line what went wrong.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "erard/device/error.hpp"
#include "erard/version.hpp"

namespace erard {

inline constexpr int kDone = 0, kFailed = 1, kBadInput = 2, kInterrupted = 130;

/// A message on one line of the standard error, whatever names it quotes.
inline void complain(std::string message) {
  for (char& c : message)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  std::fputs((message + '\n').c_str(), stderr);  // which may be closed
}

/// Of an option: a number from `least` to `most`, which CLI::Range takes "nan" for as well.
inline CLI::Validator number_from(double least, double most) {
  const auto check = [least, most](const std::string& word) -> std::string {
    double value = 0;
    if (CLI::detail::lexical_cast(word, value) && value >= least && value <= most) return {};
    return fmt::format("Value {} not in range {:g} to {:g}", word, least, most);
  };
  return CLI::Validator(check, fmt::format("FLOAT in [{:g} - {:g}]", least, most));
}

/// Parses the arguments into what `app` was told of, then runs. Adds --version.
/// @param app  its name is the program's
/// @param run  int(): the exit code
/// @return exit code: that of run(); kBadInput for wrong arguments and InputError, kFailed for any other exception
template <typename Run>
int run_program(CLI::App& app, int argc, char** argv, Run&& run) {
  app.set_version_flag("--version", fmt::format("{} {}", app.get_name(), kVersion));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    complain(fmt::format("{}: {}; see {} --help", app.get_name(), error.what(), app.get_name()));
    return kBadInput;
  }
  try {
    return run();
  } catch (const InputError& error) {
    complain(error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    complain(fmt::format("{}: {}", app.get_name(), error.what()));
    return kFailed;
  }
}

}  // namespace erard
