#include "apriltrack/calib/calibrate_map.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <array>

#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rotation.h"
#include "support/pose_matchers.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

using test::PoseNear;
using test::SyntheticWorld;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kExact_m = 1e-6;  // what rounding leaves of noise-free corners
constexpr double kExact_rad = 1e-6;

CalibrationResult calibrate(const SyntheticWorld& world, const std::vector<FrameDetections>& frames,
                            const CalibrationOptions& options = {}) {
  return calibrate_map(frames, world.rig, world.sizes(), options);
}

/// Every tag of the result against the truth in the frame of the held tag.
void expect_truth(const SyntheticWorld& world, const TagMap& map, const TagKey& held, double max_error_m,
                  double max_error_rad) {
  for (const MapTag& tag : map.tags)
    EXPECT_THAT(tag.T_map_tag,
                PoseNear(test::T_origin_tag(world.map, held, tag.key), max_error_m, max_error_rad))
        << to_string(tag.key);
}

/// The map is that which the same detections give when the tag is not in them at all.
void expect_map_without(const SyntheticWorld& world, std::vector<FrameDetections> frames, int id,
                        const TagMap& map) {
  for (FrameDetections& frame : frames)
    std::erase_if(frame.detections, [&](const Detection& detection) { return detection.tag.id == id; });
  const CalibrationResult without = calibrate(world, frames);
  for (const MapTag& tag : without.map.tags) {
    ASSERT_NE(map.find(tag.key), nullptr) << to_string(tag.key);
    EXPECT_THAT(map.find(tag.key)->T_map_tag, PoseNear(tag.T_map_tag, 1e-4, 1e-4)) << to_string(tag.key);
  }
}

std::string error_of(ErrorKind kind, const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.kind()), static_cast<int>(kind)) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error was thrown";
  return "";
}

TagKey tag36h11(int id) {
  return {"tag36h11", id};
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

TEST(CalibrateMap, ShrugsOffTenPercentOfOutliers) {
  const SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(23);
  test::add_noise(frames, 0.1, random);
  int outliers = 0;
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections) {
      if (random.uniform() > 0.1) continue;
      ++outliers;
      if (outliers % 2 == 0) {  // one corner drawn off, as by an occlusion
        detection.corners_px[0] += Eigen::Vector2d(6.0, -4.0);
      } else {  // a misread tag somewhere else
        for (auto& corner : detection.corners_px) corner += Eigen::Vector2d(60.0, -35.0);
      }
    }
  }
  ASSERT_GT(outliers, 10);
  const CalibrationResult result = calibrate(world, frames);
  ASSERT_EQ(result.map.tags.size(), 14u);
  expect_truth(world, result.map, result.held_tag, 0.005, 0.01);
  EXPECT_GE(result.observations_rejected, outliers);
  EXPECT_LE(result.observations_rejected,
            outliers + outliers / 2);  // those that hung on them alone may go, too
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
  EXPECT_THAT(message, HasSubstr("--tag-size"));
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
              HasSubstr("no tags were seen"));
}

TEST(CalibrateMap, SaysHowManyCopiesOfAnIdThereAre) {
  // Forty boxes that all carry id 0.
  SyntheticWorld world = test::make_room(12, 20, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  std::size_t most = 0;
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections) detection.tag.id = 0;
    most = std::max(most, frame.detections.size());
  }
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate_map(frames, world.rig, TagSizes(0.16), {}); });
  EXPECT_THAT(message, HasSubstr("tag36h11/0"));
  EXPECT_THAT(message, HasSubstr(std::to_string(most) + " copies"));
}

TEST(CalibrateMap, DropsACopyThatShowsUpOnce) {
  const SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  auto busy =
      std::find_if(frames.begin(), frames.end(), [](const auto& f) { return f.detections.size() >= 2; });
  ASSERT_NE(busy, frames.end());
  Detection stray = busy->detections[0];
  for (auto& corner : stray.corners_px)
    corner = Eigen::Vector2d(500.0, 400.0) + 0.5 * (corner - stray.corners_px[2]);
  stray.corners_px = {Eigen::Vector2d(500, 430), Eigen::Vector2d(530, 430), Eigen::Vector2d(530, 400),
                      Eigen::Vector2d(500, 400)};
  busy->detections.push_back(stray);
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_EQ(result.map.tags.size(), 14u);
  expect_truth(world, result.map, result.held_tag, kExact_m, kExact_rad);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings[0], HasSubstr(to_string(stray.tag)));
}

TEST(CalibrateMap, DropsCornersThatAreNoTagsFront) {
  const SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  int broken = 0;
  for (std::size_t k = 0; k < frames.size(); k += 15) {
    if (frames[k].detections.empty()) continue;
    auto& corners = frames[k].detections[0].corners_px;
    switch (broken++ % 3) {
      case 0:
        std::swap(corners[0], corners[1]);
        break;  // crossed
      case 1:
        std::swap(corners[1], corners[3]);
        break;  // mirrored
      default:
        corners[2].x() = std::nan("");
    }
  }
  ASSERT_GE(broken, 3);
  const CalibrationResult result = calibrate(world, frames);
  expect_truth(world, result.map, result.held_tag, kExact_m, kExact_rad);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings[0], HasSubstr(std::to_string(broken) + " of"));
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

