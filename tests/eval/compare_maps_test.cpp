#include "apriltrack/eval/compare_maps.h"

#include <gmock/gmock.h>

#include <cmath>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/alignment.h"
#include "apriltrack/eval/combine_maps.h"
#include "eval/synthetic.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TagMap room(int num_tags = 12) {
  TagMap map;
  RandomStream random(5);
  for (int id = 0; id < num_tags; ++id) {
    map.tags.push_back(test::tag_at(id, Pose::exp(test::normal_vector(random, 1.0))));
    if (num_tags > 587) map.tags.back().key.family = "tagStandard52h13";  // one with so many ids
  }
  return map;
}

TagMap moved(TagMap map, const Pose& motion) {
  for (MapTag& tag : map.tags) tag.T_map_tag = motion * tag.T_map_tag;
  return map;
}

Pose some_motion() {
  Vector6d xi;
  xi << 3, -1, 2, 0.4, -1.2, 2.0;
  return Pose::exp(xi);
}

TEST(Alignment, RecoversAMotionFromPositionsOfAPlane) {  // where a mirror image fits as well
  std::vector<Pose> reference;
  std::vector<Pose> estimate;
  RandomStream random(1);
  for (int i = 0; i < 10; ++i) {
    reference.emplace_back(Eigen::Quaterniond::Identity(),
                           Eigen::Vector3d{random.normal(), random.normal(), 0.5});
    estimate.push_back(some_motion().inverse() * reference.back());
  }
  EXPECT_THAT(align_rigidly(reference, estimate, 0.0).value(), test::PoseNear(some_motion(), 1e-13, 1e-13));
}

TEST(Alignment, IsTheLeastSquaresMotion) {
  std::vector<Pose> reference;
  std::vector<Pose> estimate;
  RandomStream random(2);
  for (int i = 0; i < 20; ++i) {
    reference.push_back(Pose::exp(test::normal_vector(random, 1.0)));
    estimate.push_back(some_motion().inverse() * reference.back() *
                       Pose::exp(test::normal_vector(random, 0.05)));
  }
  const auto cost = [&](const Pose& motion) {
    double sum = 0.0;
    for (std::size_t i = 0; i < reference.size(); ++i)
      sum += (reference[i].translation() - motion * estimate[i].translation()).squaredNorm();
    return sum;
  };
  const Pose best = align_rigidly(reference, estimate, 0.0).value();
  for (int i = 0; i < 6; ++i) {  // no neighbour does better
    EXPECT_GT(cost(best * Pose::exp(1e-3 * Vector6d::Unit(i))), cost(best));
    EXPECT_GT(cost(best * Pose::exp(-1e-3 * Vector6d::Unit(i))), cost(best));
  }
}

TEST(Alignment, PositionsOnALineNeedOrientations) {
  std::vector<Pose> reference;
  std::vector<Pose> estimate;
  for (int i = 0; i < 4; ++i) {
    reference.emplace_back(Eigen::Quaterniond(0.8, 0, 0.6, 0), Eigen::Vector3d(i, 2.0 * i, 0));
    estimate.push_back(some_motion().inverse() * reference.back());
  }
  EXPECT_FALSE(align_rigidly(reference, estimate, 0.0).has_value());
  EXPECT_THAT(align_rigidly(reference, estimate, kMapOrientationWeight).value(),
              test::PoseNear(some_motion(), 1e-12, 1e-12));
}

TEST(CompareMaps, AMovedMapIsTheSameMap) {
  const MapComparison comparison = compare_maps(room(), moved(room(), some_motion()));
  EXPECT_EQ(comparison.tags.size(), 12u);
  EXPECT_LT(comparison.position_m.max, 1e-14);
  EXPECT_LT(comparison.rotation_rad.max, 1e-14);
  EXPECT_NEAR(*comparison.scale, 1.0, 1e-14);
  EXPECT_THAT(comparison.T_truth_estimate, test::PoseNear(some_motion().inverse(), 1e-13, 1e-13));
}

