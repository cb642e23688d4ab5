// The library's reference, by Doxygen, to which a warning is an error.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "program.h"
#include "support/judges.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

TEST(Reference, IsMadeWithoutAWarning) {
  APRILTRACK_NEED_JUDGE(program_judge("doxygen", "doxygen"));
  const fs::path folder = temporary_folder();
  const std::string command =
      source_path("scripts/reference").string() + " " + folder.string() + " 2>" + (folder / "words").string();
  EXPECT_EQ(std::system(command.c_str()), 0) << read_text((folder / "words").string());
  EXPECT_TRUE(fs::exists(folder / "html/index.html"));
}

}  // namespace
}  // namespace apriltrack::test
