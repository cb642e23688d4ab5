#include <gtest/gtest.h>

#include <array>

#include "apriltrack/calib/calibrate_map.h"
#include "calib/synthetic_world.h"
#include "side_by_side.h"

namespace apriltrack {
namespace {

struct Job {
  test::SyntheticWorld world;
  std::vector<FrameDetections> frames;
};

Job make_job(int num_tags, std::uint64_t seed) {
  Job job{test::make_room(num_tags, 24, test::perspective_camera()), {}};
  job.frames = test::exact_detections(job.world);
  RandomStream random(seed);
  test::add_noise(job.frames, 0.3, random);
  return job;
}

CalibrationResult calibrate(const Job& job, int num_threads) {
  return calibrate_map(job.frames, job.world.rig, job.world.sizes(), {.num_threads = num_threads});
}

void expect_equal(const CalibrationResult& found, const CalibrationResult& expected) {
  ASSERT_EQ(found.map.tags.size(), expected.map.tags.size());
  EXPECT_EQ(found.residual_rms_px, expected.residual_rms_px);
  EXPECT_EQ(found.observations_used, expected.observations_used);
  for (std::size_t i = 0; i < expected.map.tags.size(); ++i) {
    SCOPED_TRACE(to_string(expected.map.tags[i].key));
    EXPECT_EQ(found.map.tags[i].key, expected.map.tags[i].key);
    EXPECT_EQ(found.map.tags[i].T_map_tag.matrix(), expected.map.tags[i].T_map_tag.matrix());
    ASSERT_TRUE(found.map.tags[i].covariance && expected.map.tags[i].covariance);
    EXPECT_EQ(*found.map.tags[i].covariance, *expected.map.tags[i].covariance);
  }
}

TEST(CalibrationThreads, SeveralGiveTheSameAsOne) {
  const Job job = make_job(8, 421);
  const CalibrationResult alone = calibrate(job, 1);
  ASSERT_EQ(alone.map.tags.size(), 8U);
  for (const int num_threads : {2, 4}) {
    SCOPED_TRACE(std::to_string(num_threads) + " threads");
    expect_equal(calibrate(job, num_threads), alone);
  }
}

TEST(CalibrationsSideBySide, GiveTheSameAsOneByOne) {
  const std::array<Job, 2> jobs = {make_job(8, 422), make_job(10, 423)};
  const auto together = test::side_by_side(jobs.size(), [&](std::size_t i) { return calibrate(jobs[i], 2); });
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    SCOPED_TRACE("calibration " + std::to_string(i));
    expect_equal(together[i], calibrate(jobs[i], 1));
  }
}

}  // namespace
}  // namespace apriltrack
