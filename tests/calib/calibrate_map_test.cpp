#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rotation.h"
#include "calibrating.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

using test::calibrate;
using test::error_of;
using test::expect_truth;
using test::kExact_m;
using test::kExact_rad;
using test::SyntheticWorld;
using test::tag36h11;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// A corner far outside one of the pictures, as a misread tag has.
std::vector<FrameDetections> with_a_stray_corner(const SyntheticWorld& world) {
  auto frames = test::exact_detections(world);
  frames[3].detections.front().corners_px[0].x() += 3.0 * world.rig.cameras[0].width;
  return frames;
}

TEST(CalibrateMap, KeepsTheWarningOfAStrayCornerInItsResult) {
  const SyntheticWorld world = test::make_room(6, 60, test::perspective_camera());
  const CalibrationResult result = calibrate(world, with_a_stray_corner(world));
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("1 of 58 frames")));
}

TEST(CalibrateMap, TellsWhatItFoundBeforeItFails) {
  const SyntheticWorld world = test::make_room(6, 60, test::perspective_camera());
  std::vector<std::string> heard;
  const LogSink log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarning) heard.emplace_back(text);
  };
  error_of(ErrorKind::kInvalidInput, [&] {
    calibrate_map(with_a_stray_corner(world), world.rig, world.sizes(), {.held_tag = tag36h11(99)}, log);
  });
  EXPECT_THAT(heard, ::testing::Contains(HasSubstr("1 of 58 frames")));
}

// Whoever reads a map looks for the printed pattern: what nobody can look for must not get into one.
TEST(CalibrateMap, RefusesTagsThatNoMapCanHold) {
  const SyntheticWorld world = test::make_room(4, 12, test::perspective_camera());
  const auto calibrate_with = [&](const TagKey& stranger) {
    auto frames = test::exact_detections(world);
    for (FrameDetections& frame : frames) {
      for (Detection& detection : frame.detections)
        if (detection.tag.id == 3) detection.tag = stranger;
    }
    return error_of(ErrorKind::kInvalidInput, [&] { calibrate(world, frames); });
  };
  EXPECT_THAT(calibrate_with({"aruco", 1}),
              HasSubstr("'aruco', which no map can hold; name the printed one: "));
  EXPECT_THAT(calibrate_with(tag36h11(587)), HasSubstr("tag36h11/587, but tag36h11 has ids 0 to 586"));
}

TEST(CalibrateMap, RecoversARoomExactlyWithoutNoise) {
  const SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  const CalibrationResult result = calibrate(world, test::exact_detections(world));
  ASSERT_EQ(result.map.tags.size(), 14u);
  EXPECT_EQ(result.held_tag, tag36h11(3));
  expect_truth(world, result.map, tag36h11(3), kExact_m, kExact_rad);
  EXPECT_LT(result.residual_rms_px, 1e-6);
  EXPECT_EQ(result.observations_rejected, 0);
  EXPECT_THAT(result.warnings, ElementsAre());
}

TEST(CalibrateMap, RecoversARoomThroughAnEquidistantLens) {
  const SyntheticWorld world = test::make_room(10, 40, test::equidistant_camera());
  const CalibrationResult result = calibrate(world, test::exact_detections(world));
  ASSERT_EQ(result.map.tags.size(), 10u);
  expect_truth(world, result.map, result.held_tag, kExact_m, kExact_rad);
}

TEST(CalibrateMap, RecoversTagsThatFaceEachOther) {
  const SyntheticWorld world = test::make_facing_walls();
  const CalibrationResult result = calibrate(world, test::exact_detections(world));
  ASSERT_EQ(result.map.tags.size(), 3u);
  // The walls differ by a turn of pi, where the logarithm of a rotation jumps.
  EXPECT_NEAR(
      rotation_angle_rad(result.map.tags[0].T_map_tag.rotation(), result.map.tags[1].T_map_tag.rotation()),
      std::numbers::pi, 1e-5);
  expect_truth(world, result.map, result.held_tag, kExact_m, kExact_rad);
}

