// erard-validate: the thesis's study again, from the built engine: writes docs/validation.md with its tables and plots.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "erard/device/error.hpp"
#include "erard/device/output_file.hpp"
#include "program.hpp"
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
namespace fs = std::filesystem;

struct Study {
  const char* name;  // of its anchor and for --only
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
constexpr const char* kPictureFolder = "images/validation";

/// Pictures on their way: beside their final folder, until all are drawn.
class PictureFolder {
 public:
  explicit PictureFolder(const fs::path& out)
      : final_(out / kPictureFolder), part_(fmt::format("{}.part-{}", final_.string(), getpid())) {
    prepare_output_folder(part_);
  }
  ~PictureFolder() {
    std::error_code ignored;
    fs::remove_all(part_, ignored);
  }
  PictureFolder(const PictureFolder&) = delete;
  PictureFolder& operator=(const PictureFolder&) = delete;

  const fs::path& path() const { return part_; }

  /// They take the place of all pictures that are there.
  void publish() const {
    const fs::path old = part_.string() + "-old";
    if (fs::exists(final_)) fs::rename(final_, old);
    fs::rename(part_, final_);
    fs::remove_all(old);
  }

  /// Each takes the place of the one of its name.
  void publish_each() const {
    fs::create_directories(final_);
    for (const auto& picture : fs::directory_iterator(part_))
      fs::rename(picture.path(), final_ / picture.path().filename());
  }

 private:
  fs::path final_, part_;
};

std::mutex ending;  // held by who ends the program: a signal, an error, or the publication, which is not interrupted

/// Ends the program on Ctrl-C and the like, at once and without leaving anything behind: a section takes up to a minute.
/// The signals are blocked everywhere but here, where they are waited for.
void end_on_signal(const fs::path& unfinished, const sigset_t& signals) {
  std::thread([unfinished, signals] {
    int signal = 0;
    sigwait(&signals, &signal);
    const std::lock_guard lock(ending);
    std::error_code ignored;
    while (fs::exists(unfinished, ignored)) fs::remove_all(unfinished, ignored);
    std::_Exit(128 + signal);
  }).detach();
}

sigset_t block_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

std::string names_of_all() {
  std::vector<std::string> names;
  for (const Study& study : kStudies) names.emplace_back(study.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Those asked for, in the order of the document. Throws InputError for a name that is none.
std::vector<Study> choose_studies(const std::vector<std::string>& only) {
  const auto has_name = [](const std::string& name) { return [&name](const Study& s) { return s.name == name; }; };
  for (const std::string& name : only)
    if (std::none_of(kStudies.begin(), kStudies.end(), has_name(name)))
      throw InputError(fmt::format("--only {}: no such section; there are {}", name, names_of_all()));
  std::vector<Study> chosen = kStudies;
  std::erase_if(chosen, [&](const Study& study) {
    return !only.empty() && std::find(only.begin(), only.end(), study.name) == only.end();
  });
  return chosen;
}

using Written = std::pair<Study, Section>;

std::vector<Written> write_sections(const std::vector<Study>& studies, const Pictures& pictures) {
  std::vector<Written> sections;
  for (const Study& study : studies) {
    fmt::print(stderr, "{} of {}: {} ...", sections.size() + 1, studies.size(), study.name);
    const auto start = std::chrono::steady_clock::now();
    sections.emplace_back(study, study.write(pictures));
    fmt::print(stderr, " {:.1f} s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return sections;
}

/// Table of contents with what came out, and all numbers of the thesis that are contradicted.
std::string summary(const std::vector<Written>& sections) {
  std::vector<std::vector<std::string>> contents, contradicted;
  for (const auto& [study, section] : sections) {
    contents.push_back({fmt::format("[{}](#{})", section.title, study.name), section.result});
    for (const study::Contradiction& c : section.contradictions)
      contradicted.push_back(
          {fmt::format("[{}](#{})", study.name, study.name), c.quantity, c.printed, c.computed, c.difference, c.why});
  }
  return "\n" + study::table({"section", "what came out"}, contents) +
         fmt::format(
             "\n## Printed numbers that do not come out\nAll {} numbers of the thesis that a computed value "
             "contradicts by more than {:.0f} %: recomputed from\nits own definitions and other numbers, or "
             "played on this action.\n\n",
             contradicted.size(), 100 * study::kContradiction) +
         study::table({"section", "quantity", "printed", "computed", "difference", "why"}, contradicted);
}

std::string text_of(const std::vector<Written>& sections) {
  std::string text;
  for (const auto& [study, section] : sections)
    text += fmt::format("\n## <a id=\"{}\"></a>{}\n{}", study.name, section.title, section.text);
  return text;
}

int run(const std::string& out, const std::vector<std::string>& only) {
  const std::vector<Study> studies = choose_studies(only);
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0)
    throw std::runtime_error("gnuplot, which draws the plots, is not installed");
  const sigset_t signals = block_signals();
  const PictureFolder pictures(out);
  end_on_signal(pictures.path(), signals);
  try {
    const std::vector<Written> sections = write_sections(studies, {pictures.path(), kPictureFolder});
    const std::lock_guard lock(ending);
    if (!only.empty()) {
      fmt::print("{}{}", kPreamble, text_of(sections));
      pictures.publish_each();
      return kDone;
    }
    OutputFile document(fs::path(out) / "validation.md");
    document.write(kPreamble + summary(sections) + text_of(sections));
    document.close();
    pictures.publish();
    document.publish();
    return kDone;
  } catch (const std::exception&) {
    const std::lock_guard lock(ending);  // what fails because a signal takes its folder away is no error
    throw;
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Computes the studies of the thesis with this engine and writes validation.md with its pictures.",
               "erard-validate"};
  std::string out = "docs";
  std::vector<std::string> only;
  app.add_option("--out", out, "folder for validation.md and images/validation/")->capture_default_str();
  app.add_option(
         "--only", only,
         "print these sections on the terminal and write only their pictures; names with commas of: " + names_of_all())
      ->delimiter(',');
  app.footer("Exit codes: 0 done, 1 failed, 2 wrong arguments, 128 + n ended by signal n. Needs gnuplot.");
  return run_program(app, argc, argv, [&] { return run(out, only); });
}
