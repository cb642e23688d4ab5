#include "apriltrack/tags/tag_sizes.h"

#include <gtest/gtest.h>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

std::filesystem::path file_with(const std::string& text) {
  const auto path = test::temporary_folder() / "tag_sizes.yaml";
  write_file_atomically(path, text);
  return path;
}

TEST(TagSizes, TheMostExactNameWins) {
  const TagSizes sizes = read_tag_sizes(
      file_with("default: 0.12\nsizes:\n  7: 0.2\n  tag25h9/7: 0.3\n  tag36h11/8: 0.4\n"), 0.5);
  EXPECT_EQ(sizes.find({"tag36h11", 0}), 0.12) << "the file's default wins over the caller's";
  EXPECT_EQ(sizes.find({"tag36h11", 7}), 0.2);
  EXPECT_EQ(sizes.find({"tag25h9", 7}), 0.3);
  EXPECT_EQ(sizes.find({"tag36h11", 8}), 0.4);
  EXPECT_EQ(sizes.find({"tag25h9", 8}), 0.12);
}

TEST(TagSizes, FallsBackOnTheCallersSizeOrNone) {
  const auto path = file_with("sizes: {7: 0.2}\n");
  EXPECT_EQ(read_tag_sizes(path, 0.5).find({"tag36h11", 1}), 0.5);
  EXPECT_EQ(read_tag_sizes(path, std::nullopt).find({"tag36h11", 1}), std::nullopt);
  EXPECT_EQ(read_tag_sizes(path, std::nullopt).find({"tag36h11", 7}), 0.2);
  EXPECT_EQ(TagSizes().find({"tag36h11", 7}), std::nullopt);
}

TEST(TagSizes, NamesLineAndKeyOfEveryMistake) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"default: 0\n", {"tag_sizes.yaml:1: default", "> 0"}},
      {"default: -0.1\n", {"tag_sizes.yaml:1: default", "> 0", "-0.1"}},
      {"default: .inf\n", {"tag_sizes.yaml:1: default", "finite"}},
      {"default: big\n", {"tag_sizes.yaml:1: default", "big"}},
      {"defualt: 1\n", {"tag_sizes.yaml:1", "defualt", "unknown key"}},
      {"x_mine: 1\n", {"gives no size"}},
      {"default: 1\nsizes: 3\n", {"tag_sizes.yaml:2: sizes"}},
      {"sizes:\n  7: 0.1\n  7: 0.2\n", {"tag_sizes.yaml:3", "7"}},
      {"sizes:\n  7: 0.1\n  07: 0.2\n", {"tag_sizes.yaml:3", "07"}},
      {"sizes:\n  -7: 0.1\n", {"tag_sizes.yaml:2", "-7"}},
      {"sizes:\n  seven: 0.1\n", {"tag_sizes.yaml:2", "seven", "tag36h11/7"}},
      {"sizes:\n  7: -0.1\n", {"tag_sizes.yaml:2", "sizes", "> 0"}},
      {"sizes:\n  tag36h12/7: 0.1\n", {"tag_sizes.yaml:2", "tag36h12", "tag25h9"}},
      {"sizes:\n  tag25h9/35: 0.1\n", {"tag_sizes.yaml:2", "0 to 34", "35"}},
      {"sizes:\n  tag25h9/3/4: 0.1\n", {"tag_sizes.yaml:2", "tag25h9/3/4"}},
  };
  for (const auto& [text, fragments] : cases) {
    std::string message = "no complaint";
    try {
      read_tag_sizes(file_with(text), 0.5);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      message = error.what();
    }
    for (const std::string& fragment : fragments) {
      EXPECT_NE(message.find(fragment), std::string::npos)
          << "no '" << fragment << "' in: " << message << "\nfor\n"
          << text;
    }
  }
}

TEST(TagSizes, ReadsEveryRecordedFile) {
  APRILTRACK_SHARED_OR_SKIP(data, "data");
  int read = 0;
  for (const auto& folder : std::filesystem::directory_iterator(data)) {
    const auto path = folder.path() / "tag_sizes.yaml";
    if (!std::filesystem::exists(path)) continue;
    EXPECT_TRUE(read_tag_sizes(path, std::nullopt).find({"tag36h11", 1}).has_value());
    ++read;
  }
  EXPECT_GE(read, 5);
  APRILTRACK_SHARED_OR_SKIP(stereo, "data/tagslam_02_stereo/tag_sizes.yaml");
  EXPECT_EQ(read_tag_sizes(stereo, 0.5).find({"tag36h11", 306}), 0.16);
}

}  // namespace
}  // namespace apriltrack
