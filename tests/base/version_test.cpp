#include "apriltrack/base/version.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "support/shared_data.h"

namespace apriltrack {
namespace {
using ::testing::HasSubstr;

std::string source_text(const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(test::source_path(name)).rdbuf();
  return text.str();
}

/// Recipes of formats that cannot read the header.
TEST(Version, IsThatOfTheRecipesThatRepeatIt) {
  const std::string version = apriltrack::version();
  EXPECT_THAT(source_text("packaging/vcpkg/apriltrack/vcpkg.json"),
              HasSubstr("\"version\": \"" + version + "\""));
  EXPECT_THAT(source_text("packaging/conda/meta.yaml"), HasSubstr("\n  version: " + version + "\n"));
  EXPECT_THAT(source_text("CHANGELOG.md"), HasSubstr("\n## " + version));
}

}  // namespace
}  // namespace apriltrack
