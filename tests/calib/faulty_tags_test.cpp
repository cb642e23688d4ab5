// Tags that are faulty are taken out of the map, and no others: on one adjusted world each.

#include "hypotheses/faulty_tags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "adjusted_world.h"
#include "apriltrack/base/degrees.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "hypotheses/tag_hypotheses.h"
#include "model/tag_links.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::SyntheticWorld;
using ::testing::IsEmpty;
using Kind = TagFinding::Kind;

constexpr int kFaulty = 11, kBesideIt = 13;  // ids of a room: 3, 5, 7 and so on
constexpr double kNoise_px = 0.1;

/// Where a corner of the faulty tag is in its own frame, by the number of the frame.
using Moved = std::function<Eigen::Vector3d(Eigen::Vector3d, std::size_t)>;

std::vector<TagFinding> findings_of(AdjustedWorld one) {
  leave_out_faulty_tags(one.task(), one.offered, {}, one.solved, parallel_for(1));
  return one.solved.findings;
}

/// The one that is found, of the faulty tag.
std::optional<TagFinding> finding_of(const AdjustedWorld& one) {
  const std::vector<TagFinding> findings = findings_of(one);
  EXPECT_LE(findings.size(), 1u);
  if (findings.empty()) return std::nullopt;
  EXPECT_EQ(findings.front().tag, one.index_of(kFaulty));
  EXPECT_EQ(findings.front().blame, TagFinding::Blame::kThisTag);
  return findings.front();
}

void add_noise(std::uint64_t seed, std::vector<FrameDetections>& frames, double noise_px = kNoise_px) {
  RandomStream random(seed);
  test::add_edge_noise(frames, noise_px, -0.45, random);
}

/// Each frame shows two tags alone, which are others from frame to frame: of two tags that disagree either
/// may be wrong.
void show_pairs(std::vector<FrameDetections>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    auto& detections = frames[i].detections;
    std::ranges::sort(detections, {},
                      [&](const Detection& one) { return (static_cast<std::size_t>(one.tag.id) + i) % 9; });
    if (detections.size() > 2) detections.resize(2);
  }
}

AdjustedWorld filmed_in_pairs(const Moved& moved, std::uint64_t seed) {
  const SyntheticWorld world = test::make_room(9, 120, test::equidistant_camera());
  std::vector<FrameDetections> frames = test::filmed_with(world, kFaulty, moved);
  show_pairs(frames);
  add_noise(seed, frames);
  return {world, frames};
}

SyntheticWorld sound_room() {
  return test::make_room(10, 80, test::perspective_camera());
}

AdjustedWorld filmed_together(const Moved& moved, std::uint64_t seed = 5) {
  const SyntheticWorld world = sound_room();
  std::vector<FrameDetections> frames = test::filmed_with(world, kFaulty, moved);
  add_noise(seed, frames);
  return {world, frames, {.corner_bias_px = 0.02}};
}

/// About an axis of the tag: x right, y down, z into it.
Eigen::Vector3d turned(const Eigen::Vector3d& corner, int axis, double degrees) {
  return Eigen::AngleAxisd(degrees * kRadPerDeg, Eigen::Vector3d::Unit(axis)) * corner;
}

const Moved kSound = [](const Eigen::Vector3d& corner, std::size_t) { return corner; };

TEST(FaultyTags, AreNoneWhereNothingIsWrong) {
  for (std::uint64_t seed = 70; seed < 90; ++seed) {
    EXPECT_THAT(findings_of(filmed_in_pairs(kSound, seed)), IsEmpty()) << seed;
    EXPECT_THAT(findings_of(filmed_together(kSound, seed)), IsEmpty()) << seed;
  }
}

TEST(FaultyTags, AreNoneWhereCornersKeepTheErrorsThatAreExpected) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SyntheticWorld world = sound_room();
    std::vector<FrameDetections> frames = test::exact_detections(world);
    RandomStream random(seed);
    test::add_edge_noise(frames, 0.2, -0.45, random);
    test::add_edge_biases(frames, 0.05, -0.45, random);
    EXPECT_THAT(findings_of({world, frames}), IsEmpty()) << seed;
  }
}

