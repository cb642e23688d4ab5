#include <gmock/gmock.h>

#include "adjusted_world.h"
#include "apriltrack/geometry/rotation.h"
#include "calibrating.h"

// What is wrong with a tag is named, and the map of the others is right.

namespace apriltrack {
namespace {

using test::calibrate;
using test::SyntheticWorld;
using test::tag36h11;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;
using ::testing::UnorderedElementsAre;
using FindingKind = CalibrationFinding::Kind;

constexpr int kFaulty = 11;
constexpr double kNoise_px = 0.1;

SyntheticWorld room() {
  return test::make_room(12, 120, test::perspective_camera());
}

void add_noise(std::vector<FrameDetections>& frames) {
  RandomStream random(77);
  test::add_edge_noise(frames, kNoise_px, -0.45, random);
}

MapTag& faulty_tag(SyntheticWorld& world) {
  for (MapTag& tag : world.map.tags) {
    if (tag.key == tag36h11(kFaulty)) return tag;
  }
  throw std::logic_error("no such tag");
}

/// Takes the faulty tag's detections from another world's picture of the same frame.
void take_from(const std::vector<FrameDetections>& others, std::size_t i,
               std::vector<FrameDetections>& frames) {
  const auto is_faulty = [](const Detection& detection) { return detection.tag.id == kFaulty; };
  std::erase_if(frames[i].detections, is_faulty);
  for (const Detection& detection : others[i].detections) {
    if (is_faulty(detection)) frames[i].detections.push_back(detection);
  }
}

void expect_the_others_right(const SyntheticWorld& world, const CalibrationResult& result) {
  EXPECT_GE(result.map.tags.size(), world.map.tags.size() - 1);
  TagMap others = result.map;
  std::erase_if(others.tags, [](const MapTag& tag) { return tag.key.id == kFaulty; });
  test::expect_truth(world, others, result.held_tag, 0.03, 0.02);
}

/// Of the faulty tag alone, whose message names it.
auto finding_of(CalibrationFinding::Kind kind) {
  return AllOf(Field(&CalibrationFinding::kind, kind),
               Field(&CalibrationFinding::tags, ElementsAre(tag36h11(kFaulty))),
               Field(&CalibrationFinding::message, HasSubstr(to_string(tag36h11(kFaulty)))));
}

/// The same, with a number near `value`.
auto finding_of(CalibrationFinding::Kind kind, double value, double tolerance) {
  return AllOf(finding_of(kind), Field(&CalibrationFinding::value, Optional(DoubleNear(value, tolerance))));
}

TEST(TagFaults, NamesNoneWhereThereAreNone) {
  const SyntheticWorld world = room();
  std::vector<FrameDetections> frames = test::exact_detections(world);
  add_noise(frames);
  EXPECT_THAT(calibrate(world, frames).warnings, IsEmpty());
}

TEST(TagFaults, NamesAWrongSizeAndTheRightOne) {
  for (const double factor : {0.95, 1.12}) {
    SyntheticWorld printed = room();
    const SyntheticWorld stated = room();
    faulty_tag(printed).size_m *= factor;
    std::vector<FrameDetections> frames = test::exact_detections(printed);
    add_noise(frames);
    const CalibrationResult result = calibrate(stated, frames);
    EXPECT_THAT(result.findings, Contains(finding_of(FindingKind::kWrongSize, factor, 0.01)));
    EXPECT_THAT(result.left_out, Contains(tag36h11(kFaulty)));
    expect_the_others_right(stated, result);
  }
}

TEST(TagFaults, NamesTwoPrintsOfAWrongSizeAndNotTheLens) {
  SyntheticWorld printed = room();
  const SyntheticWorld stated = printed;
  for (const std::size_t i : {2U, 7U}) printed.map.tags[i].size_m *= 1.12;
  std::vector<FrameDetections> frames = test::exact_detections(printed);
  add_noise(frames);
  const CalibrationResult result = calibrate(stated, frames);
  EXPECT_THAT(result.findings,
              UnorderedElementsAre(Field(&CalibrationFinding::kind, FindingKind::kWrongSize),
                                   Field(&CalibrationFinding::kind, FindingKind::kWrongSize)));
  EXPECT_THAT(result.left_out, ElementsAre(stated.map.tags[2].key, stated.map.tags[7].key));
  test::expect_truth(stated, result.map, result.held_tag, 0.03, 0.02);
}

TEST(TagFaults, HoldNoMapByATagOfAWrongSize) {
  SyntheticWorld printed = room();
  const SyntheticWorld stated = room();
  faulty_tag(printed).size_m *= 1.08;
  std::vector<FrameDetections> frames = test::exact_detections(printed);
  add_noise(frames);
  const std::string error = test::error_of(
      ErrorKind::kNoResult, [&] { calibrate(stated, frames, {.held_tag = tag36h11(kFaulty)}); });
  EXPECT_THAT(error, AllOf(HasSubstr(to_string(tag36h11(kFaulty))), HasSubstr("larger than its stated size"),
                           HasSubstr("hold another tag")));
  // By another one there is a map, whatever else is held.
  expect_the_others_right(stated, calibrate(stated, frames, {.held_tag = tag36h11(5)}));
}

TEST(TagFaults, NamesATagThatWasMovedOnce) {
  const SyntheticWorld world = room();
  SyntheticWorld after = room();
  Pose& pose = faulty_tag(after).T_map_tag;
  pose = pose * Pose(rotation_exp({0.0, 0.1, 0.05}), Eigen::Vector3d(0.08, -0.05, 0.0));
  std::vector<FrameDetections> frames = test::exact_detections(world), later = test::exact_detections(after);
  for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) take_from(later, i, frames);
  add_noise(frames);
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_THAT(result.findings, Contains(finding_of(FindingKind::kMoved, 0.094, 0.005)));
  EXPECT_THAT(result.left_out, Contains(tag36h11(kFaulty)));
  expect_the_others_right(world, result);
}

TEST(TagFaults, NamesAnIdThatHangsTwice) {
  const SyntheticWorld world = room();
  SyntheticWorld copy = room();
  Pose& pose = faulty_tag(copy).T_map_tag;
  pose = pose * Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(0.5, 0.3, 0.0));
  std::vector<FrameDetections> frames = test::exact_detections(world), others = test::exact_detections(copy);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i / 6 % 2 == 1) take_from(others, i, frames);
  }
  add_noise(frames);
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_THAT(result.findings, Contains(finding_of(FindingKind::kDuplicateId, 0.583, 0.02)));
  expect_the_others_right(world, result);
}

