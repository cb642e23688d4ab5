// Tags of two printers, or of a printer on two days, that were given one size.
#include "hypotheses/print_batches.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "adjusted_world.h"
#include "calibrating.h"
#include "model/corner_views.h"
#include "uncertainty/linear_part.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::SyntheticWorld;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kPrintedTags = 10;

/// Ten tags, each larger than stated by its share, filmed with noise.
struct Printed {
  SyntheticWorld stated = test::make_room(kPrintedTags, 80, test::perspective_camera()), truth = stated;
  std::vector<FrameDetections> frames;

  /// larger_by: of the number of a tag.
  explicit Printed(const std::function<double(int)>& larger_by, double noise_px = 0.1,
                   std::uint64_t seed = 7) {
    for (int tag = 0; tag < kPrintedTags; ++tag)
      truth.map.tags[static_cast<std::size_t>(tag)].size_m *= 1.0 + larger_by(tag);
    frames = test::exact_detections(truth);
    RandomStream random(seed);
    test::add_edge_noise(frames, noise_px, -0.45, random);
  }
};

/// The same tags by two cameras.
Printed by_a_rig(const std::function<double(int)>& larger_by) {
  Printed printed(larger_by);
  Camera second = test::perspective_camera("cam1");
  second.T_this_previous =
      Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(-0.3, 0.0, 0.0));
  for (SyntheticWorld* world : {&printed.stated, &printed.truth}) world->rig.cameras.push_back(second);
  printed.frames = test::exact_detections(printed.truth);
  RandomStream random(7);
  test::add_edge_noise(printed.frames, 0.1, -0.45, random);
  return printed;
}

std::optional<PrintBatches> batches_of(const Printed& printed) {
  const AdjustedWorld one(printed.stated, printed.frames, {.corner_bias_px = 0.02});
  const LinearPart linear(one.task(), one.solved.state, one.solved.part, one.solved.held_tag);
  if (!linear.poses) return std::nullopt;
  return find_print_batches(one.observations, linear.part.views, one.solved.state, linear.part.tags,
                            *linear.poses, linear.scale);
}

double second_half_larger(int tag) {
  return tag >= kPrintedTags / 2 ? 0.015 : 0.0;
}

TEST(PrintBatches, AreFoundWithTheirRatio) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto batches = batches_of(Printed(second_half_larger, 0.1, seed));
    ASSERT_TRUE(batches) << seed;
    EXPECT_THAT(batches->smaller, ElementsAre(test::tag36h11(3), test::tag36h11(5), test::tag36h11(7),
                                              test::tag36h11(9), test::tag36h11(11)));
    EXPECT_EQ(batches->larger.size(), 5U);
    EXPECT_NEAR(batches->log_ratio, std::log(1.015), 4.0 * batches->sigma) << seed;
    EXPECT_LT(batches->sigma, 0.003);
  }
}

TEST(PrintBatches, AreNotFoundWhereTagsAreAsStatedOrSpreadEvenly) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_FALSE(batches_of(Printed([](int) { return 0.0; }, 0.2, seed))) << seed;
    EXPECT_FALSE(batches_of(Printed([](int tag) { return 0.004 * tag - 0.018; }, 0.1, seed))) << seed;
  }
}

TEST(PrintBatches, AreNotFoundWhereOneTagIsOdd) {
  EXPECT_FALSE(batches_of(Printed([](int tag) { return tag == 3 ? 0.03 : 0.0; })));
}

TEST(PrintBatches, AreNotFoundWhereATagOfFewViewsGoesWithTheOddOne) {
  Printed printed([](int tag) { return tag == 3 ? 0.02 : 0.0; });
  int seen = 0;
  for (FrameDetections& frame : printed.frames) {
    std::erase_if(frame.detections, [&](const Detection& detection) {
      return detection.tag == test::tag36h11(15) && ++seen > 4;
    });
  }
  EXPECT_FALSE(batches_of(printed));
}

TEST(PrintBatches, LeaveOutATagWhoseSizeIsNotAskedFor) {
  const Printed printed(second_half_larger);
  const AdjustedWorld one(printed.stated, printed.frames, {.corner_bias_px = 0.02});
  const AdjustedPart& solved = one.solved;
  const auto views = corner_views(one.observations, solved.part.views, solved.state);
  const auto poses = PoseInformation::of(views, solved.part.tags, solved.held_tag);
  ASSERT_TRUE(poses);
  std::vector<int> asked = solved.part.tags;
  asked.erase(asked.begin() + 2);
  const auto batches = find_print_batches(one.observations, solved.part.views, solved.state, asked, *poses,
                                          error_scale(views, *poses, 0.02));
  ASSERT_TRUE(batches);
  EXPECT_EQ(batches->smaller.size(), 4U);
  EXPECT_EQ(batches->larger.size(), 5U);
}

TEST(PrintBatches, OfARigAreFoundAndNoCommonSize) {
  EXPECT_TRUE(batches_of(by_a_rig(second_half_larger)));
  EXPECT_FALSE(batches_of(by_a_rig([](int) { return 0.015; })));
}