TEST(FaultyTags, ThatWereMovedAreFoundInPairs) {
  const auto finding = finding_of(filmed_in_pairs(
      [](const Eigen::Vector3d& corner, std::size_t i) {
        return Eigen::Vector3d(corner + Eigen::Vector3d(i < 50 ? 0.0 : 0.15, 0.0, 0.0));
      },
      61));
  ASSERT_TRUE(finding && finding->places);
  EXPECT_EQ(finding->kind, Kind::kMoved);
  EXPECT_TRUE(finding->is_left_out);
  EXPECT_TRUE(finding->places->is_one_after_other);
  EXPECT_NEAR(finding->places->T_first_second.translation().norm(), 0.15, 0.01);
}

TEST(FaultyTags, ThatWereTurnedAreFoundInPairs) {
  const auto finding = finding_of(filmed_in_pairs(
      [](const Eigen::Vector3d& corner, std::size_t i) { return turned(corner, 1, i < 60 ? 0.0 : 8.0); },
      61));
  ASSERT_TRUE(finding && finding->places);
  EXPECT_EQ(finding->kind, Kind::kMoved);
  EXPECT_NEAR(rotation_angle_rad(finding->places->T_first_second.rotation(), Eigen::Quaterniond::Identity()),
              8.0 * kRadPerDeg, 1.0 * kRadPerDeg);
}

/// By so little that the noise which the move itself makes would explain it.
TEST(FaultyTags, ThatWereTurnedALittleAreFoundInPairs) {
  for (std::uint64_t seed = 61; seed < 65; ++seed) {
    const auto finding = finding_of(filmed_in_pairs(
        [](const Eigen::Vector3d& corner, std::size_t i) { return turned(corner, 2, i < 60 ? 0.0 : 3.0); },
        seed));
    ASSERT_TRUE(finding) << seed;
    EXPECT_EQ(finding->kind, Kind::kMoved) << seed;
  }
}

TEST(FaultyTags, ThatHangLooselyAreFoundInPairs) {
  for (const auto& [degrees, per_frame] : {std::pair(10.0, 0.31), std::pair(5.0, 0.9)}) {
    const auto finding = finding_of(filmed_in_pairs(
        [&](const Eigen::Vector3d& corner, std::size_t i) {
          return turned(corner, 0, degrees * std::sin(per_frame * static_cast<double>(i)));
        },
        62));
    ASSERT_TRUE(finding) << degrees;
    EXPECT_EQ(finding->kind, Kind::kLoose) << degrees;
  }
}

TEST(FaultyTags, ThatAreTwoByTurnsAreFoundInPairs) {
  const auto finding = finding_of(filmed_in_pairs(
      [](const Eigen::Vector3d& corner, std::size_t i) {
        return Eigen::Vector3d(corner + Eigen::Vector3d(i % 24 < 16 ? 0.0 : 0.6, 0.0, 0.0));
      },
      61));
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->kind, Kind::kTwoPlaces);
}

TEST(FaultyTags, OfAWrongSizeAreFoundInPairs) {
  const auto finding = finding_of(filmed_in_pairs(
      [](const Eigen::Vector3d& corner, std::size_t) { return Eigen::Vector3d(1.12 * corner); }, 61));
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->kind, Kind::kSize);
  EXPECT_NEAR(std::exp(finding->log_scale()), 1.12, 0.01);
}