TEST(CompareMaps, OneTagAloneIsAlignedByItsOrientation) {
  const MapComparison comparison = compare_maps(room(1), moved(room(1), some_motion()));
  EXPECT_LT(comparison.position_m.max, 1e-14);
  EXPECT_LT(comparison.rotation_rad.max, 1e-14);
  EXPECT_FALSE(comparison.scale.has_value());
}

TEST(CompareMaps, FindsScaleTurnAndTheTagThatMoved) {
  TagMap scaled = room();
  for (MapTag& tag : scaled.tags)
    tag.T_map_tag = Pose(tag.T_map_tag.rotation(), 1.01 * tag.T_map_tag.translation());
  EXPECT_NEAR(*compare_maps(room(), scaled).scale, 1.01, 1e-12);

  TagMap turned = room();
  turned.tags[3].T_map_tag = turned.tags[3].T_map_tag * Pose::exp(0.2 * Vector6d::Unit(5));
  const MapComparison after_turn = compare_maps(room(), turned);
  EXPECT_NEAR(after_turn.tags[3].rotation_rad, 0.2, 2e-3);  // 0.01 of the weight lies on orientations
  EXPECT_NEAR(after_turn.rotation_rad.max, after_turn.tags[3].rotation_rad, 0.0);

  TagMap carried = room(200);
  carried.tags[7].T_map_tag = Pose(carried.tags[7].T_map_tag.rotation(),
                                   carried.tags[7].T_map_tag.translation() + Eigen::Vector3d(0.1, 0, 0));
  const MapComparison after_carry = compare_maps(room(200), carried);
  EXPECT_EQ(after_carry.worst, 7u);
  EXPECT_NEAR(after_carry.tags[7].offset_m.x(), 0.1, 0.003);  // the mean takes 1/200, the rotation as little
}

TEST(CompareMaps, NamesMissingExtraAndOtherSizes) {
  TagMap estimate = room();
  estimate.tags.erase(estimate.tags.begin() + 4);
  estimate.tags[0].size_m += 0.001;
  estimate.tags.push_back(test::tag_at(77, Pose()));
  estimate.tags.push_back(test::tag_at(5, Pose()));
  estimate.tags.back().key.family = "tag25h9";  // the same id of another family is another tag
  const MapComparison comparison = compare_maps(room(), estimate);
  EXPECT_THAT(comparison.missing, ElementsAre(TagKey{"tag36h11", 4}));
  EXPECT_THAT(comparison.extra, ElementsAre(TagKey{"tag25h9", 5}, TagKey{"tag36h11", 77}));
  EXPECT_EQ(comparison.tags.size(), 11u);
  EXPECT_NEAR(comparison.tags[0].size_difference_m, 0.001, 1e-15);
}

TEST(CompareMaps, RefusesMapsWithoutACommonTag) {
  TagMap other;
  other.tags.push_back(test::tag_at(99, Pose()));
  EXPECT_THROW(compare_maps(room(), other), Error);
}

/// Every tag but the first off by a draw from its own covariance; the first is held.
TagMap noisy_estimate(const TagMap& truth, double spread) {
  RandomStream random(11);
  TagMap estimate = truth;
  estimate.tags[0].covariance = Matrix6d::Zero();
  for (std::size_t i = 1; i < estimate.tags.size(); ++i) {
    MapTag& tag = estimate.tags[i];
    tag.covariance = test::random_covariance(random, 1e-3);
    tag.T_map_tag = tag.T_map_tag * Pose::exp(spread * test::sample(random, *tag.covariance)).inverse();
  }
  return estimate;
}

TEST(CompareMaps, AnHonestCovarianceScoresOneAndABoastfulOneFour) {
  const TagMap truth = room(3000);  // the mean over 6 scatters by sqrt(2/6/3000) = 0.011
  for (const double spread : {1.0, 2.0}) {
    const MapComparison comparison = compare_maps(truth, moved(noisy_estimate(truth, spread), some_motion()));
    ASSERT_TRUE(comparison.nees_over_6 && comparison.held_tag);
    EXPECT_EQ(comparison.held_tag->id, 0);
    EXPECT_NEAR(comparison.nees_over_6->mean, spread * spread, 0.05 * spread * spread);
    EXPECT_NEAR(comparison.nees_over_6->median, spread * spread * 5.3481 / 6.0, 0.06 * spread * spread);
    EXPECT_FALSE(comparison.tags[0].nees_over_6.has_value());
  }
}