TEST(CalibrateMap, HoldsTheChosenTagAtTheOriginWithoutCovariance) {
  const SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  const CalibrationResult result =
      calibrate(world, test::exact_detections(world), {.held_tag = tag36h11(11)});
  const MapTag* held = result.map.find(tag36h11(11));
  ASSERT_NE(held, nullptr);
  EXPECT_EQ(held->T_map_tag.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(*held->covariance, Matrix6d::Zero());
  expect_truth(world, result.map, tag36h11(11), kExact_m, kExact_rad);
}

TEST(CalibrateMap, GivesTheSameMapWithAnyNumberOfThreadsAndAnyOrderOfFrames) {
  const SyntheticWorld world = test::make_room(10, 40, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(5);
  test::add_noise(frames, 0.2, random);
  const CalibrationResult serial = calibrate(world, frames, {.num_threads = 1});
  std::reverse(frames.begin(), frames.end());
  for (FrameDetections& frame : frames) std::reverse(frame.detections.begin(), frame.detections.end());
  const CalibrationResult threaded = calibrate(world, frames, {.num_threads = 3});
  ASSERT_EQ(serial.map.tags.size(), threaded.map.tags.size());
  for (std::size_t i = 0; i < serial.map.tags.size(); ++i) {
    EXPECT_EQ(serial.map.tags[i].T_map_tag.matrix(), threaded.map.tags[i].T_map_tag.matrix());
    EXPECT_EQ(*serial.map.tags[i].covariance, *threaded.map.tags[i].covariance);
  }
}

TEST(CalibrateMap, KeepsFarFrontalTagsFromFlipping) {
  // 12 px tags seen nearly face on: with 0.3 px of noise the wrong planar pose often has the smaller error.
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  for (int i = 0; i < 6; ++i)
    test::add_tag(world, 0.1,
                  test::looking_along({0.5 * (i % 3) - 0.5, 0.0, 0.6 * (i / 3)},
                                      {0.35 * (i % 2 ? 1 : -1), -1.0, 0.25 * (i % 3 - 1)}));
  for (int k = 0; k < 40; ++k)
    world.T_world_rig.push_back(
        test::looking_along({1.5 * std::sin(0.4 * k), 4.0 + 0.5 * std::cos(0.3 * k), 0.3},
                            {-0.3 * std::sin(0.4 * k), -1.0, 0.0}));
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<FrameDetections> frames = test::exact_detections(world);
    RandomStream random(17, static_cast<std::uint64_t>(trial));
    test::add_noise(frames, 0.3, random);
    const CalibrationResult result = calibrate(world, frames);
    ASSERT_EQ(result.map.tags.size(), 6u);
    // A flip is off by twice the tilt, 40 degrees and more; the noise leaves one or two.
    expect_truth(world, result.map, result.held_tag, 0.03, 0.1);
  }
}

TEST(CalibrateMap, MapsTheLargestPartAndNamesTheOthers) {
  SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  const auto is_first_group = [](const Detection& d) { return d.tag.id <= 19; };  // 9 of 14 tags
  for (FrameDetections& frame : frames) {
    const bool keeps_first = std::any_of(frame.detections.begin(), frame.detections.end(), is_first_group);
    std::erase_if(frame.detections, [&](const Detection& d) { return is_first_group(d) != keeps_first; });
  }
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_EQ(result.map.tags.size(), 9u);
  expect_truth(world, result.map, result.held_tag, kExact_m, kExact_rad);
  ASSERT_EQ(result.other_parts.size(), 1u);
  EXPECT_EQ(result.other_parts[0].tags.size(), 5u);
  expect_truth(world, result.other_parts[0], result.other_parts[0].tags[0].key, kExact_m, kExact_rad);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings[0], HasSubstr("tag36h11/29"));

  // A held tag in the smaller part makes that one the map.
  const CalibrationResult held = calibrate(world, frames, {.held_tag = tag36h11(29)});
  EXPECT_EQ(held.map.tags.size(), 5u);
  EXPECT_EQ(held.other_parts[0].tags.size(), 9u);
}

TEST(CalibrateMap, LeavesLooseAndRareTagsOutAndNamesThem) {
  SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  int views_of_rare = 0;
  for (FrameDetections& frame : frames) {
    // Tag 5 is only ever seen alone; tag 9 once only.
    const bool shows_five = std::any_of(frame.detections.begin(), frame.detections.end(),
                                        [](const Detection& d) { return d.tag.id == 5; });
    std::erase_if(frame.detections, [&](const Detection& d) {
      return (shows_five && d.tag.id != 5) || (d.tag.id == 9 && views_of_rare++ > 0);
    });
  }
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_THAT(result.left_out, ElementsAre(tag36h11(5), tag36h11(9)));
  EXPECT_EQ(result.map.find(tag36h11(5)), nullptr);
  EXPECT_EQ(result.map.find(tag36h11(9)), nullptr);
  ASSERT_EQ(result.warnings.size(), 2u);
  EXPECT_THAT(result.warnings[0], HasSubstr("tag36h11/5"));
  EXPECT_THAT(result.warnings[1], HasSubstr("tag36h11/9"));
  expect_truth(world, result.map, result.held_tag, kExact_m, kExact_rad);
}

