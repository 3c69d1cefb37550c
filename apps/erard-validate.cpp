// erard-validate: the thesis's study again, from the built engine: writes docs/validation.md with its tables and plots.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "erard/device/error.hpp"
#include "erard/device/output_file.hpp"
#include "erard/version.hpp"
#include "study/causal_input.hpp"
#include "study/pendulum.hpp"
#include "study/published_figures.hpp"
#include "study/recordings.hpp"
#include "study/section.hpp"
#include "study/simple_models.hpp"
#include "study/strokes.hpp"
#include "study/thesis_tables.hpp"
#include "study/without_felts.hpp"

namespace {

using namespace erard;
using study::Pictures;
using study::Section;

struct Study {
  const char* name;  // of its heading's link and for --only
  Section (*write)(const Pictures&);
};

/// In the order of the document.
const std::vector<Study> kStudies{
    {"pendulum", study::pendulum_section},           {"simple_models", study::simple_models_section},
    {"thesis_tables", study::thesis_tables_section}, {"strokes", study::strokes_section},
    {"without_felts", study::without_felts_section}, {"recordings", study::recordings_section},
    {"causal_input", study::causal_input_section},   {"published_figures", study::published_figures_section},
};

constexpr const char* kPreamble =
    "# The thesis, reproduced\n"
    "Every table and plot here is computed by `erard-validate` from the built engine. \"Thesis\" is A. Thorin, "
    "*Non-smooth\n"
    "model of the grand piano action* (2013); numbers in brackets are its equations. Regenerate with\n\n"
    "    build/release/bin/erard-validate --out docs\n";

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Computes the studies of the thesis with this engine and writes validation.md with its pictures.",
               "erard-validate"};
  app.set_version_flag("--version", std::string(kVersion));
  std::string out = "docs";
  std::vector<std::string> only;
  app.add_option("--out", out, "folder for validation.md and images/validation/")->capture_default_str();
  app.add_option("--only", only, "print these sections on the terminal and write only their pictures")->delimiter(',');
  app.footer("Exit codes: 0 done, 1 failed, 2 wrong arguments. Needs gnuplot.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  const Pictures pictures{std::filesystem::path(out) / "images" / "validation", "images/validation"};
  std::filesystem::create_directories(pictures.folder);
  std::string document = kPreamble;
  for (const Study& study : kStudies) {
    if (!only.empty() && std::find(only.begin(), only.end(), study.name) == only.end()) continue;
    fmt::print(stderr, "{} ...\n", study.name);
    const Section section = study.write(pictures);
    document += fmt::format("\n## {}\n{}", section.title, section.text);
  }
  if (!only.empty()) {
    fmt::print("{}", document);
    return 0;
  }
  OutputFile file(std::filesystem::path(out) / "validation.md");
  file.write(document);
  file.commit();
  return 0;
} catch (const InputError& error) {
  fmt::print(stderr, "erard-validate: {}\n", error.what());
  return 2;
} catch (const std::exception& error) {
  fmt::print(stderr, "erard-validate: {}\n", error.what());
  return 1;
}