/// Once it had moved it was seen with one other tag alone, and that one with it alone: it may be the other
/// that moved.
TEST(FaultyTags, AreBothWhereEitherWouldDo) {
  const SyntheticWorld world = test::make_room(9, 120, test::equidistant_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  show_pairs(frames);
  const auto shifted = [](const Eigen::Vector3d& corner, std::size_t) {
    return Eigen::Vector3d(corner + Eigen::Vector3d(0.15, 0.0, 0.0));
  };
  for (FrameDetections& later : test::filmed_with(world, kFaulty, shifted)) {
    std::erase_if(later.detections,
                  [](const Detection& one) { return one.tag.id != kFaulty && one.tag.id != kBesideIt; });
    later.timestamp.ns += 100'000'000'000;
    frames.push_back(later);
  }
  add_noise(62, frames);
  const AdjustedWorld one(world, frames);
  const std::vector<TagFinding> findings = findings_of(one);
  ASSERT_EQ(findings.size(), 2u);
  std::vector<int> tags;
  for (const TagFinding& finding : findings) {
    EXPECT_EQ(finding.blame, TagFinding::Blame::kThisOrAnother);
    tags.push_back(finding.tag);
  }
  EXPECT_THAT(tags, ::testing::UnorderedElementsAre(one.index_of(kFaulty), one.index_of(kBesideIt)));
}

TEST(FaultyTags, HaveTheSizeThatIsFound) {
  for (const double factor : {1.015, 0.98}) {
    const auto finding = finding_of(filmed_together(
        [&](const Eigen::Vector3d& corner, std::size_t) { return Eigen::Vector3d(factor * corner); }));
    ASSERT_TRUE(finding) << factor;
    EXPECT_EQ(finding->kind, Kind::kSize);
    EXPECT_TRUE(finding->is_left_out);
    EXPECT_NEAR(std::exp(finding->log_scale()), factor, 0.0035);
  }
}

TEST(FaultyTags, ThatAreNotSquareAreBentAndStay) {
  const auto finding = finding_of(filmed_together([](Eigen::Vector3d corner, std::size_t) {
    corner.x() *= 0.98;
    return corner;
  }));
  ASSERT_TRUE(finding && finding->shape);
  EXPECT_EQ(finding->kind, Kind::kNotFlat);
  EXPECT_FALSE(finding->is_left_out);
  EXPECT_TRUE(finding->shape->is_aspect_clear);
  EXPECT_NEAR(finding->shape->aspect, -0.02, 0.0045);
}

TEST(FaultyTags, ThatAreTwistedAreBentAndStay) {
  const double lift_m = 0.0024;
  const auto finding = finding_of(filmed_together([&](Eigen::Vector3d corner, std::size_t) {
    corner.z() += (corner.x() > 0.0) == (corner.y() > 0.0) ? lift_m : -lift_m;
    return corner;
  }));
  ASSERT_TRUE(finding && finding->shape);
  EXPECT_EQ(finding->kind, Kind::kNotFlat);
  EXPECT_TRUE(finding->shape->is_twist_clear);
  EXPECT_NEAR(std::abs(finding->shape->twist) * finding->shape->size_m, lift_m, 0.0004);
}

/// Three tags side by side on a wall, and a camera that looks at them from many sides.
SyntheticWorld wall() {
  SyntheticWorld world;
  for (const double x_m : {-0.5, 0.0, 0.5})
    test::add_tag(world, 0.2, test::looking_along({x_m, 0.0, 0.1 * x_m}, {0.0, 1.0, 0.0}));
  world.rig.cameras.push_back(test::perspective_camera());
  for (int k = 0; k < 60; ++k) {
    const Eigen::Vector3d from(1.2 * std::cos(0.7 * k), -1.6 - 0.4 * std::cos(0.9 * k), std::sin(1.1 * k));
    world.T_world_rig.push_back(test::looking_along(from, -from));
  }
  return world;
}

// What a lens that is not known well leaves: none of a few tags is as stated.
TEST(FaultyTags, AreNoneOfThreeWhereNoneIsAsStated) {
  for (const auto& shares : {std::array{0.0, -0.008, 0.008}, std::array{0.0, -0.004, 0.012}}) {
    SyntheticWorld printed = wall();
    for (std::size_t i = 0; i < shares.size(); ++i) printed.map.tags[i].size_m *= 1.0 + shares[i];
    std::vector<FrameDetections> frames = test::exact_detections(printed);
    add_noise(3, frames, 0.05);
    EXPECT_THAT(findings_of({wall(), frames}), IsEmpty());
  }
}

TEST(FaultyTags, AreNoneWhereManyAreOdd) {
  SyntheticWorld printed = sound_room();
  for (std::size_t i = 0; i < printed.map.tags.size(); ++i)
    printed.map.tags[i].size_m *= i % 2 == 0 ? 0.98 : 1.02;
  std::vector<FrameDetections> frames = test::exact_detections(printed);
  add_noise(3, frames);
  EXPECT_THAT(findings_of({sound_room(), frames}), IsEmpty());
}

/// All poses but the held tag's, and parameters of one tag with a prior, in one dense system.
double log_odds_by_brute_force(const RobustMap& map, const std::vector<ParameterView>& columns, int held_tag,
                               const Eigen::VectorXd& prior_sigma) {
  std::map<int, Eigen::Index> frames, tags;
  for (const LinearView& view : map.views) {
    frames.try_emplace(view.frame, 6 * static_cast<Eigen::Index>(frames.size()));
    if (view.tag != held_tag) tags.try_emplace(view.tag, 6 * static_cast<Eigen::Index>(tags.size()));
  }
  const auto tags_at = 6 * static_cast<Eigen::Index>(frames.size());
  const auto poses = tags_at + 6 * static_cast<Eigen::Index>(tags.size());
  const auto rows = 8 * static_cast<Eigen::Index>(map.views.size());
  Eigen::MatrixXd by_pose = Eigen::MatrixXd::Zero(rows, poses);
  Eigen::MatrixXd by_parameter = Eigen::MatrixXd::Zero(rows, prior_sigma.size());
  Eigen::VectorXd residual(rows);
  for (std::size_t v = 0; v < map.views.size(); ++v) {
    const auto row = 8 * static_cast<Eigen::Index>(v);
    residual.segment<8>(row) = map.views[v].residual;
    by_pose.block<8, 6>(row, frames.at(map.views[v].frame)) = map.views[v].by_rig;
    if (const auto tag = tags.find(map.views[v].tag); tag != tags.end())
      by_pose.block<8, 6>(row, tags_at + tag->second) = map.views[v].by_tag;
  }
  for (const ParameterView& one : columns)
    by_parameter.block(8 * static_cast<Eigen::Index>(one.view), one.first, 8, one.by_parameter.cols()) =
        one.by_parameter;
  // What no pose explains, is normal: of unit variance, or with the parameters' share beside.
  const Eigen::MatrixXd Q = by_pose.householderQr().householderQ();
  const Eigen::MatrixXd rest = Q.rightCols(rows - poses).transpose();
  const Eigen::VectorXd r = rest * residual;
  const Eigen::MatrixXd by_prior = rest * by_parameter * prior_sigma.asDiagonal();
  const Eigen::MatrixXd covariance =
      Eigen::MatrixXd::Identity(rows - poses, rows - poses) + by_prior * by_prior.transpose();
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  return 0.5 * (r.squaredNorm() - r.dot(factor.solve(r))) - factor.matrixLLT().diagonal().array().log().sum();
}

TEST(Evidence, IsTheRatioOfTheViewsDensities) {
  const SyntheticWorld world = test::make_room(6, 24, test::equidistant_camera());
  std::vector<FrameDetections> frames =
      test::filmed_with(world, kFaulty, [](const Eigen::Vector3d& corner, std::size_t i) {
        return Eigen::Vector3d(corner + Eigen::Vector3d(i < 12 ? 0.0 : 0.004, 0.0, 0.0));
      });
  add_noise(5, frames, 0.2);
  const AdjustedWorld one(world, frames);
  const PartTask task = one.task();
  RobustMap map(task, one.offered, one.solved.held_tag, one.solved.state);
  ASSERT_TRUE(map.poses);
  std::vector<ParameterView> later;  // the tag at another place, from its fourth view on
  for (const std::size_t i : map.views_of(one.index_of(kFaulty))) later.push_back({i, map.views[i].by_tag});
  later.erase(later.begin(), later.begin() + 3);
  Vector6d sigma;
  sigma << 0.01, 0.01, 0.01, 0.05, 0.05, 0.05;
  const Evidence evidence =
      evidence_of(Score(map.poses->eliminate_poses(later)),
                  NullScale{.of_most = {.noise_variance = 1.0, .bias_variance = 0.0}}, sigma, -2.0);
  EXPECT_NEAR(evidence.log_odds + 2.0, log_odds_by_brute_force(map, later, one.solved.held_tag, sigma), 1e-4);
}

/// A row of tags a metre apart, each seen with the next two. Tag 0 hangs before the first, and once more
/// before the last, so that the tree folds the row.
TEST(SupportFreedByTags, IsMostByTheTagThatHangsTwice) {
  constexpr int kNum = 12;
  const auto at = [](int tag) {
    return Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), {1.0 * tag, 0, 0});
  };
  std::vector<TagLink> links;
  for (int tag = 1; tag < kNum; ++tag)
    for (const int next : {tag + 1, tag + 2})
      if (next < kNum) links.push_back({tag, next, at(next - tag), 10.0});
  for (const auto& [tag, distance] :
       {std::pair(1, 1), std::pair(2, 2), std::pair(kNum - 2, 1), std::pair(kNum - 1, 2)})
    links.push_back({0, tag, at(distance), 20.0});
  const auto freed = support_freed_by_tags(kNum, links);
  ASSERT_FALSE(freed.empty());
  EXPECT_EQ(freed.front().second, 0);
  if (freed.size() > 1) {
    EXPECT_LT(freed[1].first, 0.5 * freed.front().first);
  }
}

}  // namespace
}  // namespace apriltrack
