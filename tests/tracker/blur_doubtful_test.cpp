#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "apriltrack/tags/tag_corners.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

constexpr std::size_t kNumBothRead = 4;
constexpr double kBodySpeed_m_per_s = 0.7;

/// A body of two tags that goes to the right, square to the camera: a lone tag tells its tilt badly then, and
/// with the tilt the other tag moves much, for it is far before the first.
Scene two_tags_in_motion() {
  Scene scene = still_tag().scene;
  scene.exposure_s = 0.024;
  scene.camera.exposure_s = scene.exposure_s;
  MapTag before = scene.map.tags[0];
  before.key.id = 8;
  before.size_m = 0.05;
  before.T_map_tag = Pose(Eigen::Quaterniond::Identity(), {0.0, -0.12, -0.5});
  scene.map.tags.push_back(before);
  Motion motion;
  motion.position_m[0].rate_per_s = kBodySpeed_m_per_s;
  motion.position_m[0].offset = -0.12 - kBodySpeed_m_per_s * 1e-9 * static_cast<double>(scene.start_ns);
  motion.position_m[1].offset = 0.05;
  motion.position_m[2].offset = 1.8;
  Body body{.name = "tags", .T_world_body = motion, .panels = {}};
  add_tags(body, scene.map, {.margin_cells = 0.5});
  scene.bodies = {body};
  scene.num_frames = kNumBothRead + 2;
  return scene;
}

/// Both tags are read exactly in the first frames. Then they are not, and a hand covers the one in front.
class TagBesideAHand : public ::testing::Test {
 protected:
  TagBesideAHand() {
    BlurTrackerOptions options;
    options.mode = TrackMode::kJoint;
    options.num_particles = 60;
    options.max_prediction_s = 0.05;  // one frame and a half
    BlurTracker tracker(film_.scene.camera, film_.scene.map, options);
    for (std::size_t i = 0; i < film_.size(); ++i) {
      const std::vector<Detection> exact = exact_detections(i);
      GrayImage image = film_.frames[i].pixels;
      if (i >= kNumBothRead) cover(exact[1], image);
      Frame frame = film_.frames[i].frame();
      frame.image = image.view();
      results_.push_back(tracker.track(frame, i < kNumBothRead ? exact : std::vector<Detection>()));
    }
  }

  std::vector<Detection> exact_detections(std::size_t index) const {
    std::vector<Detection> detections;
    for (const MapTag& tag : film_.scene.map.tags) {
      Detection& seen = detections.emplace_back();
      seen.tag = tag.key;
      seen.hamming = 0;
      const Pose T_camera_tag = film_.frames[index].truth * tag.T_map_tag;
      const auto corners = tag_corners(tag.size_m);
      for (std::size_t i = 0; i < kNumCorners; ++i)
        seen.corners_px[i] = *film_.scene.camera.model.project(T_camera_tag * corners[i]);
    }
    return detections;
  }
  static void cover(const Detection& tag, GrayImage& image) {
    constexpr double kMargin_px = 18.0;
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& corner : tag.corners_px) box.extend(corner);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        if (box.exteriorDistance(Eigen::Vector2d(x, y)) < kMargin_px) image(x, y) = 110;
      }
    }
  }

  const BlurFilm film_{two_tags_in_motion(), 1};
  std::vector<TrackResult> results_;
};

TEST_F(TagBesideAHand, IsFollowedButNotClaimedNorLearnedFrom) {
  for (std::size_t i = 0; i < kNumBothRead; ++i)
    EXPECT_EQ(results_[i].status, TrackStatus::kDetected) << "frame " << i;
  // Where the other tag would be, is open by more than 10 px.
  const TrackResult &doubtful = results_[kNumBothRead], &next = results_[kNumBothRead + 1];
  EXPECT_EQ(doubtful.status, TrackStatus::kPredicted) << doubtful.reason;
  EXPECT_TRUE(doubtful.exposure->is_estimated);
  EXPECT_EQ(next.exposure->exposure_s, doubtful.exposure->exposure_s);
  // The last claim is too old to predict from: the motion goes on from what was followed.
  EXPECT_EQ(next.status, TrackStatus::kPredicted) << next.reason;
}

constexpr std::size_t kNumBeforeTheJump = 4;
constexpr std::size_t kNumSkipped = 2;

/// A body of one tag, which goes to the right and is seen tilted, square to nothing.
Scene one_tag_in_motion() {
  Scene scene = still_tag().scene;
  scene.exposure_s = 0.024;
  scene.camera.exposure_s = scene.exposure_s;
  Motion motion;
  motion.position_m[0].rate_per_s = kBodySpeed_m_per_s;
  motion.position_m[0].offset = -0.2 - kBodySpeed_m_per_s * 1e-9 * static_cast<double>(scene.start_ns);
  motion.position_m[2].offset = 1.2;
  motion.yaw_rad.offset = 0.6;
  Body body{.name = "tag", .T_world_body = motion, .panels = {}};
  add_tags(body, scene.map, {.margin_cells = 0.5});
  scene.bodies = {body};
  scene.num_frames = kNumBeforeTheJump + kNumSkipped + 2;
  return scene;
}

/// Read in the first frames, then not; and film is cut out between, while the time stamps go on.
TEST(TagThatJumps, IsFollowedButNotClaimedBeforeItGoesOnAsItShould) {
  const BlurFilm film(one_tag_in_motion(), 1);
  BlurTracker tracker = tracker_of(film);
  std::vector<TrackResult> results;
  std::vector<double> errors_px;
  for (std::size_t i = 0; i < film.size(); ++i) {
    const bool is_before = i < kNumBeforeTheJump;
    if (!is_before && i < kNumBeforeTheJump + kNumSkipped) continue;
    Frame frame = film.frames[i].frame();
    frame.timestamp = film.frames[results.size()].frame().timestamp;
    results.push_back(tracker.track(frame, is_before ? film.detections[i] : std::vector<Detection>()));
    errors_px.push_back(results.back().pose ? film.corner_error_px(i, *results.back().pose) : 1e3);
  }
  for (std::size_t i = 0; i < kNumBeforeTheJump; ++i) EXPECT_TRUE(has_evidence(results[i])) << "frame " << i;
  const std::size_t jump = kNumBeforeTheJump;
  EXPECT_EQ(results[jump].status, TrackStatus::kPredicted) << results[jump].reason;
  EXPECT_LT(errors_px[jump], 1.0);
  EXPECT_EQ(results[jump + 1].status, TrackStatus::kTracked) << results[jump + 1].reason;
  EXPECT_LT(errors_px[jump + 1], 1.0);
}

}  // namespace
}  // namespace apriltrack::test
