#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "blur_film.h"

namespace apriltrack::test {
namespace {

struct ExposureRun {
  std::vector<TrackResult> results;
  double worst_px = 0.0;        ///< Of the claimed poses.
  std::size_t within_5_px = 0;  ///< Frames.
  std::size_t num_claimed = 0;
  double factor = 0.0;  ///< Of the last frame: used over true.
};

/// The film by a tracker that is told `factor` times its exposure; none: nothing.
ExposureRun run_with_exposure(const BlurFilm& film, const std::optional<double>& factor) {
  Camera camera = film.scene.camera;
  camera.exposure_s.reset();
  BlurTrackerOptions options;
  options.mode = film.scene.truth == TruthKind::kJoint ? TrackMode::kJoint : TrackMode::kEgo;
  options.num_particles = 60;
  BlurTracker tracker(camera, film.scene.map, options);
  ExposureRun run;
  for (std::size_t i = 0; i < film.size(); ++i) {
    Frame frame = film.frames[i].frame();
    frame.exposure_s.reset();
    if (factor) frame.exposure_s = *factor * film.scene.exposure_s;
    run.results.push_back(tracker.track(frame, film.detections[i]));
    const TrackResult& result = run.results.back();
    const double off_px =
        result.pose ? film.corner_error_px(i, *result.pose) : std::numeric_limits<double>::infinity();
    if (off_px < 5.0) ++run.within_5_px;
    if (!has_evidence(result)) continue;
    ++run.num_claimed;
    run.worst_px = std::max(run.worst_px, off_px);
  }
  run.factor = run.results.back().exposure->exposure_s / film.scene.exposure_s;
  return run;
}

/// 24 ms, where 10 are usual: velocities are 2.4 times too high at first.
TEST(BlurTrackerExposure, IsFoundWhereNobodyTellsIt) {
  for (const BlurFilm* film : {&shaken_camera(), &swung_camera(), &waved_tag()}) {
    const ExposureRun run = run_with_exposure(*film, std::nullopt);
    EXPECT_LT(run.worst_px, 5.0);
    EXPECT_GE(run.within_5_px + 1, film->size());
    EXPECT_NEAR(std::log(run.factor), 0.0, 0.1) << run.factor;
    const ExposureReport& last = *run.results.back().exposure;
    EXPECT_TRUE(last.is_estimated);
    EXPECT_FALSE(last.told_s);
    EXPECT_LT(std::abs(std::log(run.factor)), 4.0 * last.sigma);
    EXPECT_EQ(run.results.front().exposure->exposure_s, BlurTrackerOptions().default_exposure_s);
    EXPECT_FALSE(run.results.front().exposure->is_estimated);
  }
}

TEST(BlurTrackerExposure, IsCorrectedWhereItIsToldWrongAndKeptWhereItIsRight) {
  for (const double told : {0.8, 1.0, 1.2}) {
    const ExposureRun run = run_with_exposure(shaken_camera(), told);
    EXPECT_LT(run.worst_px, 2.0) << told;
    EXPECT_EQ(run.num_claimed, shaken_camera().size()) << told;
    EXPECT_NEAR(run.factor, 1.0, told == 1.0 ? 0.03 : 0.08) << told;
    EXPECT_NEAR(*run.results.back().exposure->told_s, told * shaken_camera().scene.exposure_s, 1e-9);
  }
}

TEST(BlurTrackerExposure, StaysAsItIsWhereNothingMoves) {
  const ExposureRun run = run_with_exposure(far_tag(), 1.2);
  EXPECT_EQ(run.factor, 1.2);
  EXPECT_FALSE(run.results.back().exposure->is_estimated);
}

}  // namespace
}  // namespace apriltrack::test