TagFinding size_finding(int tag, double log_scale) {
  TagFinding finding;
  finding.tag = tag;
  finding.is_left_out = true;
  finding.shape = ShapeError{.size_m = 0.16, .log_scale = log_scale};
  return finding;
}

TEST(PrintBatches, AreToldByTagsThatWereLeftOutOneByOne) {
  Observations observations;
  for (int id = 0; id < 6; ++id) observations.tags.push_back(test::tag36h11(id));
  const std::vector<int> rest{0, 1, 2, 3};
  const auto by = [&](double a, double b) {
    return print_batches_by({size_finding(5, a), size_finding(4, b)}, observations, rest);
  };
  const auto larger = by(0.040, 0.041);
  ASSERT_TRUE(larger);
  EXPECT_THAT(larger->larger, ElementsAre(test::tag36h11(4), test::tag36h11(5)));
  EXPECT_EQ(larger->smaller.size(), 4U);
  EXPECT_NEAR(larger->log_ratio, 0.0405, 1e-9);
  const auto smaller = by(-0.040, -0.041);
  ASSERT_TRUE(smaller);
  EXPECT_THAT(smaller->smaller, ElementsAre(test::tag36h11(4), test::tag36h11(5)));
  EXPECT_GT(smaller->log_ratio, 0.0);
  EXPECT_FALSE(by(0.04, 0.1)) << "mistyped, each for itself";
  EXPECT_FALSE(by(0.04, -0.04));
  EXPECT_FALSE(by(0.69, 0.69)) << "twice as large: no setting of a printer";
  EXPECT_FALSE(print_batches_by({size_finding(5, 0.04)}, observations, rest)) << "one";
  TagFinding other = size_finding(4, 0.0);
  other.kind = TagFinding::Kind::kMoved;
  EXPECT_FALSE(print_batches_by({size_finding(5, 0.04), other}, observations, rest));
}

TEST(PrintBatches, AreCountedWhereHalvesOfTheRecordingAreCompared) {
  const Printed printed(second_half_larger);
  const CalibrationResult result = test::calibrate(printed.stated, printed.frames, {.cross_validate = true});
  ASSERT_TRUE(result.print_batches);
  ASSERT_EQ(result.cross_validation->why_not, "");
  EXPECT_LT(result.cross_validation->normalised_error_squared, 1.5);
  EXPECT_GT(result.cross_validation->normalised_error_squared, 0.3);
}

TEST(PrintBatches, AreToldAndCountedWhicheverIsAsStated) {
  const auto first_half_smaller = [](int tag) { return tag < kPrintedTags / 2 ? -0.015 : 0.0; };
  for (const std::function<double(int)>& larger_by :
       {std::function<double(int)>(second_half_larger), std::function<double(int)>(first_half_smaller)}) {
    const Printed printed(larger_by);
    const CalibrationResult result = test::calibrate(printed.stated, printed.frames);
    ASSERT_TRUE(result.print_batches);
    EXPECT_THAT(
        result.warnings,
        Contains(AllOf(HasSubstr("tag36h11/13, tag36h11/15, tag36h11/17, tag36h11/19, tag36h11/21 are 1."),
                       HasSubstr("state both: the map"))));
    const double error = test::mean_normalised_error(printed.truth, result);
    EXPECT_LT(error, 2.0);
    EXPECT_GT(error, 0.05) << "claims far less than it knows";
  }
}

// Where all tags are odd a move of 4 cm is none that is told; its views are rejected.
TEST(PrintBatches, AreToldWhereATagMovedAsWell) {
  const Printed printed(second_half_larger, 0.05);
  SyntheticWorld moved = printed.truth;
  MapTag& tag = moved.map.tags[2];
  tag.T_map_tag =
      Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(0.0, 0.0, 0.04)) * tag.T_map_tag;
  std::vector<FrameDetections> frames = printed.frames, after = test::exact_detections(moved);
  RandomStream random(9);
  test::add_edge_noise(after, 0.05, -0.45, random);
  for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) frames[i] = after[i];
  const CalibrationResult result = test::calibrate(printed.stated, frames);
  EXPECT_TRUE(result.print_batches);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("rejected of tag36h11/7")));
}

TEST(PrintBatches, AreNotToldOfTagsAsStated) {
  const Printed printed([](int) { return 0.0; });
  const CalibrationResult result = test::calibrate(printed.stated, printed.frames);
  EXPECT_FALSE(result.print_batches);
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("two prints"))));
}

TEST(PrintBatches, AreInDoubtWhereADistanceContradictsTheMap) {
  const Printed printed(second_half_larger);
  CalibrationOptions options;
  options.corner_bias_px = 0.0;
  options.constraints = {test::false_distance(printed.truth)};
  const std::string message =
      test::error_of(ErrorKind::kNoResult, [&] { test::calibrate(printed.stated, printed.frames, options); });
  EXPECT_THAT(message, HasSubstr("the tags look like two prints of different size"));
}

}  // namespace
}  // namespace apriltrack
