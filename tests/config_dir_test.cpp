// config_dir(): the environment first, and a wrong environment is refused rather than passed over.
#include "erard/device/config_dir.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "erard/device/error.hpp"

namespace erard {
namespace {

namespace fs = std::filesystem;

TEST(ConfigDir, IsTheSourceTreesForProgramsOfTheBuildTree) {
  unsetenv("ERARD_CONFIG_DIR");
  EXPECT_TRUE(fs::equivalent(config_dir(), ERARD_CONFIG_DIR)) << config_dir();
}

TEST(ConfigDir, EmptyVariableCountsAsUnset) {
  setenv("ERARD_CONFIG_DIR", "", 1);
  EXPECT_TRUE(fs::equivalent(config_dir(), ERARD_CONFIG_DIR)) << config_dir();
}

TEST(ConfigDir, FollowsTheEnvironment) {
  const fs::path chosen = fs::temp_directory_path();
  setenv("ERARD_CONFIG_DIR", chosen.c_str(), 1);
  EXPECT_EQ(config_dir(), chosen);
}

TEST(ConfigDir, RefusesAVariableThatNamesNoFolder) {
  setenv("ERARD_CONFIG_DIR", "/no/such/folder", 1);
  try {
    config_dir();
    FAIL() << "accepted a folder that does not exist";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/folder"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace erard