// Two views are outliers: nothing is said of the tag, and the map does not suffer.
TEST(TagFaults, KeepsTheMapRightWhereASecondCopyIsSeenInTwoFrames) {
  const SyntheticWorld world = room();
  SyntheticWorld copy = room();
  Pose& pose = faulty_tag(copy).T_map_tag;
  pose = pose * Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(0.5, 0.3, 0.0));
  std::vector<FrameDetections> frames = test::exact_detections(world), others = test::exact_detections(copy);
  int copies = 0;
  for (std::size_t i = frames.size() / 4; i < frames.size() && copies < 2; ++i) {
    if (frames[i].detections.size() < 3 || others[i].detections.size() < 3) continue;
    const std::size_t before = frames[i].detections.size();
    take_from(others, i, frames);
    if (frames[i].detections.size() == before && frames[i].detections.back().tag.id == kFaulty) {
      ++copies;
      i += frames.size() / 4;
    }
  }
  ASSERT_EQ(copies, 2);
  add_noise(frames);
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_EQ(result.observations_rejected, 2);
  test::expect_truth(world, result.map, result.held_tag, 0.005, 0.01);
}

TEST(TagFaults, NamesALiftedCorner) {
  const SyntheticWorld world = room();
  std::vector<FrameDetections> frames =
      test::filmed_with(world, kFaulty, [](Eigen::Vector3d corner, std::size_t) {
        if (corner.x() > 0.0 && corner.y() > 0.0) corner.z() -= 0.012;
        return corner;
      });
  add_noise(frames);
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_THAT(result.findings, Contains(finding_of(FindingKind::kBent)));
  expect_the_others_right(world, result);
}

TEST(TagFaults, NamesACurledPrint) {
  const SyntheticWorld world = room();
  std::vector<FrameDetections> frames =
      test::filmed_with(world, kFaulty, [](Eigen::Vector3d corner, std::size_t) {
        corner.x() *= 0.96;
        return corner;
      });
  add_noise(frames);
  EXPECT_THAT(calibrate(world, frames).findings, Contains(finding_of(FindingKind::kBent, -0.04, 0.008)));
}

TEST(TagFaults, NamesATagThatFlaps) {
  const SyntheticWorld world = room();
  std::vector<FrameDetections> frames =
      test::filmed_with(world, kFaulty, [](const Eigen::Vector3d& corner, std::size_t i) {
        const double t = 0.9 * static_cast<double>(i);
        const Pose flap(rotation_exp({0.12 * std::sin(t), 0.10 * std::cos(1.3 * t), 0.0}),
                        Eigen::Vector3d(0.02 * std::sin(0.7 * t), 0.02 * std::cos(t), 0.0));
        return Eigen::Vector3d(flap * corner);
      });
  add_noise(frames);
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_THAT(result.findings, Contains(finding_of(FindingKind::kLoose)));
  expect_the_others_right(world, result);
}

}  // namespace
}  // namespace apriltrack
