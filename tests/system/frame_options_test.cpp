#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"
#include "support/shared_data.h"

// Which frames of a recording are used is said by the same words to every command.

namespace apriltrack::test {
namespace {

class FrameOptions : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_program({"simulate", "--scene", "room-gentle", "--frames", "12", "--rate", "10", "--output",
                           recording(), "--quiet"})
                  .status,
              0);
  }
  std::string recording() const { return folder_ / "film"; }

  /// Times in the first column of a table, in the order of the file, each once.
  static std::vector<std::string> times_in(const std::filesystem::path& file, char separator) {
    std::vector<std::string> times;
    std::istringstream lines(read_text(file));
    for (std::string line; std::getline(lines, line);) {
      const std::string first = line.substr(0, line.find(separator));
      const bool is_number = !first.empty() && first.find_first_not_of("0123456789.") == std::string::npos;
      if (is_number && (times.empty() || times.back() != first)) times.push_back(first);
    }
    return times;
  }

  const std::filesystem::path folder_ = temporary_folder();
};

TEST_F(FrameOptions, LeaveOutTheSameFramesEverywhere) {
  const std::vector<std::string> truth = times_in(std::filesystem::path(recording()) / "truth.tum", ' ');
  ASSERT_EQ(truth.size(), 12U);
  const std::vector<std::string> options = {"--skip", "2", "--step", "3", "--max-frames", "3"};
  const std::vector<std::string> expected = {truth[2], truth[5], truth[8]};

  std::vector<std::string> track = {"track", recording(), "--method",
                                    "pnp",   "--output",  folder_ / "poses.tum"};
  track.insert(track.end(), options.begin(), options.end());
  ASSERT_EQ(run_program(track).status, 0);
  EXPECT_EQ(times_in(folder_ / "poses.tum", ' '), expected);

  std::vector<std::string> detect = {"detect", recording(), "--output", folder_ / "corners.csv"};
  detect.insert(detect.end(), options.begin(), options.end());
  ASSERT_EQ(run_program(detect).status, 0);
  const std::vector<std::string> seconds = times_in(folder_ / "corners.csv", ',');
  EXPECT_EQ(seconds.size(), expected.size());

  std::vector<std::string> doctor = {"doctor", recording(), "--json"};
  doctor.insert(doctor.end(), options.begin(), options.end());
  EXPECT_EQ(nlohmann::json::parse(run_program(doctor).out)["recordings"][0]["frames"].get<int>(), 3);
}

TEST_F(FrameOptions, AConfigFileSaysThemToEveryCommandAndTheCommandLineWins) {
  const std::string config = folder_ / "options.yaml";
  write_text(config,
             "skip: 1\nmax-frames: 4\nmethod: pnp\noutput: " + (folder_ / "by_file.tum").string() + "\n");
  ASSERT_EQ(run_program({"track", recording(), "--config", config}).status,
            0);  // it gives --output, too, which is required
  EXPECT_EQ(times_in(folder_ / "by_file.tum", ' ').size(), 4U);
  ASSERT_EQ(run_program({"track", recording(), "--max-frames", "2", "--config", config}).status, 0);
  EXPECT_EQ(times_in(folder_ / "by_file.tum", ' ').size(), 2U);

  write_text(config, "step: 5\nwhat: 1\n");
  for (const std::string command : {"detect", "doctor", "calibrate", "track"}) {
    EXPECT_THAT(run_program({command, recording(), "--output", folder_ / "none", "--config", config}),
                EndsWith(2, command == "doctor" ? "" : "'what' is no option of " + command))
        << command;
  }
  EXPECT_THAT(run_program({"doctor", recording(), "--config", config}),
              EndsWith(2, "'what' is no option of doctor"));
}

/// A driver stamps the start when the first row is exposed, be it the top or the bottom one. Half of 16 ms,
/// and of 479 rows at 20 us.
TEST_F(FrameOptions, StampsOfAStartLieBeforeTheMiddleWhicheverWayTheRowsAreRead) {
  constexpr std::int64_t kToMiddle_ns = 8'000'000 + 479 * 10'000;
  const auto times = [&](const std::string& line_delay, const std::string& stamp_is) {
    const std::string camera = folder_ / "camera.yaml", corners = folder_ / "corners.csv";
    write_text(camera, R"(cam0: {camera_model: pinhole, intrinsics: [525.0, 525.0, 319.5, 239.5],
  distortion_model: none, distortion_coeffs: [], resolution: [640, 480],
  exposure_time: 0.016, line_delay: )" +
                           line_delay + "}\n");
    EXPECT_EQ(run_program({"detect", recording(), "--camera", camera, "--stamp-is", stamp_is, "--max-frames",
                           "1", "--output", corners})
                  .status,
              0);
    return std::stoll(times_in(corners, ',').at(0));
  };
  const std::int64_t recorded_ns = times("0", "middle");
  EXPECT_EQ(times("20.0e-6", "start") - recorded_ns, kToMiddle_ns);
  EXPECT_EQ(times("-20.0e-6", "start") - recorded_ns, kToMiddle_ns);
  EXPECT_EQ(times("-20.0e-6", "end") - recorded_ns, -kToMiddle_ns);
}

}  // namespace
}  // namespace apriltrack::test
