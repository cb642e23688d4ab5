#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "measured_walls.h"

// What is said of constraints that are wrong, and what then comes of the map.

namespace apriltrack {
namespace {

using test::calibrate;
using test::distance;
using test::error_of;
using test::gravity;
using test::kNoError;
using test::noisy_frames;
using test::position;
using test::SyntheticWorld;
using test::tag36h11;
using test::true_distance_m;
using test::true_tag;
using test::walls;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Constraints, ADistanceThatContradictsTheImagesIsNamedAndThereIsNoMap) {
  CalibrationOptions options{
      .constraints = {distance(3, 7, 0.0, 0.001), distance(5, 13, 0.05, 0.001), distance(9, 19, 0.0, 0.001)}};
  options.constraints[1].where = "measured.yaml:7";
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(2), options); });
  EXPECT_THAT(message, AllOf(HasSubstr("measured.yaml:7: distance 5-13: distance: "), HasSubstr("sigmas off"),
                             Not(HasSubstr("distance 3-7")), HasSubstr("no map was made")));
}

TEST(Constraints, TwoDistancesOfTheSameTagsCannotBothBeRight) {
  CalibrationOptions options{.constraints = {distance(5, 13, 0.0, 0.001), distance(5, 13, 0.03, 0.001)}};
  options.constraints[0].name = "tape";
  options.constraints[1].name = "laser";
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(3), options); });
  EXPECT_THAT(message, AllOf(HasSubstr("laser: distance"), Not(HasSubstr("tape: distance"))));
}

TEST(Constraints, ThoseThatAgreeOnWhatIsWrongAreFoundTogether) {
  const CalibrationOptions twice{.constraints = {distance(5, 13, 0.05, 1e-5), distance(5, 13, 0.05, 1e-5)}};
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(3), twice); }),
              AllOf(HasSubstr("all together"), HasSubstr("distance 5-13")));
  CalibrationOptions board;  // 2 % too large, but well in itself
  for (const int a : {3, 5, 7}) {
    for (const int b : {5, 7, 9}) {
      if (a >= b) continue;
      const Pose T_a_b = true_tag(a).T_map_tag.inverse() * true_tag(b).T_map_tag;
      board.constraints.push_back(
          {.what = RelativePoseConstraint{
               {"", a}, {"", b}, 1.02 * T_a_b.translation(), T_a_b.rotation(), 1e-4, 1e-3}});
    }
  }
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(3), board); }),
              HasSubstr("contradict"));
}

TEST(Constraints, OneWrongCoordinateAmongManyIsTheOneThatIsNamed) {
  CalibrationOptions options;
  for (const int id : {3, 7, 11, 17, 21}) options.constraints.push_back(position(id, kNoError, 0.002));
  options.constraints[2] = position(11, {0.0, 0.1, 0.0}, 0.002);
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(4), options); });
  EXPECT_THAT(message, AllOf(HasSubstr("position 11: y: "), Not(HasSubstr("position 7:"))));
}

TEST(Constraints, AnUprightTagThatHangsUpsideDownIsNamed) {
  CalibrationOptions options{.constraints = {gravity(5, 0.01), gravity(9, 0.01), gravity(13, 0.01)}};
  std::get<GravityConstraint>(options.constraints[1].what).direction_tag *= -1.0;
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(4), options); });
  EXPECT_THAT(message, AllOf(HasSubstr("gravity 9: tilt: "), Not(HasSubstr("gravity 5:"))));
}

TEST(Constraints, DistancesThatAreAllTooLongHintAtTheTagSize) {
  CalibrationOptions options;
  for (const auto& [a, b] : {std::pair(3, 11), {5, 15}, {7, 19}})
    options.constraints.push_back(distance(a, b, 0.02 * true_distance_m(a, b), 0.001));
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(5), options); });
  EXPECT_THAT(message, HasSubstr("All 3 distances are "));
  EXPECT_THAT(message, HasSubstr("longer than in the map: a wrong tag size"));
}

TEST(Constraints, ADoubtfulOneIsAWarning) {
  const CalibrationResult fair =
      calibrate(walls(), noisy_frames(6), {.constraints = {distance(5, 13, 0.0, 0.001)}});
  const ConstraintReading& reading = fair.constraint_audits[0].readings[0];
  const double error_m = *reading.predicted + 4.0 * *reading.sigma - true_distance_m(5, 13);
  const CalibrationResult result =
      calibrate(walls(), noisy_frames(6), {.constraints = {distance(5, 13, error_m, 0.001)}});
  EXPECT_NEAR(*result.constraint_audits[0].z, 4.0, 0.01);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("constraint in doubt: distance 5-13: distance: ")));
  EXPECT_THAT(result.findings,
              Contains(Field(&CalibrationFinding::kind, CalibrationFinding::Kind::kConstraintInDoubt)));
}

