// What `simulate` writes of light and darkness, held against closed forms and counts of pixels.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "apriltrack/source/frame_source.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

std::vector<SourceFrame> filmed_frames(std::vector<std::string> options, const fs::path& folder) {
  std::vector<std::string> words = {"simulate", "--scene", "single", "--output", folder};
  words.insert(words.end(), options.begin(), options.end());
  run_for_json(words);
  std::vector<SourceFrame> frames;
  const auto source = open_source(folder);
  while (auto frame = source->next()) frames.push_back(std::move(*frame));
  return frames;
}

double mean_code(const GrayImage& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) sum += image(x, y);
  }
  return sum / image.width() / image.height();
}

TEST(SimulatedFlicker, GainInFramesCsvIsTheMeanOfTheLampOverTheExposure) {
  constexpr double kDepth = 0.5, kExposure_s = 0.004;
  constexpr double kMaxError = 4e-3;  // the mean of so few instants of a sine, in two frames
  const auto frames =
      filmed_frames({"--frames", "7", "--rate", "70", "--flicker", "0.5", "--exposure", "0.004"},
                    temporary_folder() / "flicker");
  ASSERT_EQ(frames.size(), 7U);
  const auto light = [](const SourceFrame& frame) {  // integral of 1 + depth sin(w t) over the exposure
    const double w = 200.0 * std::numbers::pi;
    const double t = 1e-9 * static_cast<double>(frame.timestamp.ns);
    const double begin = t - 0.5 * kExposure_s, end = t + 0.5 * kExposure_s;
    return 1.0 + kDepth * (std::cos(w * begin) - std::cos(w * end)) / (w * kExposure_s);
  };
  double least = 1.0, most = 1.0;
  for (const SourceFrame& frame : frames) {
    EXPECT_NEAR(frame.gain, light(frame) / light(frames[0]), kMaxError) << frame.name;
    EXPECT_EQ(frame.exposure_s, kExposure_s);
    least = std::min(least, frame.gain);
    most = std::max(most, frame.gain);
  }
  EXPECT_EQ(frames[0].gain, 1.0);
  EXPECT_GT(most - least, 0.3);
}

TEST(SimulatedBlackout, BlackensItsFramesAndIsNotInFramesCsv) {
  const fs::path folder = temporary_folder() / "blackout";
  const auto frames = filmed_frames({"--frames", "8", "--blackout", "2:2", "--blackout", "7:9"}, folder);
  ASSERT_EQ(frames.size(), 8U);
  int num_black = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool is_black = mean_code(frames[i].pixels) < 5.0;  // sRGB lifts read noise to some codes
    num_black += is_black ? 1 : 0;
    EXPECT_EQ(is_black, i == 2 || i == 3 || i == 7) << i;
    EXPECT_EQ(frames[i].gain, 1.0);
  }
  EXPECT_EQ(num_black, 3);
  EXPECT_FALSE(fs::exists(folder / "frames.csv"));
}

TEST(SimulateOptions, SayWhatIsWrongWithAStress) {
  const auto refused = [](const char* option, const char* value) {
    const ProgramRun run = run_program(
        {"simulate", "--scene", "single", option, value, "--output", temporary_folder() / "none"});
    EXPECT_EQ(run.status, 2) << option << ' ' << value;
    EXPECT_NE(run.err.find(option), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(value), std::string::npos) << run.err;
  };
  for (const char* value : {"90", "90:0", "x:4", "99999999:1", "240:1"}) refused("--blackout", value);
  refused("--light", "0.001");
  refused("--gain", "-1");
  refused("--occlude", "1.5");
}

TEST(SimulateOptions, TellTheirLimitsInTheHelp) {
  const std::string help = run_program({"simulate", "--help"}).out;
  const auto help_of = [&](const std::string& option) {
    const std::size_t start = help.find("\n  " + option + " ", help.find("Options:"));  // behind the examples
    return start == std::string::npos ? "" : help.substr(start, help.find("\n  -", start + 1) - start);
  };
  const std::pair<const char*, const char*> limits[] = {
      {"--frames", "1 to 1000000"}, {"--rate", "0.01 to 10000"}, {"--exposure", "from 1e-07"},
      {"--speed", "0 to 100"},      {"--noise", "0 to 100"},     {"--flicker", "0 to 0.9"},
      {"--light", "0.002 to 10"},   {"--gain", "0.01 to 1000"},  {"--occlude", "0 to 1"}};
  for (const auto& [option, limit] : limits)
    EXPECT_NE(help_of(option).find(limit), std::string::npos) << option << ": " << help_of(option);
}

TEST(SimulateOptions, RefuseWhatIsBeyondTheirLimits) {
  const auto output_of = [](const char* option, const char* value) {
    return run_program(
               {"simulate", "--scene", "single", option, value, "--output", temporary_folder() / "none"})
        .err;
  };
  EXPECT_NE(output_of("--flicker", "0.91").find("--flicker: must be in [0, 0.9] (is '0.91')"),
            std::string::npos);
  EXPECT_NE(output_of("--rate", "nan").find("--rate: must be in [0.01, 10000] (is 'nan')"),
            std::string::npos);
  EXPECT_NE(output_of("--frames", "0").find("--frames: must be a whole number from 1 to 1000000 (is '0')"),
            std::string::npos);
}

}  // namespace
}  // namespace apriltrack::test