TEST(CalibrateMap, RefusesAHeldTagThatWasNeverSeen) {
  const SyntheticWorld world = test::make_room(6, 30, test::perspective_camera());
  const std::string message = error_of(ErrorKind::kInvalidInput, [&] {
    calibrate(world, test::exact_detections(world), {.held_tag = tag36h11(500)});
  });
  EXPECT_THAT(message, HasSubstr("tag36h11/500"));
  EXPECT_THAT(message, HasSubstr("tag36h11/3"));  // what may be held
}

TEST(CalibrateMap, SaysThatAHeldTagWasLeftOutForItsCopies) {
  const SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  int copies = 0;
  for (FrameDetections& frame : frames) {
    const auto nine = std::find_if(frame.detections.begin(), frame.detections.end(),
                                   [](const Detection& d) { return d.tag.id == 9; });
    if (nine == frame.detections.end()) continue;
    Detection copy = *nine;
    const double shift_px = nine->corners_px[0].x() < 500.0 ? 300.0 : -300.0;
    for (auto& corner : copy.corners_px) corner.x() += shift_px;
    frame.detections.push_back(copy);
    ++copies;
  }
  ASSERT_GT(copies, 3);
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate(world, frames, {.held_tag = tag36h11(9)}); });
  EXPECT_THAT(message, HasSubstr("tag36h11/9 "));
  EXPECT_THAT(message, HasSubstr("two places"));
  EXPECT_THAT(message, HasSubstr("tag36h11/11"));  // what may be held
}

TEST(CalibrateMap, RefusesAHeldTagThatStandsAlone) {
  SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  for (FrameDetections& frame : frames)
    std::erase_if(frame.detections, [](const Detection& d) { return d.tag.id == 5; });
  frames.push_back(
      {.timestamp = {1}, .camera = "cam0", .detections = {test::exact_detections(world)[0].detections[0]}});
  frames.back().detections[0].tag.id = 5;
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(world, frames, {.held_tag = tag36h11(5)}); }),
              HasSubstr("tag36h11/5"));
}

TEST(CalibrateMap, NamesTagsWithoutASize) {
  const SyntheticWorld world = test::make_room(6, 30, test::perspective_camera());
  TagSizes sizes = world.sizes();
  TagSizes incomplete;
  for (const MapTag& tag : world.map.tags) {
    if (tag.key.id != 7) incomplete.set(tag.key, tag.size_m);
  }
  const std::string message = error_of(ErrorKind::kInvalidInput, [&] {
    calibrate_map(test::exact_detections(world), world.rig, incomplete, {});
  });
  EXPECT_THAT(message, HasSubstr("tag36h11/7"));
  EXPECT_THAT(message, HasSubstr("give one for all tags"));
}

TEST(CalibrateMap, SaysWhenNothingIsSeenOrNothingConnects) {
  const SyntheticWorld world = test::make_room(6, 30, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  for (FrameDetections& frame : frames) {
    if (frame.detections.size() > 1) frame.detections.resize(1);
  }
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(world, frames); }),
              HasSubstr("no two tags connect"));
  for (FrameDetections& frame : frames) frame.detections.clear();
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(world, frames); }),
              AllOf(HasSubstr("no tags were seen"), HasSubstr("check the tag family")));
}

TEST(CalibrateMap, AsksForMoreFramesWhereOneShowsSeveralTags) {
  const SyntheticWorld world = test::make_room(6, 30, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  std::erase_if(frames, [](const FrameDetections& frame) { return frame.detections.size() < 2; });
  ASSERT_FALSE(frames.empty());
  frames.resize(1);
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(world, frames); }),
              AllOf(HasSubstr("only 1 frame shows two tags or more together"),
                    HasSubstr("take more pictures of the same tags"), Not(HasSubstr("in a chain"))));
  frames.resize(5, frames.front());  // a film that stands still is one picture
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].timestamp.ns += static_cast<std::int64_t>(i);
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(world, frames); }),
              AllOf(HasSubstr("only 1 frame shows"), HasSubstr("exactly the corners of an earlier one")));
}