TEST(Constraints, AnUnknownTagIsAnErrorThatSaysWhatWasSeen) {
  CalibrationOptions options{
      .constraints = {{.what = DistanceConstraint{{"", 3}, {"", 4}, 1.0, 0.1}, .where = "measured.yaml:3"}}};
  const auto frames = test::exact_detections(walls());
  EXPECT_THAT(
      error_of(ErrorKind::kInvalidInput, [&] { calibrate(walls(), frames, options); }),
      HasSubstr("measured.yaml:3: distance 3-4: tag 4 was never seen; seen were: tag36h11/3, tag36h11/5"));
  options.constraints[0].what = DistanceConstraint{{"", 3}, {"tag25h9", 5}, 1.0, 0.1};
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(walls(), frames, options); }),
              HasSubstr("tag25h9/5 was never seen"));
  options.constraints[0].what = DistanceConstraint{{"", 3}, {"", 5}, -1.0, 0.1};
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(walls(), frames, options); }),
              HasSubstr("distance_m: must be in (0, 1e7] m (is -1)"));
}

TEST(Constraints, DoNotNameATagTwiceOnceWithItsFamily) {
  const auto frames = test::exact_detections(walls());
  CalibrationOptions options{.constraints = {{.what = DistanceConstraint{{"", 3}, tag36h11(3), 1.0, 0.1},
                                              .where = "measured.yaml:3"}}};
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(walls(), frames, options); }),
              HasSubstr("measured.yaml:3: "));
  options.constraints[0].what =
      CoplanarConstraint{{{"", 3}, tag36h11(3), tag36h11(5), tag36h11(7)}, 0.001, std::nullopt};
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(walls(), frames, options); }),
              HasSubstr("measured.yaml:3: "));
}

TEST(Constraints, AreNotUsedWhereATagIsNotInTheMap) {
  auto frames = test::exact_detections(walls());
  for (FrameDetections& frame : frames) {  // seen alone, so in no map
    const bool shows_it =
        std::ranges::any_of(frame.detections, [](const auto& one) { return one.tag.id == 9; });
    if (shows_it) std::erase_if(frame.detections, [](const auto& one) { return one.tag.id != 9; });
  }
  const CalibrationResult result =
      calibrate(walls(), frames, {.constraints = {distance(3, 9, 0.5, 0.001), distance(3, 5, 0.0, 0.001)}});
  EXPECT_EQ(result.map.find(tag36h11(9)), nullptr);
  EXPECT_THAT(result.warnings,
              Contains(HasSubstr("constraint 'distance 3-9' is not used: not in the map: tag36h11/9")));
  ASSERT_EQ(result.constraint_audits.size(), 2u);
  EXPECT_FALSE(result.constraint_audits[0].is_used);
  EXPECT_TRUE(result.constraint_audits[1].is_used);
  EXPECT_EQ(result.constraints.size(), 1u);
}

TEST(Constraints, NeedCovariances) {
  const CalibrationOptions options{.constraints = {distance(3, 5, 0.0, 0.001)},
                                   .max_tags_with_covariance = 9};
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(walls(), noisy_frames(7), options); }),
              HasSubstr("constraints: need the covariance of all tags"));
}

TEST(Constraints, AnErrorTellsEveryAudit) {
  const CalibrationOptions options{
      .constraints = {distance(3, 7, 0.0, 0.001), distance(5, 13, 0.05, 0.001), distance(9, 19, 0.0, 0.001)}};
  try {
    calibrate(walls(), noisy_frames(2), options);
    FAIL() << "a map was made";
  } catch (const ConstraintError& error) {
    ASSERT_EQ(error.audits().size(), 3u);
    EXPECT_TRUE(error.audits()[0].is_used);
    EXPECT_FALSE(error.audits()[1].is_used);
    EXPECT_GT(*error.audits()[1].z, 5.0);
    EXPECT_NEAR(error.audits()[1].readings.at(0).measured - *error.audits()[1].readings.at(0).predicted, 0.05,
                0.01);
  }
}

TEST(Constraints, OfManyThatContradictTheFirstAreNamedAndTheRestCounted) {
  CalibrationOptions options;
  const std::vector<MapTag>& tags = walls().map.tags;
  for (std::size_t a = 0; a < tags.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double error_m = (a + b) % 2 == 0 ? 0.1 * static_cast<double>(a) : 0.0;
      options.constraints.push_back(distance(tags[a].key.id, tags[b].key.id, error_m, 0.001));
    }
  }
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(2), options); });
  EXPECT_THAT(message, HasSubstr(" more"));
  EXPECT_LT(message.size(), 2500u);
}

