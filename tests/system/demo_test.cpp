// The demo: its figures are those of `evaluate`, and its page holds all of it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "decoded_video.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

std::size_t count_of(const std::string& words, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
  return count;
}

TEST(Demo, TellsWhatEvaluateTellsAndShowsItOnOnePage) {
  const fs::path folder = temporary_folder() / "demo";
  const json summary = run_for_json({"demo", "--frames", "16", "--output", folder});
  ASSERT_EQ(summary["rows"].size(), 9U);
  for (const json& row : summary["rows"]) {
    ASSERT_EQ(row.size(), summary["header"].size());
    const std::string scene = row[0], method = row[1];
    const json score =
        run_for_json({"evaluate", "--truth", folder / scene, "--mode", scene == "room" ? "ego" : "joint",
                      "--estimate", folder / fmt::format("{}_{}.tum", scene, method), "--frames-csv",
                      folder / fmt::format("{}_{}_frames.csv", scene, method)});
    EXPECT_EQ(row[3], fmt::format("{:.0f} %", 100.0 * score["success_5px"].get<double>())) << row;
  }

  const std::string page = read_text(summary["report"].get<std::string>());
  EXPECT_EQ(count_of("data:video/mp4;base64,", page), 3U);
  EXPECT_EQ(count_of("data:image/png;base64,", page), 9U);
  EXPECT_EQ(count_of("<table", page), 1U);
  EXPECT_EQ(count_of("src=\"http", page), 0U) << "the page needs a network";
  EXPECT_EQ(decode_video(folder / "room_blur.mp4").frames.size(), 16U);
  EXPECT_EQ(decode_video(folder / "bundle_blur.mp4").frames.size(), 8U);
}

}  // namespace
}  // namespace apriltrack::test