TEST(CalibrateMap, JoinsTagsThatDifferentCamerasOfARigSee) {
  // Two cameras back to back: no image shows tags of two walls, the rig's pose ties them together.
  SyntheticWorld world = test::make_room(8, 40, test::perspective_camera("cam0"));
  Camera back = test::equidistant_camera("cam1");
  back.T_this_previous = Pose(Eigen::Quaterniond(Eigen::AngleAxisd(
                                  0.97 * std::numbers::pi, Eigen::Vector3d(0.1, 1.0, 0.05).normalized())),
                              Eigen::Vector3d(0.1, -0.02, 0.05));
  world.rig.cameras.push_back(back);
  std::vector<FrameDetections> frames = test::exact_detections(world);
  for (FrameDetections& frame : frames) {
    if (frame.detections.size() > 1) frame.detections.resize(1);  // one tag per image
  }
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_GE(result.map.tags.size(), 6u);
  expect_truth(world, result.map, result.held_tag, kExact_m, kExact_rad);
}

/// Two takes of a rig with one clock that starts anew; its second camera missed one frame of the first take.
std::vector<FrameDetections> two_takes_with_equal_times(const SyntheticWorld& world) {
  std::vector<FrameDetections> frames = test::exact_detections(world);
  const auto half = static_cast<std::int64_t>(world.T_world_rig.size() / 2) * 50'000'000;
  std::erase_if(frames, [&](const FrameDetections& frame) {
    return frame.camera == "cam1" && frame.timestamp.ns == 5 * 50'000'000;
  });
  for (FrameDetections& frame : frames) {
    if (frame.timestamp.ns >= half) frame.timestamp.ns -= half;
  }
  return frames;
}

TEST(CalibrateMap, RefusesTwoTakesOfOneCameraWithEqualTimes) {
  const SyntheticWorld world = test::make_room(8, 40, test::perspective_camera("cam0"));
  const std::vector<FrameDetections> frames = two_takes_with_equal_times(world);
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(world, frames); }),
              AllOf(HasSubstr("cam0 has two images of the time 0 ns"), HasSubstr("shift the time stamps")));
}

TEST(CalibrateMap, RefusesToGuessWhichImagesOfARigBelongTogether) {
  SyntheticWorld world = test::make_room(8, 40, test::perspective_camera("cam0"));
  Camera second = test::equidistant_camera("cam1");
  second.T_this_previous = Pose(rotation_exp({0.05, 0.4, 0.0}), Eigen::Vector3d(0.1, 0.0, 0.0));
  world.rig.cameras.push_back(second);
  const std::vector<FrameDetections> frames = two_takes_with_equal_times(world);
  const std::string message = error_of(ErrorKind::kInvalidInput, [&] { calibrate(world, frames); });
  EXPECT_THAT(message, HasSubstr("cam0"));
  EXPECT_THAT(message, HasSubstr("two images"));
}

TEST(CalibrateMap, RefusesOptionsOutOfRange) {
  const SyntheticWorld world = test::make_room(6, 10, test::perspective_camera());
  const auto frames = test::exact_detections(world);
  EXPECT_THAT(
      error_of(ErrorKind::kInvalidInput, [&] { calibrate(world, frames, {.corner_sigma_px = -1.0}); }),
      HasSubstr("corner_sigma_px"));
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(world, frames, {.min_views = 0}); }),
              HasSubstr("min_views"));
}

TEST(CalibrateMap, PassesOverCornersThatNoCameraHas) {
  Camera camera = test::perspective_camera();  // of a lens that projects all that is before it
  camera.model = CameraModel(camera.model.pinhole(), NoDistortion{});
  const SyntheticWorld world = test::make_room(8, 40, camera);
  const auto frames = test::exact_detections(world);
  auto without = frames;
  without[3].detections.erase(without[3].detections.begin());
  const CalibrationResult expected = calibrate(world, without);
  for (const double factor : {1e5, 1e12, 1e200, 1e308}) {
    auto damaged = frames;
    for (Eigen::Vector2d& corner : damaged[3].detections[0].corners_px) corner *= factor;
    const CalibrationResult result = calibrate(world, damaged);
    EXPECT_EQ(result.observations_used, expected.observations_used) << factor;
    EXPECT_EQ(result.observations_rejected, expected.observations_rejected) << factor;
    expect_truth(world, result.map, result.held_tag, kExact_m, kExact_rad);
  }
}

TEST(CalibrateMap, WarnsOfSizesInCentimetres) {
  const SyntheticWorld world = test::make_room(6, 20, test::perspective_camera());
  const auto frames = test::exact_detections(world);
  const auto warnings = [&](double size_m) {
    return calibrate_map(frames, world.rig, TagSizes(size_m), {}).warnings;
  };
  EXPECT_THAT(warnings(16.0), ::testing::Contains(HasSubstr("given a size of 16 m: sizes are in metres")));
  EXPECT_THAT(warnings(0.16), ::testing::Not(::testing::Contains(HasSubstr("sizes are in metres"))));
}

}  // namespace
}  // namespace apriltrack
