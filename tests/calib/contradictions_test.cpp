#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rotation.h"
#include "calibrating.h"
#include "support/pose_matchers.h"
#include "synthetic_world.h"

// What a map is made of when detections err: outliers, copies, tags that contradict each other.

namespace apriltrack {
namespace {

using test::calibrate;
using test::error_of;
using test::expect_truth;
using test::kExact_m;
using test::kExact_rad;
using test::PoseNear;
using test::SyntheticWorld;
using test::tag36h11;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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
  for (const MapTag& tag : result.map.tags) {
    if (tag.key == result.held_tag) continue;
    EXPECT_LT(test::squared_sigmas_off(world, result.held_tag, tag), 27.9)  // one of 10,000 tags
        << to_string(tag.key);
  }
  EXPECT_GE(result.observations_rejected, outliers);
  EXPECT_LE(result.observations_rejected,
            outliers + outliers / 2);  // those that hung on them alone may go, too
}

TEST(CalibrateMap, SpeaksOfATagOfWhichAFewViewsWereRejectedAndHardlyAnyOfOthers) {
  const SyntheticWorld world = test::make_room(14, 120, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(24);
  test::add_noise(frames, 0.1, random);
  const TagKey tag = world.map.tags[6].key;
  int seen = 0, moved = 0;
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections) {
      if (detection.tag != tag || seen++ % 6 != 0) continue;
      for (auto& corner : detection.corners_px) corner += Eigen::Vector2d(60.0, -35.0);
      ++moved;
    }
  }
  ASSERT_GE(moved, 3);
  EXPECT_THAT(calibrate(world, frames).warnings,
              Contains(HasSubstr("many views were rejected of " + to_string(tag))));
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

TEST(CalibrateMap, SuggestsTheFamilyAndTheSizesWhenNothingFits) {
  // What codes read by chance do: two ids on squares that lie elsewhere every time.
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  RandomStream random(37);
  std::vector<FrameDetections> frames;
  for (std::int64_t k = 0; k < 20; ++k) {
    frames.push_back({.timestamp = {k * 50'000'000}, .camera = "cam0", .detections = {}});
    for (int id = 0; id < 2; ++id) {
      const Eigen::Vector2d centre{random.uniform(200.0, 450.0) + 350.0 * id, random.uniform(200.0, 600.0)};
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
      if (twin.key.id <= hidden.key.id || (hidden.key.id + twin.key.id) % 44 != 0) continue;  // a few
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
  EXPECT_GE(num_pairs, 3);
  EXPECT_GE(2 * num_maps, num_pairs);  // the cause is found in most cases
}

/// As where one goes around a corner: tags 3 to 9 on this side, 15 and 17 on the other, 11 on the corner. The
/// copy of 7 beyond it, or one of 11, would explain the pictures alike.
std::vector<FrameDetections> detections_around_a_corner(const SyntheticWorld& world) {
  std::vector<FrameDetections> frames = test::exact_detections(world);
  for (FrameDetections& frame : frames) {
    std::erase_if(frame.detections, [](const Detection& d) { return d.tag.id > 17; });
    const bool is_beyond =
        std::ranges::any_of(frame.detections, [](const Detection& d) { return d.tag.id > 11; });
    std::erase_if(frame.detections, [&](const Detection& d) { return is_beyond && d.tag.id < 11; });
    for (Detection& detection : frame.detections)
      if (detection.tag.id == 13) detection.tag.id = 7;
  }
  return frames;
}

TEST(CalibrateMap, NamesBothWhereEitherMayBeTheIdThatHangsTwice) {
  const SyntheticWorld world = test::make_room(14, 240, test::perspective_camera());
  std::vector<FrameDetections> frames = detections_around_a_corner(world);
  RandomStream random(43);
  test::add_noise(frames, 0.2, random);
  const CalibrationResult result = calibrate(world, frames);
  for (const int id : {7, 11}) {
    const TagKey other = tag36h11(18 - id);
    EXPECT_EQ(result.map.find(tag36h11(id)), nullptr) << id;
    EXPECT_THAT(result.warnings, Contains(AllOf(HasSubstr(to_string(tag36h11(id)) + " is seen at two places"),
                                                HasSubstr("Or " + to_string(other) + " is at fault"))));
  }
  ASSERT_GE(result.map.tags.size(), 3u);
  expect_truth(world, result.map, result.held_tag, 0.05, 0.02);  // a wrong copy is metres off
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

}  // namespace
}  // namespace apriltrack