TEST(CompareMaps, JudgesNoCovarianceUnlessOneTagIsHeld) {
  TagMap estimate = noisy_estimate(room(), 1.0);
  estimate.tags[1].covariance = Matrix6d::Zero();
  EXPECT_FALSE(compare_maps(room(), estimate).nees_over_6.has_value());
}

TEST(AlignMap, BringsAMapIntoAnothersFrame) {
  TagMap map = moved(noisy_estimate(room(), 0.0), some_motion());
  map.frame = "elsewhere";
  const AlignedMap aligned = align_map(room(), map);
  EXPECT_EQ(aligned.map.frame, "world");
  EXPECT_EQ(aligned.common_tags, 12);
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    EXPECT_THAT(aligned.map.tags[i].T_map_tag, test::PoseNear(room().tags[i].T_map_tag, 1e-13, 1e-13));
    EXPECT_EQ(*aligned.map.tags[i].covariance, *map.tags[i].covariance);
  }
}

TagMap part(const TagMap& map, std::size_t from, std::size_t to) {
  TagMap out = map;
  out.tags = {map.tags.begin() + static_cast<std::ptrdiff_t>(from),
              map.tags.begin() + static_cast<std::ptrdiff_t>(to)};
  return out;
}

TEST(MergeMaps, JoinsTwoHalvesOverTheirCommonTags) {
  const TagMap whole = room();
  const MergedMap merged = merge_maps(part(whole, 0, 7), moved(part(whole, 5, 12), some_motion()));
  EXPECT_EQ(merged.common_tags, 2);
  EXPECT_EQ(merged.added.size(), 5u);
  EXPECT_TRUE(merged.conflicts.empty());
  ASSERT_EQ(merged.map.tags.size(), 12u);
  for (const MapTag& tag : merged.map.tags)
    EXPECT_THAT(tag.T_map_tag, test::PoseNear(whole.find(tag.key)->T_map_tag, 1e-12, 1e-12));
}

TEST(MergeMaps, ReportsTagsThatDisagreeAndKeepsTheBase) {
  TagMap addition = room();
  addition.tags[2].T_map_tag = Pose(addition.tags[2].T_map_tag.rotation(),
                                    addition.tags[2].T_map_tag.translation() + Eigen::Vector3d(0, 0.05, 0));
  const MergedMap merged = merge_maps(room(), addition);
  ASSERT_EQ(merged.conflicts.size(), 1u);
  EXPECT_EQ(merged.conflicts[0].key.id, 2);
  EXPECT_THAT(merged.map.tags[2].T_map_tag, test::PoseNear(room().tags[2].T_map_tag, 0.0, 1e-15));
}

TEST(MergeMaps, KeepsCovariancesOnlyOfTheSameGauge) {
  const TagMap whole = noisy_estimate(room(), 0.0);
  EXPECT_TRUE(merge_maps(part(whole, 0, 5), whole).without_covariance.empty());
  const MergedMap merged = merge_maps(part(whole, 0, 5), part(whole, 1, 12));
  EXPECT_EQ(merged.without_covariance.size(), 7u);
  for (const TagKey& key : merged.without_covariance)
    EXPECT_FALSE(merged.map.find(key)->covariance.has_value());
}

TEST(MergeMaps, RefusesATagWithTwoSizes) {
  TagMap addition = room();
  addition.tags[1].size_m = 0.3;
  try {
    merge_maps(room(), addition);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    EXPECT_THAT(error.what(), HasSubstr("tag36h11/1: size: is 0.2 m in one map and 0.3 m in the other"));
  }
}

}  // namespace
}  // namespace apriltrack
