// What `simulate` writes as truth, held against what it filmed: the scene itself, and the pictures on the
// disk.

#include <gtest/gtest.h>

#include <filesystem>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/streaks.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_map.h"
#include "detect/corner_statistics.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

struct Filmed {
  const char* scene;
  const char* mode;
  double rate_hz;  // a few frames over much of the path
  int min_tags;    // to judge by
};

void PrintTo(const Filmed& filmed, std::ostream* out) {
  *out << filmed.scene;
}

constexpr std::size_t kNumFrames = 16;

class SimulatedTruth : public ::testing::TestWithParam<Filmed> {
 protected:
  void SetUp() override {
    folder_ = temporary_folder() / GetParam().scene;
    run_for_json({"simulate", "--scene", GetParam().scene, "--frames", std::to_string(kNumFrames), "--rate",
                  std::to_string(GetParam().rate_hz), "--exposure", "0.0005", "--seed", "3", "--output",
                  folder_});
    camera_ = read_cameras(folder_ / "camera.yaml").cameras.at(0);
    map_ = read_tag_map(folder_ / "map.yaml");
    truth_ = read_tum(folder_ / "truth.tum");
    ASSERT_EQ(truth_.size(), kNumFrames);
  }

  bool is_joint() const { return std::string(GetParam().mode) == "joint"; }

  /// Where the written files together put a tag's corners in the picture.
  std::array<Eigen::Vector2d, kNumCorners> written_corners(std::size_t frame, const TagKey& key) const {
    const Pose T_camera_map = is_joint() ? truth_[frame].pose : truth_[frame].pose.inverse();
    std::array<Eigen::Vector2d, kNumCorners> corners_px;
    const MapTag* tag = map_.find(key);
    EXPECT_NE(tag, nullptr) << to_string(key);
    if (!tag) return corners_px;
    const auto corners_map = corners_in_map(*tag);
    for (std::size_t k = 0; k < kNumCorners; ++k)
      corners_px[k] = camera_.model.project(T_camera_map * corners_map[k]).value();
    return corners_px;
  }

  /// The same world, made here.
  Scene scene() const {
    Scene scene = make_scene(GetParam().scene);
    scene.num_frames = kNumFrames;
    scene.rate_hz = GetParam().rate_hz;
    scene.exposure_s = 0.0005;
    return scene;
  }

  fs::path folder_;
  Camera camera_{.name = "none", .model = CameraModel(Pinhole{1, 1, 0, 0}, NoDistortion{})};
  TagMap map_;
  Trajectory truth_;
};

TEST_P(SimulatedTruth, IsTheScenes) {
  const Scene filmed = scene();
  int num_tags = 0;
  for (std::size_t i = 0; i < kNumFrames; ++i) {
    EXPECT_EQ(truth_[i].timestamp, filmed.timestamp(i));
    for (const TagView& view : tag_views(filmed, truth_[i].timestamp)) {
      const auto corners_px = written_corners(i, view.key);
      for (std::size_t k = 0; k < kNumCorners; ++k)
        EXPECT_LT((corners_px[k] - view.corners_px[k]).norm(), 1e-4) << to_string(view.key) << " " << i;
      ++num_tags;
    }
  }
  EXPECT_GE(num_tags, GetParam().min_tags);
}

TEST_P(SimulatedTruth, IsWhereThePicturesShowTheTags) {
  const auto source = open_source(folder_);
  Detector detector(DetectorOptions{.response = camera_.response});
  CornerStatistics statistics;
  for (std::size_t i = 0; i < kNumFrames; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame && frame->is_readable());
    ASSERT_EQ(frame->timestamp, truth_[i].timestamp);
    for (const Detection& detection : detector.detect(frame->pixels.view()))
      statistics.add(detection.corners_px, written_corners(i, detection.tag));
  }
  EXPECT_GE(statistics.num_tags(), GetParam().min_tags);
  EXPECT_LE(std::abs(statistics.radial_bias_px()), 0.03);
  EXPECT_LE(statistics.mean_px().norm(), 0.03);
  EXPECT_LE(statistics.rms_per_axis_px(), 0.16);
}

TEST_P(SimulatedTruth, ScoresZeroAgainstItself) {
  const nlohmann::json score = run_for_json(
      {"evaluate", "--truth", folder_, "--estimate", folder_ / "truth.tum", "--mode", GetParam().mode});
  EXPECT_EQ(score["coverage"], 1.0);
  for (const char* figure : {"median_px", "p95_px", "position_rmse_mm", "rotation_rmse_deg"})
    EXPECT_EQ(score[figure], 0.0) << figure;
}

INSTANTIATE_TEST_SUITE_P(Scenes, SimulatedTruth,
                         ::testing::Values(Filmed{"room-gentle", "ego", 1.0, 30},
                                           Filmed{"bundle", "joint", 5.0, 20},
                                           Filmed{"single", "joint", 5.0, 8}),
                         [](const auto& filmed) {
                           std::string name = filmed.param.scene;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace apriltrack::test