/// All of them, as in feet.
TEST(Constraints, WhereMostContradictTheUnitIsAskedForAndNoneIsTriedOneByOne) {
  CalibrationOptions options;
  const std::vector<MapTag>& tags = walls().map.tags;
  for (std::size_t a = 0; a < tags.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const int id_a = tags[a].key.id, id_b = tags[b].key.id;
      options.constraints.push_back(distance(id_a, id_b, 2.28 * true_distance_m(id_a, id_b), 0.001));
    }
  }
  const auto why = [&] {
    return error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(2), options); });
  };
  EXPECT_THAT(why(), AllOf(HasSubstr("45 of 45 contradict: is the unit metres"), HasSubstr(" and 15 more")))
      << "five are named of the twenty that were taken away";

  options.constraints.clear();
  for (int repeat = 0; repeat < 3; ++repeat) {
    for (const MapTag& tag : tags)
      options.constraints.push_back(position(tag.key.id, 2.28 * tag.T_map_tag.translation(), 0.001));
  }
  EXPECT_THAT(why(), HasSubstr("of 30 contradict: is the unit metres"));

  // A few in error are named, and the unit is left in peace.
  options.constraints.clear();
  for (const auto& [a, b, error_m] :
       {std::tuple(3, 11, 0.3), {5, 15, 0.2}, {7, 19, 0.4}, {3, 7, 0.0}, {9, 19, 0.0}, {5, 13, 0.0}})
    options.constraints.push_back(distance(a, b, error_m, 0.001));
  EXPECT_THAT(why(), AllOf(HasSubstr("distance 3-11"), HasSubstr("distance 5-15"), HasSubstr("distance 7-19"),
                           Not(HasSubstr("metres"))));
}

TEST(Constraints, FiguresThatDifferAreToldApart) {
  EXPECT_EQ(told_apart(1.52011, 1.52014, 4), std::pair(std::string("1.52011"), std::string("1.52014")));
  EXPECT_EQ(told_apart(1.5, 1.6, 4), std::pair(std::string("1.5000"), std::string("1.6000")));
  EXPECT_EQ(told_apart(2.0, 2.0, 4), std::pair(std::string("2.0000"), std::string("2.0000")));
  // A steel tape of a hundredth of a millimetre, off by a tenth: four decimals would show one figure twice.
  const double mapped_m = true_distance_m(5, 7);
  const double measured_m = std::round(mapped_m * 1e3) / 1e3 + 0.00001;
  SyntheticWorld near = walls();
  CalibrationOptions options{
      .constraints = {{.what = DistanceConstraint{{"", 5}, {"", 7}, measured_m, 1e-6}}},
      .corner_sigma_px = 1e-4,
      .corner_bias_px = 0.0};
  for (MapTag& tag : near.map.tags) {  // to put the true distance 0.03 mm beside what was measured
    if (tag.key == tag36h11(7)) {
      const Eigen::Vector3d from = near.map.find(tag36h11(5))->T_map_tag.translation();
      const Eigen::Vector3d along = (tag.T_map_tag.translation() - from).normalized();
      tag.T_map_tag = Pose(tag.T_map_tag.rotation(), from + (measured_m + 0.00003) * along);
    }
  }
  const std::string message =
      error_of(ErrorKind::kNoResult, [&] { calibrate(near, test::exact_detections(near), options); });
  const std::size_t begin = message.find("distance: ") + 10, end = message.find(" m measured");
  const std::string measured = message.substr(begin, end - begin);
  EXPECT_THAT(message, Not(HasSubstr("all else says " + measured + " m")));
  EXPECT_THAT(message, Not(HasSubstr("sigma 0.0 mm")));
}

TEST(Constraints, ATagThatAMeasurementTiesIsNotWeak) {
  // Two frames are few, and the images alone do not know tag 5 well.
  auto frames = noisy_frames(3);
  int left = 3;
  for (FrameDetections& frame : frames) {
    std::erase_if(frame.detections, [&](const auto& one) { return one.tag.id == 5 && left-- <= 0; });
  }
  const Pose T_ab = true_tag(3).T_map_tag.inverse() * true_tag(5).T_map_tag;
  const auto flags = [&](const CalibrationOptions& options) {
    return calibrate(walls(), frames, options).map.find(tag36h11(5))->statistics->flags;
  };
  EXPECT_THAT(flags({}), Contains("weak"));
  EXPECT_THAT(
      flags(
          {.constraints = {{.what =
                                RelativePoseConstraint{
                                    {"", 3}, {"", 5}, T_ab.translation(), T_ab.rotation(), 0.001, 0.002}}}}),
      Not(Contains("weak")));
}

}  // namespace
}  // namespace apriltrack
