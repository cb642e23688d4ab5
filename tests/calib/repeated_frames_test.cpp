#include <gmock/gmock.h>

#include "calibrating.h"

// A picture that is shown many times says no more than once.

namespace apriltrack {
namespace {

using test::calibrate;
using test::error_of;
using test::SyntheticWorld;
using ::testing::Contains;
using ::testing::HasSubstr;

std::vector<FrameDetections> noisy_frames(const SyntheticWorld& world) {
  auto frames = test::exact_detections(world);
  RandomStream random(19);
  test::add_edge_noise(frames, 0.15, -0.45, random);
  return frames;
}

/// Each frame `times` times over, a thousandth of a second apart.
std::vector<FrameDetections> repeated(const std::vector<FrameDetections>& frames, int times) {
  std::vector<FrameDetections> result;
  for (const FrameDetections& frame : frames) {
    for (int i = 0; i < times; ++i) {
      result.push_back(frame);
      result.back().timestamp.ns += 1'000'000LL * i;
    }
  }
  return result;
}

TEST(RepeatedFrames, ChangeNothing) {
  const SyntheticWorld world = test::make_room(8, 24, test::perspective_camera());
  const auto frames = noisy_frames(world);
  const CalibrationResult once = calibrate(world, frames), often = calibrate(world, repeated(frames, 4));
  EXPECT_THAT(often.warnings, Contains(HasSubstr("72 frames show exactly the corners of an earlier one")));
  EXPECT_EQ(often.observations_used, once.observations_used);
  ASSERT_EQ(often.map.tags.size(), once.map.tags.size());
  for (std::size_t i = 0; i < once.map.tags.size(); ++i) {
    EXPECT_THAT(often.map.tags[i].T_map_tag, test::PoseNear(once.map.tags[i].T_map_tag, 1e-9, 1e-9));
    EXPECT_LE((*often.map.tags[i].covariance - *once.map.tags[i].covariance).norm(),
              1e-9 * once.map.tags[i].covariance->norm());
  }
}

TEST(RepeatedFrames, OfOnePictureMakeNoMap) {
  const SyntheticWorld world = test::make_room(8, 24, test::perspective_camera());
  const std::vector<FrameDetections> one = {noisy_frames(world)[3]};
  ASSERT_GT(one[0].detections.size(), 1u);
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(world, repeated(one, 50)); }),
              HasSubstr("49 frames show exactly the corners of an earlier one"));
}

}  // namespace
}  // namespace apriltrack
