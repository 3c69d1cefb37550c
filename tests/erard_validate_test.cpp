// erard-validate as its users meet it.
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/program.hpp"

namespace erard {
namespace {

using namespace test;

bool is_empty(const TemporaryFolder& folder) {
  for (const auto& entry : test::fs::recursive_directory_iterator(folder.path()))
    if (entry.is_regular_file()) return false;
  return true;
}

TEST(ErardValidate, NamesItsSections) {
  const auto outcome = run_program("erard-validate --help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* name : {"pendulum", "simple_models", "thesis_tables", "strokes", "without_felts", "recordings",
                           "causal_input", "published_figures"})
    EXPECT_NE(outcome.out.find(name), std::string::npos) << name;
}

TEST(ErardValidate, RefusesASectionThatThereIsNot) {
  const TemporaryFolder folder;
  const auto outcome = run_program("erard-validate --only pendulum,pendulums --out " + folder.path().string());
  expect_one_sentence(outcome, {"--only pendulums", "no such section", "published_figures"});
  EXPECT_TRUE(outcome.out.empty());
  EXPECT_TRUE(is_empty(folder));
}

TEST(ErardValidate, RefusesAFolderThatIsNone) {
  const TemporaryFolder folder;
  write_text(folder / "taken", "");
  expect_one_sentence(run_program("erard-validate --only pendulum --out " + (folder / "taken").string()),
                      {"taken", "folder"});
}

TEST(ErardValidate, OnlyPrintsTheSectionsAskedForAndKeepsOtherPictures) {
  const TemporaryFolder folder;
  test::fs::create_directories(folder / "images/validation");
  write_text(folder / "images/validation/other.svg", "other");
  const auto outcome = run_program("erard-validate --only without_felts,pendulum --out " + folder.path().string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const std::size_t pendulum = outcome.out.find("## <a id=\"pendulum\"></a>A pendulum with dry friction");
  const std::size_t felts = outcome.out.find("## <a id=\"without_felts\"></a>Without felts");
  EXPECT_LT(pendulum, felts);  // in the order of the document
  EXPECT_NE(felts, std::string::npos);
  EXPECT_EQ(outcome.out.find("<a id=\"strokes\">"), std::string::npos);
  EXPECT_NE(outcome.error.find("1 of 2: pendulum"), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("2 of 2: without_felts"), std::string::npos) << outcome.error;
  for (const char* picture : {"pendulum.svg", "without_felts.svg"})
    EXPECT_NE(read_text(folder / ("images/validation/" + std::string(picture))).find("</svg>"), std::string::npos);
  EXPECT_EQ(read_text(folder / "images/validation/other.svg"), "other");
  EXPECT_FALSE(test::fs::exists(folder / "validation.md"));
  for (const auto& entry : test::fs::directory_iterator(folder / "images"))
    EXPECT_EQ(entry.path().filename(), "validation");  // nothing unfinished beside it
}

TEST(ErardValidate, WithoutGnuplotSaysSoAndLeavesNothing) {
  const TemporaryFolder folder;
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder.path().c_str(), 1);
  const auto outcome = run_program("erard-validate --out " + folder.path().string());
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.error.find("gnuplot"), std::string::npos) << outcome.error;
  EXPECT_TRUE(is_empty(folder));
}

TEST(ErardValidate, EndedBySignalLeavesWhatWasThere) {
  const TemporaryFolder folder;
  const std::string out = folder.path().string();
  test::fs::create_directories(folder / "images/validation");
  write_text(folder / "validation.md", "old");
  write_text(folder / "images/validation/pendulum.svg", "old");
  // as soon as it draws, that is in the middle of its first section
  const auto outcome =
      run_program("erard-validate --out " + out + " & program=$!; until ls " + out +
                  "/images/validation.part-*/*.svg >/dev/null 2>&1; do kill -0 $program || break; sleep 0.1; done; "
                  "kill -TERM $program; wait $program");
  EXPECT_EQ(outcome.exit_code, 128 + 15) << outcome.error;
  EXPECT_EQ(read_text(folder / "validation.md"), "old");
  EXPECT_EQ(read_text(folder / "images/validation/pendulum.svg"), "old");
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : test::fs::directory_iterator(folder / "images")) ++entries;
  EXPECT_EQ(entries, 1);
}

}  // namespace
}  // namespace erard
