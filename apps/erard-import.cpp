// erard-import: a recorded key position becomes a keystroke.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "erard/device/error.hpp"
#include "erard/device/keystroke.hpp"
#include "erard/device/recording.hpp"
#include "program.hpp"

namespace {

namespace fs = std::filesystem;

constexpr const char* kPurpose =
    "Turns the recorded position of a key (CSV: t_s, key_front_mm, hammer_sensor_mm) into a keystroke (CSV: t_s,\n"
    "position_m) to be played as the piston position Y of the drive `piston`.";

constexpr const char* kMethod = R"(Method (docs/recordings.md has the figures):
  scale    the reading at which the sensor clips becomes the dip of the model
  rest     where a movement does not exceed --rest, the key rests and the position is exactly 0; a reading below --rest
           says no more than "between 0 and --rest"
  clip     a clipped reading says "here or beyond": the curve stays at the dip or deeper, by about --press
  smooth   least squares with a penalty on third differences; each reading counts by the noise of the sensor at that
           height, and the penalty follows the speed: --slow-cutoff where the key is slow, --fast-cutoff where it is
           fast. Cutoffs are where a wave, read with the noise of rest, keeps half its amplitude.
Times stay those of the recording.

Exit codes: 0 done, 1 failure (nothing written), 2 file or option that cannot be used.
Example: erard-import config/recordings/s4_fast_strike_A.csv --out fast.csv)";

struct Request {
  fs::path input;
  fs::path output;
  fs::path credit;
  double full_scale_mm = 0;
  double rest_mm = 0;
  double press_mm = 0;
  erard::ImportSettings settings;
};

void add_options(CLI::App& app, Request& request) {
  erard::ImportSettings& settings = request.settings;
  request.full_scale_mm = settings.full_scale * 1e3;
  request.rest_mm = settings.rest * 1e3;
  request.press_mm = settings.press * 1e3;

  app.add_option("INPUT", request.input, "Recording, CSV with t_s [s] and key_front_mm [mm]")
      ->required()
      ->type_name("FILE");
  app.add_option("--out", request.output, "Keystroke to write, CSV with t_s [s] and position_m [m]")
      ->required()
      ->type_name("FILE");
  app.add_option("--credit", request.credit, "Text file whose lines are put on top of the keystroke: source, licence")
      ->type_name("FILE");
  app.add_option("--dip", settings.dip, "What full scale becomes in the model [m]")->capture_default_str();
  app.add_option("--full-scale", request.full_scale_mm, "Reading at which the sensor clips [mm]")
      ->capture_default_str();
  app.add_option("--rest", request.rest_mm, "A movement exceeds this reading [mm]")->capture_default_str();
  app.add_option("--slow-cutoff", settings.slow_cutoff, "Smoothing where the key is slow [Hz]")->capture_default_str();
  app.add_option("--fast-cutoff", settings.fast_cutoff, "Smoothing where it is fast [Hz]")->capture_default_str();
  app.add_option("--fast-speed", settings.fast_speed, "What counts as fast, in the recording's scale [m/s]")
      ->capture_default_str();
  app.add_option("--press", request.press_mm, "How far a finger is expected to press beyond full scale [mm]")
      ->capture_default_str();
}

// One line of shell that does the same again.
std::string quote_command(int argc, char** argv) {
  std::string command = "erard-import";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool is_plain = !word.empty() && word.find_first_of(" \t\n\"'\\$`&|;<>()*?[]#~!{}") == std::string::npos;
    std::string quoted;
    for (char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    command += is_plain ? " " + word : " '" + quoted + "'";
  }
  return command;
}

std::vector<std::string> read_credit(const fs::path& file) {
  constexpr std::size_t kMostLines = 50;
  std::vector<std::string> lines;
  if (file.empty()) return lines;
  std::ifstream stream(file);
  std::error_code ignored;
  if (!stream || fs::is_directory(file, ignored))
    throw erard::InputError(fmt::format("{}: cannot be read, must be a text file", file.string()));
  for (std::string line; std::getline(stream, line); lines.push_back(line))
    if (lines.size() >= kMostLines || line.size() > 500)
      throw erard::InputError(
          fmt::format("{}:{}: the text is too long for comments, must have at most {} lines of 500 "
                      "characters",
                      file.string(), lines.size() + 1, kMostLines));
  return lines;
}

void run(Request& request, const std::string& command) {
  request.settings.full_scale = request.full_scale_mm / 1e3;
  request.settings.rest = request.rest_mm / 1e3;
  request.settings.press = request.press_mm / 1e3;
  std::error_code ignored;  // a file that is not there is nobody's twin
  if (fs::equivalent(request.input, request.output, ignored))
    throw erard::InputError(fmt::format("--out = {}, must not be the recording itself", request.output.string()));

  std::vector<std::string> comments = read_credit(request.credit);
  const erard::Recording recording = erard::read_recording(request.input);
  const erard::Import result = erard::import_recording(recording, request.settings, request.input);
  const std::vector<std::string> description = erard::describe_import(request.settings, result.figures, command);
  comments.insert(comments.end(), description.begin(), description.end());
  erard::write_keystroke(request.output, result.keystroke, comments);

  fmt::print("{}\n", request.output.string());
  for (std::size_t i = 1; i < description.size(); ++i) fmt::print("  {}\n", description[i]);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kPurpose, "erard-import");
  app.footer(kMethod);
  Request request;
  add_options(app, request);
  return erard::run_program(app, argc, argv, [&] {
    run(request, quote_command(argc, argv));
    return erard::kDone;
  });
}