TEST(CalibrateMap, RefusesToGuessWhichImagesOfARigBelongTogether) {
  SyntheticWorld world = test::make_room(8, 40, test::perspective_camera("cam0"));
  Camera second = test::equidistant_camera("cam1");
  second.T_this_previous = Pose(rotation_exp({0.05, 0.4, 0.0}), Eigen::Vector3d(0.1, 0.0, 0.0));
  const std::vector<FrameDetections> alone = two_takes_with_equal_times(world);
  EXPECT_EQ(calibrate(world, alone).map.tags.size(), 8u) << "of one camera a second image is another moment";

  world.rig.cameras.push_back(second);
  const std::vector<FrameDetections> frames = two_takes_with_equal_times(world);
  const std::string message = error_of(ErrorKind::kInvalidInput, [&] { calibrate(world, frames); });
  EXPECT_THAT(message, HasSubstr("cam0"));
  EXPECT_THAT(message, HasSubstr("two images"));
}

TEST(CalibrateMap, SuggestsTheFamilyAndTheSizesWhenNothingFits) {
  // What codes read by chance do: two ids on squares that lie elsewhere every time.
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  RandomStream random(37);
  std::vector<FrameDetections> frames;
  for (std::int64_t k = 0; k < 20; ++k) {
    frames.push_back({.timestamp = {k * 50'000'000}, .camera = "cam0", .detections = {}});
    for (int id = 0; id < 2; ++id) {
      const Eigen::Vector2d centre(random.uniform(200.0, 450.0) + 350.0 * id, random.uniform(200.0, 600.0));
      const double half_px = random.uniform(20.0, 120.0);
      const Eigen::Rotation2Dd turn(random.uniform(0.0, 6.28));
      Detection detection{.tag = tag36h11(id), .corners_px = {}, .hamming = {}, .decision_margin = {}};
      const std::array<Eigen::Vector2d, 4> square = {Eigen::Vector2d(-1, 1), {1, 1}, {1, -1}, {-1, -1}};
      for (std::size_t c = 0; c < 4; ++c) detection.corners_px[c] = centre + half_px * (turn * square[c]);
      frames.back().detections.push_back(detection);
    }
  }
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate_map(frames, world.rig, TagSizes(0.16), {}); });
  EXPECT_THAT(message, HasSubstr("tag family"));
  EXPECT_THAT(message, HasSubstr("sizes"));
}

TEST(CalibrateMap, NamesATagOfWrongSize) {
  const SyntheticWorld world = test::make_room(14, 120, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(31);
  test::add_noise(frames, 0.1, random);
  TagSizes sizes = world.sizes();
  sizes.set(tag36h11(9), 1.5 * world.map.find(tag36h11(9))->size_m);
  const CalibrationResult result = calibrate_map(frames, world.rig, sizes, {});
  EXPECT_THAT(result.left_out, ElementsAre(tag36h11(9)));
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("tag36h11/9")));
  expect_map_without(world, frames, 9, result.map);
  expect_truth(world, result.map, result.held_tag, 0.015, 0.01);
}

/// No map at all, or one that is right: what contradictory frames may end in. Whether there was a map.
bool refuses_or_is_right(const SyntheticWorld& world, const std::vector<FrameDetections>& frames,
                         const std::string& what) {
  try {
    const CalibrationResult result = calibrate(world, frames);
    EXPECT_FALSE(result.left_out.empty()) << what;
    for (const MapTag& tag : result.map.tags)
      EXPECT_THAT(tag.T_map_tag,
                  PoseNear(test::T_origin_tag(world.map, result.held_tag, tag.key), 0.03, 0.03))
          << what << ' ' << to_string(tag.key);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kNoResult);
    EXPECT_THAT(error.what(), HasSubstr("contradict")) << what;
    return false;
  }
}

TEST(CalibrateMap, AnIdThatHangsInTwoPlacesNeverMakesAWrongMap) {
  const SyntheticWorld world = test::make_room(14, 120, test::perspective_camera());
  int num_pairs = 0, num_maps = 0;
  for (const MapTag& hidden : world.map.tags) {
    for (const MapTag& twin : world.map.tags) {
      if (twin.key.id <= hidden.key.id || (hidden.key.id + twin.key.id) % 10 != 0) continue;  // some of all
      std::vector<FrameDetections> frames = test::exact_detections(world);
      RandomStream random(37, static_cast<std::uint64_t>(num_pairs));
      test::add_noise(frames, 0.1, random);
      for (FrameDetections& frame : frames) {
        const bool shows_twin = std::ranges::any_of(
            frame.detections, [&](const Detection& detection) { return detection.tag == twin.key; });
        std::erase_if(frame.detections,
                      [&](const Detection& d) { return shows_twin && d.tag == hidden.key; });
        for (Detection& detection : frame.detections)
          if (detection.tag == hidden.key) detection.tag = twin.key;
      }
      ++num_pairs;
      num_maps += refuses_or_is_right(world, frames, to_string(hidden.key) + " as " + to_string(twin.key));
    }
  }
  EXPECT_GE(num_pairs, 8);
  EXPECT_GE(2 * num_maps, num_pairs);  // the cause is found in most cases
}

TEST(CalibrateMap, TagsThatWereMovedWhileFilmingNeverMakeAWrongMap) {
  const SyntheticWorld world = test::make_room(14, 120, test::perspective_camera());
  int num_maps = 0;
  for (const bool are_two : {false, true}) {
    std::vector<FrameDetections> frames = test::exact_detections(world);
    RandomStream random(41);
    test::add_noise(frames, 0.1, random);
    for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) {
      if (!are_two)  // taken away, and tag 25 with another id in its stead
        std::erase_if(frames[i].detections, [](const Detection& d) { return d.tag.id == 9; });
      for (Detection& detection : frames[i].detections) {
        const int id = detection.tag.id;
        if (id == 25) detection.tag.id = 9;
        if (id == 9) detection.tag.id = 25;
      }
    }
    num_maps += refuses_or_is_right(world, frames, are_two ? "two change places" : "one moves");
  }
  EXPECT_GE(num_maps, 1);
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

}  // namespace
}  // namespace apriltrack
