// The promises about photoreal recordings, held against their exact truth.

#include <gtest/gtest.h>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
using nlohmann::json;

TEST(Recordings, ARoomIsCalibratedToMillimetres) {
  APRILTRACK_SHARED_OR_SKIP(room, "data/room_gentle");
  const std::string map = temporary_folder() / "map.yaml";
  run_for_json({"calibrate", room, "--tag-size", "0.16", "--output", map});
  const json score = run_for_json({"map", "diff", room / "map.yaml", map});
  EXPECT_EQ(score["compared"], 14);
  // A plain adjustment of stock corners is 28 mm off, of linear-light corners 2.8 mm.
  EXPECT_LE(score["position_mm"]["rms"].get<double>(), 4.0) << score.dump(1);
  EXPECT_LE(score["rotation_deg"]["rms"].get<double>(), 0.5) << score.dump(1);
}

json localise(const std::filesystem::path& recording, const std::string& mode) {
  const std::filesystem::path folder = temporary_folder();
  run_for_json({"track", recording, "--mode", mode, "--output", folder / "out.tum", "--frames-csv",
                folder / "out.csv"});
  return run_for_json({"evaluate", "--truth", recording, "--estimate", folder / "out.tum", "--frames-csv",
                       folder / "out.csv", "--mode", mode});
}

struct Promise {
  const char* recording;
  const char* mode;
  double success_5px;  // share of all frames
  double median_px;
};

class Localising : public ::testing::TestWithParam<Promise> {};

TEST_P(Localising, ByDetectionIsAheadOfStockCorners) {
  const Promise& promise = GetParam();
  APRILTRACK_SHARED_OR_SKIP(recording, std::string("data/") + promise.recording);
  const json score = localise(recording, promise.mode);
  EXPECT_GE(score["success_5px"].get<double>(), promise.success_5px) << score.dump(1);
  EXPECT_LE(score["median_px"].get<double>(), promise.median_px) << score.dump(1);
}

// With stock corners: 0.35 and 1.64 px; 0.708 and 1.20 px; 0.71 and 0.50 px.
INSTANTIATE_TEST_SUITE_P(Recordings, Localising,
                         ::testing::Values(Promise{"room_blur", "ego", 0.42, 0.3},
                                           Promise{"single_blur", "joint", 0.75, 0.3},
                                           Promise{"bundle_blur", "joint", 0.71, 0.2}),
                         [](const auto& promise) { return std::string(promise.param.recording); });

}  // namespace
}  // namespace apriltrack::test
