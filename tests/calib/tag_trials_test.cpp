// Faults for which the fit gave up frames of two tags, so that either seems at fault.
#include "faults/tag_trials.h"

#include <gmock/gmock.h>

#include "adjusted_world.h"
#include "faults/tag_neighbourhoods.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::SyntheticWorld;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kTagOnTrial = 11, kBesideIt = 13;  // ids of a room: 3, 5, 7 and so on
constexpr int kIndexOnTrial = 4, kIndexBesideIt = 5, kTagsOnWalls = 7;
constexpr std::size_t kFramesOnTrial = 80;

using WhereCornersAre = std::function<Eigen::Vector3d(const Eigen::Vector3d&, std::size_t)>;

/// Frames show the two tags that come next in turn, with a noise of 0.1 px.
std::vector<FrameDetections> shown_in_pairs(std::vector<FrameDetections> frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    auto& detections = frames[i].detections;
    std::ranges::sort(detections, {}, [&](const Detection& one) {
      return (static_cast<std::size_t>(one.tag.id) + i) % static_cast<std::size_t>(kTagsOnWalls);
    });
    if (detections.size() > 2) detections.resize(2);
  }
  RandomStream random(61);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  return frames;
}

SyntheticWorld room_of_pairs() {
  return test::make_room(kTagsOnWalls, static_cast<int>(kFramesOnTrial), test::equidistant_camera());
}

/// That explain most.
std::vector<TagFinding> find_on_trial(const AdjustedWorld& one) {
  const auto alternatives = find_faults_by_trial(one.task(), one.offered, one.solved, parallel_for(1));
  return alternatives.empty() ? std::vector<TagFinding>{} : alternatives.front();
}

std::vector<TagFinding> find_where_pairs_show(const WhereCornersAre& where) {
  const SyntheticWorld world = room_of_pairs();
  return find_on_trial({world, shown_in_pairs(test::filmed_with(world, kTagOnTrial, where))});
}

TEST(TagTrials, FindNothingWhereNothingIsWrong) {
  EXPECT_THAT(find_where_pairs_show([](const Eigen::Vector3d& corner, std::size_t) { return corner; }),
              IsEmpty());
}

TEST(TagTrials, NameATagThatMoved) {
  const auto findings = find_where_pairs_show([](const Eigen::Vector3d& corner, std::size_t i) {
    return Eigen::Vector3d(corner + Eigen::Vector3d(i < 33 ? 0.0 : 0.15, 0.0, 0.0));
  });
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].tag, kIndexOnTrial);
  EXPECT_EQ(findings[0].kind, TagFinding::Kind::kMoved);
  EXPECT_TRUE(findings[0].is_left_out);
  ASSERT_TRUE(findings[0].places);
  EXPECT_NEAR(findings[0].places->T_first_second.translation().norm(), 0.15, 0.01);
}

// Two places explain most of its views, but at the second it trembles.
TEST(TagTrials, NameATagThatMovedAndHangsLooselySince) {
  const auto findings = find_where_pairs_show([](const Eigen::Vector3d& corner, std::size_t i) {
    const double angle_rad = i < 33 ? 0.0 : 0.09 * std::sin(0.35 * static_cast<double>(i));
    const Eigen::AngleAxisd turn(angle_rad, Eigen::Vector3d::UnitX());
    return Eigen::Vector3d(turn * corner + Eigen::Vector3d(i < 33 ? 0.0 : 0.15, 0.0, 0.0));
  });
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].tag, kIndexOnTrial);
  EXPECT_EQ(findings[0].kind, TagFinding::Kind::kLoose);
}

TEST(TagTrials, TellATagThatMovedOnceFromALooseOne) {
  const auto kind_of = [](const WhereCornersAre& where) {
    const SyntheticWorld world = room_of_pairs();
    const AdjustedWorld one(world, shown_in_pairs(test::filmed_with(world, kTagOnTrial, where)));
    TagFinding loose;
    loose.tag = kIndexOnTrial;
    loose.kind = TagFinding::Kind::kLoose;
    return places_or_loose(one.task(), one.offered, one.solved, loose).kind;
  };
  const auto turned_by = [](const Eigen::Vector3d& corner, double angle_rad) {
    return Eigen::Vector3d(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitX()) * corner);
  };
  EXPECT_EQ(kind_of([&](const auto& corner, std::size_t i) { return turned_by(corner, i < 33 ? 0.0 : 0.3); }),
            TagFinding::Kind::kMoved);
  EXPECT_EQ(kind_of([&](const auto& corner, std::size_t i) {
              return turned_by(corner, 0.3 * std::sin(0.7 * static_cast<double>(i)));
            }),
            TagFinding::Kind::kLoose);
}

