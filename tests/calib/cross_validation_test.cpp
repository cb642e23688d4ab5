// Two halves of a recording: they agree where the world is as the model says, and only there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrating.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;
using testing::HasSubstr;

CalibrationResult halves_of(const SyntheticWorld& world, std::uint64_t seed,
                            CalibrationOptions options = {}) {
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(41, seed);
  test::add_edge_noise(frames, 0.15, -0.45, random);
  test::add_edge_biases(frames, 0.05, -0.45, random);
  options.cross_validate = true;
  return test::calibrate(world, frames, options);
}

TEST(CrossValidation, HalvesOfAnHonestWorldDifferAsTheySay) {
  const SyntheticWorld world = test::make_room(8, 80, test::equidistant_camera());
  double sum = 0.0, of_tags = 0.0;
  int count = 0;
  constexpr int kTrials = 4;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const CalibrationResult result = halves_of(world, trial);
    ASSERT_TRUE(result.cross_validation.has_value());
    const CrossValidation& halves = *result.cross_validation;
    ASSERT_EQ(halves.why_not, "");
    EXPECT_EQ(halves.moments_of_first + halves.moments_of_second, result.frames_used);
    EXPECT_EQ(halves.tags.size(), result.map.tags.size() - 1);
    EXPECT_FALSE(halves.is_in_doubt()) << halves.words;
    EXPECT_THAT(halves.words, HasSubstr("agree"));
    EXPECT_GT(halves.normalised_error_squared, 0.5);
    sum += halves.normalised_error_squared;
    for (const HalvesOfTag& tag : halves.tags) {
      of_tags += tag.normalised_error_squared;
      ++count;
      EXPECT_GT(tag.difference_m, 0.0);
    }
  }
  EXPECT_NEAR(sum / kTrials, 1.0, 0.3);
  EXPECT_NEAR(of_tags / count, 1.0, 0.3);
}

TEST(CrossValidation, TellsOfALensThatFocusesAnew) {
  // Every six moments it takes another focal length, which are the blocks of 120: each half has one of its
  // own.
  SyntheticWorld world = test::make_room(8, 120, test::equidistant_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  SyntheticWorld nearer = world;
  CameraModel& lens = nearer.rig.cameras[0].model;
  lens = CameraModel(
      {1.002 * lens.pinhole().fx, 1.002 * lens.pinhole().fy, lens.pinhole().cx, lens.pinhole().cy},
      lens.distortion());
  const std::vector<FrameDetections> others = test::exact_detections(nearer);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i / 6 % 2 == 1) frames[i] = others[i];
  }
  RandomStream random(43);
  test::add_edge_noise(frames, 0.05, -0.45, random);
  const CalibrationResult result =
      test::calibrate(world, frames, {.intrinsics = Intrinsics::kKeep, .cross_validate = true});
  ASSERT_TRUE(result.cross_validation.has_value());
  EXPECT_EQ(result.frames_used, 120);
  EXPECT_EQ(result.cross_validation->why_not, "");
  EXPECT_TRUE(result.cross_validation->is_in_doubt()) << result.cross_validation->words;
  EXPECT_THAT(result.cross_validation->words, HasSubstr("what their covariances claim"));
}

TEST(CrossValidation, SaysWhyNot) {
  const SyntheticWorld world = test::make_room(8, 16, test::equidistant_camera());
  const CalibrationResult result = halves_of(world, 1);
  ASSERT_TRUE(result.cross_validation.has_value());
  EXPECT_THAT(result.cross_validation->why_not, HasSubstr("too few"));
  EXPECT_TRUE(result.cross_validation->tags.empty());
}

TEST(CrossValidation, IsNotMadeWithoutCovariances) {
  const SyntheticWorld world = test::make_room(8, 40, test::equidistant_camera());
  const CalibrationResult result = halves_of(world, 1, {.max_tags_with_covariance = 7});
  EXPECT_THAT(result.cross_validation->why_not, HasSubstr("over 7 tags, and no covariances"));
}

TEST(CrossValidation, IsNotMadeUnlessAskedFor) {
  const SyntheticWorld world = test::make_room(8, 30, test::equidistant_camera());
  EXPECT_FALSE(test::calibrate(world, test::exact_detections(world)).cross_validation.has_value());
}

}  // namespace
}  // namespace apriltrack
