// The paper's filter through the command line.

#include <gtest/gtest.h>

#include <filesystem>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

TEST(TrackPaper, FollowsATagAndRepeatsItselfOnAnyNumberOfThreads) {
  const fs::path folder = temporary_folder();
  const std::string film = folder / "single";
  run_for_json({"simulate", "--scene", "single", "--frames", "10", "--seed", "3", "--output", film});
  for (const std::string variant : {"printed", "program"}) {
    std::string first;
    for (const std::string threads : {"1", "2"}) {
      const fs::path tum = folder / (variant + threads + ".tum");
      const json summary =
          run_for_json({"track", film, "--mode", "joint", "--method", "paper", "--paper-variant", variant,
                        "--particles", "500", "--seed", "7", "--threads", threads, "--output", tum});
      EXPECT_EQ(summary["method"], "paper");
      if (first.empty()) first = read_text(tum);
      EXPECT_FALSE(first.empty());
      EXPECT_EQ(first, read_text(tum));
    }
    const json score = run_for_json(
        {"evaluate", "--truth", film, "--mode", "joint", "--estimate", folder / (variant + "1.tum")});
    EXPECT_EQ(score["coverage"], 1.0);
    EXPECT_LT(score["median_px"].get<double>(), 15.0);  // of a tag of 170 px; 500 particles are few
  }
}

TEST(TrackPaper, AsksForImages) {
  const fs::path folder = temporary_folder();
  EXPECT_THAT(run_program({"track", "--detections", folder / "corners.csv", "--method", "paper", "--output",
                           folder / "out.tum"}),
              EndsWith(2, "--method pnp"));
  EXPECT_THAT(
      run_program({"track", folder, "--method", "paper", "--particles", "0", "--output", folder / "o.tum"}),
      EndsWith(2, "--particles"));
  EXPECT_THAT(run_program({"track", folder, "--method", "paper", "--paper-variant", "best", "--output",
                           folder / "o.tum"}),
              EndsWith(2, "printed"));
}

}  // namespace
}  // namespace apriltrack::test