TEST(TagTrials, NameAnIdThatHangsInTwoPlacesByTurns) {
  const auto findings = find_where_pairs_show([](const Eigen::Vector3d& corner, std::size_t i) {
    return Eigen::Vector3d(corner + Eigen::Vector3d(i % 24 < 16 ? 0.0 : 0.6, 0.0, 0.0));
  });
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].tag, kIndexOnTrial);
  EXPECT_EQ(findings[0].kind, TagFinding::Kind::kTwoPlaces);
}

TEST(TagTrials, NameAWrongSize) {
  const auto findings = find_where_pairs_show(
      [](const Eigen::Vector3d& corner, std::size_t) { return Eigen::Vector3d(1.12 * corner); });
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].tag, kIndexOnTrial);
  EXPECT_EQ(findings[0].kind, TagFinding::Kind::kSize);
  EXPECT_NEAR(std::exp(findings[0].log_scale()), 1.12, 0.01);
}

// Seen with one other tag alone once it had moved, and that one with it alone: it may be the other that
// moved.
TEST(TagTrials, NameBothWhereEitherWouldDo) {
  const SyntheticWorld world = room_of_pairs();
  std::vector<FrameDetections> frames = test::exact_detections(world);
  const auto shifted = [](const Eigen::Vector3d& corner, std::size_t) {
    return Eigen::Vector3d(corner + Eigen::Vector3d(0.15, 0.0, 0.0));
  };
  for (FrameDetections& later : test::filmed_with(world, kTagOnTrial, shifted)) {
    std::erase_if(later.detections,
                  [](const Detection& one) { return one.tag.id != kTagOnTrial && one.tag.id != kBesideIt; });
    later.timestamp.ns += 100'000'000'000;
    frames.push_back(later);
  }
  RandomStream random(62);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  const auto findings = find_on_trial({world, frames});
  ASSERT_EQ(findings.size(), 2u);
  for (const TagFinding& finding : findings) EXPECT_EQ(finding.blame, TagFinding::Blame::kThisOrAnother);
  std::vector<int> tags{findings[0].tag, findings[1].tag};
  std::ranges::sort(tags);
  EXPECT_THAT(tags, ElementsAre(kIndexOnTrial, kIndexBesideIt));
}

// Seen only beside a tag that frames of others tell of: nothing is left to try it on.
TEST(TagNeighbourhoods, OfATagThatIsNotThereAreEmpty) {
  const AdjustedWorld one(test::make_room(kTagsOnWalls, 300, test::equidistant_camera()));
  Part without = narrowed_to(one.observations, one.offered, {0, 1, 2, 4, 5, 6});
  const TagNeighbourhoods neighbourhoods(one.observations, without, 100);
  ASSERT_FALSE(neighbourhoods.are_all_one());
  EXPECT_THAT(neighbourhoods.around(3).views, IsEmpty());
}

TEST(TagNeighbourhoods, AreTheWholeOfASmallPart) {
  const AdjustedWorld one(room_of_pairs());
  const TagNeighbourhoods neighbourhoods(one.observations, one.offered, 250);
  EXPECT_TRUE(neighbourhoods.are_all_one());
  EXPECT_EQ(neighbourhoods.around(3).views, one.offered.views);
}

TEST(TagNeighbourhoods, OfALongRecordingAreSomeFramesOfEachTag) {
  const SyntheticWorld world = test::make_room(kTagsOnWalls, 900, test::equidistant_camera());
  const AdjustedWorld one(world);
  const TagNeighbourhoods neighbourhoods(one.observations, one.offered, 250);
  ASSERT_FALSE(neighbourhoods.are_all_one());
  const Part part = neighbourhoods.around(3);
  std::set<int> frames, with_tag;
  for (const std::size_t v : part.views) {
    frames.insert(one.observations.views[v].frame);
    if (one.observations.views[v].tag == 3) with_tag.insert(one.observations.views[v].frame);
  }
  EXPECT_EQ(part.tags.size(), static_cast<std::size_t>(kTagsOnWalls));
  for (const int tag : part.tags) EXPECT_GE(count_views(one.observations, part)[tag], 3) << tag;
  EXPECT_LE(frames.size(), 500u);
  EXPECT_GE(with_tag.size(), 200u);
  EXPECT_TRUE(std::ranges::is_sorted(part.views));
}

}  // namespace
}  // namespace apriltrack
