// The report: what is in the file, and what must not be. How it behaves in a browser: report_browser_test.py.
#include "erard/device/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "erard/mechanics/rest.hpp"
#include "support/program.hpp"

namespace erard {
namespace {

using namespace test;

constexpr const char* kPiano = "erard-sim --keystroke " ERARD_CONFIG_DIR "/keystrokes/piano.csv ";

int count_of(const std::string& text, const std::string& word) {
  int count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

ActionFile grand_action() { return load_action(ERARD_CONFIG_DIR "/grand_action.yaml"); }

Snapshot rest_snapshot(const ActionFile& action) {
  const Mechanism mechanism = build_mechanism(action.model);
  return take_snapshot(mechanism, rest_state(mechanism, 1e-4), {}, 0);
}

void save_report(const std::filesystem::path& path, const Report& report) {
  OutputFile file(path);
  write_report(file, report);
  file.commit();
}

TEST(Report, IsOneFileThatAsksForNothingAndIsSmallEnough) {
  const TemporaryFolder folder;
  const std::string out = (folder / "run").string();
  ASSERT_EQ(run_program(kPiano + ("--duration 1 --out " + out)).exit_code, 0);
  const std::string page = read_text(out + "/report.html");
  EXPECT_LT(page.size(), 3'000'000u);  // for one second at 2 kHz
  EXPECT_GT(page.size(), 300'000u);
  for (const char* outside : {"<script src", "<link", "<img", "<iframe", "@import", "fetch(", "XMLHttpRequest"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  for (const char* place : {"{{run}}", "{{other}}", "{{report.css}}", "{{main.js}}"})
    EXPECT_EQ(page.find(place), std::string::npos) << place;
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(count_of(page, "<script"), count_of(page, "</script>"));
}

TEST(Report, TwoRunsGiveTheSamePage) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"})
    ASSERT_EQ(run_program(kPiano + ("--out " + (folder / name).string())).exit_code, 0);
  EXPECT_EQ(read_text((folder / "a").string() + "/report.html"), read_text((folder / "b").string() + "/report.html"));
}

TEST(Report, TextsFromFilesCannotLeaveTheirPlace) {
  const TemporaryFolder folder;
  const std::string evil = "</script><b>\"&";
  ActionFile action = grand_action();
  action.model.name = "</script><b>";
  Drawing drawing;
  drawing.bodies["K"].label = evil;
  const Scene scene = build_scene(action, drawing);
  ReportRows rows(action.model, 0, 5e-4);
  rows.add(rest_snapshot(action));
  RunSummary summary;
  summary.action = "folder/" + evil;
  const OtherRun other{evil, {{0, 1}, {0, 0}}, ""};
  Report report{&summary, &scene, &rows, {}, &other};
  report.measures.push_back({evil, evil, {}, NAN, NAN, evil, evil});
  save_report(folder / "report.html", report);
  const std::string page = read_text((folder / "report.html").string());
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  const std::string svg = draw_svg(scene, rows.snapshot(0), DriveKind::piston, evil);
  EXPECT_EQ(svg.find("</script><b>"), std::string::npos);
}

TEST(Report, AStoppedRunSaysSo) {
  const TemporaryFolder folder;
  const ActionFile action = grand_action();
  const Scene scene = build_scene(action, {});
  ReportRows rows(action.model, 0, 5e-4);
  rows.add(rest_snapshot(action));
  const auto page_of = [&](const RunResult& result) {
    RunSummary summary;
    summary.result = result;
    save_report(folder / "report.html", Report{&summary, &scene, &rows, {}, nullptr});
    return read_text((folder / "report.html").string());
  };
  RunResult result;
  result.steps = 10;
  EXPECT_NE(page_of(result).find("every step converged"), std::string::npos);
  result.not_converged = 3;
  EXPECT_NE(page_of(result).find("3 of 10 steps"), std::string::npos);
  result.is_complete = false;
  EXPECT_NE(page_of(result).find("INTERRUPTED"), std::string::npos);
  result.is_finite = false;
  EXPECT_NE(page_of(result).find("FAILED"), std::string::npos);
}

TEST(Report, TakesTheOtherRunWholeAndOnlyIfItIsOurs) {
  const TemporaryFolder folder;
  const std::string out = (folder / "run").string();
  ASSERT_EQ(run_program(kPiano + ("--out " + out)).exit_code, 0);
  EXPECT_FALSE(read_other_run(out).run_json.empty());
  EXPECT_EQ(read_other_run(out).force.time.size(), 1200u);
  EXPECT_TRUE(read_other_run(out + "/trajectory.csv").run_json.empty());
  write_text(out + "/report.html", "<script type=\"application/json\" id=\"run\">{\"a\":\"<img>\"}</script>");
  EXPECT_TRUE(read_other_run(out).run_json.empty());
}

TEST(ReportRows, KeepTheirNumbersAndThinLongRuns) {
  const ActionFile action = grand_action();
  Snapshot row = rest_snapshot(action);
  ReportRows rows(action.model, 0.25, 1e-3);
  const std::size_t seen = 3 * ReportRows::kMost;
  for (std::size_t i = 0; i < seen; ++i) {
    row.force = static_cast<double>(i);
    rows.add(row);
  }
  EXPECT_LE(rows.count(), ReportRows::kMost);
  EXPECT_EQ(rows.stride(), 4u);
  for (std::size_t i = 0; i < rows.count(); i += 997) {
    EXPECT_EQ(rows.snapshot(i).force, static_cast<double>(i * rows.stride()));
    EXPECT_NEAR(rows.time(i), 0.25 + 1e-3 * static_cast<double>(i * rows.stride()), 1e-12);
  }
  EXPECT_EQ(rows.columns().size(), 3 + 3 * 6 + 3 * 14u);
  EXPECT_EQ(rows.by_column().size(), rows.count() * rows.columns().size());
  EXPECT_EQ(rows.by_column()[2 * rows.count() + 1], 4.0F);  // third column: force, second row
  EXPECT_EQ(rows.row_at(-1), 0u);
  EXPECT_EQ(rows.row_at(1e9), rows.count() - 1);
}

TEST(Drawing, OfTheGrandActionNamesOnlyWhatIsThere) {
  const ActionFile action = grand_action();
  const Drawing drawing = load_drawing(ERARD_CONFIG_DIR "/grand_action.yaml");
  for (const auto& [name, body] : drawing.bodies) EXPECT_GE(find_body(action.model, name), 0) << name;
  for (const auto& [name, felt] : drawing.felts) EXPECT_GE(find_contact(action.model, name), 0) << name;
  for (const auto& [name, body] : drawing.bodies)
    for (const DrawnPart& part : body.parts)
      EXPECT_TRUE(part.on.empty() || find_contact(action.model, part.on) >= 0) << part.name;
  EXPECT_EQ(drawing.bodies.at("L").label, "repetition lever");
  EXPECT_EQ(drawing.contact_labels.at("JH"), "jack top under the knuckle");
}

TEST(Drawing, AWrongHintIsToldInOneSentence) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "drawings");
  const std::pair<const char*, const char*> cases[] = {
      {"colour: red\n", "unknown key"},
      {"view_mm: [0, 0, 1]\n", "four numbers"},
      {"view_mm: [0, 0, -1, 1]\n", "left < right"},
      {"ground:\n  parts:\n    - {path_mm: \"M 0 0 <script>\"}\n", "SVG path"},
      {"ground:\n  parts:\n    - {name: x}\n", "path_mm"},
      {"ground: {label_at_mm: [0, .nan]}\n", "finite"},
      {"ground: [\n", "drawings"},
  };
  for (const auto& [text, rule] : cases) {
    write_text((folder / "drawings" / "a.yaml").string(), text);
    try {
      load_drawing(folder / "a.yaml");
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(rule), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("a.yaml:"), std::string::npos) << error.what();
    }
  }
}

TEST(Drawing, WithoutHintsEverythingIsDrawnFromThePrimitives) {
  const TemporaryFolder folder;
  const ActionFile action = grand_action();
  const Scene scene = build_scene(action, load_drawing(folder / "none.yaml"));
  for (int i = 0; i < action.model.body_count; ++i) {
    const auto is_of = [i](const ScenePart& part) { return part.body == i; };
    EXPECT_EQ(std::any_of(scene.parts.begin(), scene.parts.end(), is_of), !scene.is_hidden[static_cast<std::size_t>(i)])
        << i;
  }
  const std::string svg = draw_svg(scene, rest_snapshot(action), DriveKind::piston, "");
  EXPECT_EQ(count_of(svg, "nan"), 0);
  EXPECT_GT(count_of(svg, "class=\"primitive\""), 10);
}

TEST(Svg, TellsOpenFromClosedAndSticksFromSlides) {
  const ActionFile action = grand_action();
  const Scene scene = build_scene(action, load_drawing(ERARD_CONFIG_DIR "/grand_action.yaml"));
  Snapshot pose = rest_snapshot(action);
  const int checks = find_contact(action.model, "KH");
  const std::string at_rest = draw_svg(scene, pose, DriveKind::piston, "");
  // key on the back rail, whippen on the capstan, jack on its screw, lever on its button, knuckle on the lever
  EXPECT_EQ(count_of(at_rest, "class=\"mark-closed\""), 5);
  EXPECT_EQ(count_of(at_rest, "class=\"mark-open\""), 7);
  EXPECT_EQ(count_of(at_rest, "class=\"pressed\""), 5);
  pose.normal[static_cast<std::size_t>(checks)] = 1;
  pose.tangential[static_cast<std::size_t>(checks)] = 0.1;
  EXPECT_EQ(count_of(draw_svg(scene, pose, DriveKind::piston, ""), "class=\"mark-stick\""), 1);
  pose.tangential[static_cast<std::size_t>(checks)] = action.model.contacts[checks].friction;
  EXPECT_EQ(count_of(draw_svg(scene, pose, DriveKind::piston, ""), "class=\"mark-slide\""), 1);
  EXPECT_EQ(at_rest.find("var("), std::string::npos);  // plain colours, for programs that know no variables
}

TEST(Svg, ATurnedScrewMovesItsButton) {
  ActionOptions options;
  options.settings = {{"S_Jy", 0.0588}};
  const Drawing drawing = load_drawing(ERARD_CONFIG_DIR "/grand_action.yaml");
  const auto height = [&](const ActionFile& action) {
    for (const ScenePart& part : build_scene(action, drawing).parts)
      if (part.part.name == "let-off button") return part.part.at.y();
    return 0.0;
  };
  EXPECT_NEAR(height(load_action(ERARD_CONFIG_DIR "/grand_action.yaml", options)), 58.8, 1e-9);
  EXPECT_NEAR(height(grand_action()), 59.3246638, 1e-6);
}

TEST(Svg, IsWrittenForTimesAndEventsAndRefusedForOthers) {
  const TemporaryFolder folder;
  const std::string out = (folder / "run").string();
  ASSERT_EQ(run_program(kPiano + ("--svg 0.05,jack_meets_let_off --out " + out)).exit_code, 0);
  EXPECT_NE(read_text(out + "/pose_jack_meets_let_off.svg").find("</svg>"), std::string::npos);
  EXPECT_NE(read_text(out + "/pose_0.05.svg").find("50.00 ms"), std::string::npos);
  const auto wrong = run_program(kPiano + ("--svg breakfast --out " + out));
  EXPECT_EQ(wrong.exit_code, 2);
  expect_one_sentence(wrong, {"--svg", "breakfast"});
  EXPECT_EQ(run_program(kPiano + std::string("--svg 0")).exit_code, 2);
}

const Measure& find_measure(const std::vector<Measure>& measures, const std::string& name) {
  for (const Measure& m : measures)
    if (m.name == name && m.values.size() == 1) return m;
  throw std::runtime_error("not measured: " + name);
}

TEST(Regulation, MeasuresWhatTheReferenceMeasured) {
  const std::vector<Measure> measures = measure_action(grand_action());
  const auto value = [&](const char* name) { return find_measure(measures, name).values[0]; };
  // of the independent simulation; touch weights were given with two digits
  EXPECT_NEAR(value("touch weight down"), 0.54, 0.01);
  EXPECT_NEAR(value("touch weight up"), 0.34, 0.01);
  EXPECT_NEAR(value("blow distance"), 46.0, 0.1);
  EXPECT_NEAR(value("let-off"), 1.9, 0.1);
  EXPECT_NEAR(value("jack below the knuckle"), 0.122, 0.005);
  EXPECT_NEAR(value("key dip"), 9.75, 0.05);
}

TEST(Regulation, IsSilentAboutAMechanismThatIsNoAction) {
  ActionFile action;
  EXPECT_TRUE(measure_action(action).empty());
  ReportRows rows(action.model, 0, 1e-3);
  EXPECT_TRUE(measure_stroke(action, rows, {}).empty());
}

}  // namespace
}  // namespace erard
