// Two tags that alone join what was filmed before with what was filmed after: either may have changed its
// place.
#include "faults/rival_tags.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <set>
#include <string>
#include <vector>

#include "adjusted_world.h"
#include "calibrating.h"

namespace apriltrack {
namespace {

using test::calibrate;
using test::error_of;
using test::expect_truth;
using test::SyntheticWorld;
using test::tag36h11;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

constexpr int kSuspect = 0;

/// Which tags each frame shows; those of the suspect are at its first place where the frame is, before
/// `change`.
struct SeenTogether {
  Observations observations;
  Part part;
  TagFinding finding;

  SeenTogether(std::initializer_list<std::initializer_list<int>> frames, int change) {
    finding.tag = kSuspect;
    int frame = 0;
    for (const auto& tags : frames) {
      for (const int tag : tags) {
        const std::size_t v = observations.views.size();
        if (tag == kSuspect) finding.views_by_place[frame < change ? 0 : 1].push_back(v);
        TagView view;
        view.whitening.setIdentity();
        view.inward.setZero();
        view.tag = tag;
        view.frame = frame;
        observations.views.push_back(view);
        part.views.push_back(v);
        if (std::ranges::find(part.tags, tag) == part.tags.end()) part.tags.push_back(tag);
      }
      ++frame;
    }
    std::ranges::sort(part.tags);
  }

  std::vector<std::set<int>> rivals() const { return rival_tags(observations, part, part, finding); }
};

TEST(RivalTags, AreThoseThatAloneJoinTheTwoPlaces) {
  EXPECT_THAT(SeenTogether({{0, 1, 2}, {1, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 2).rivals(),
              ElementsAre(std::set{3}));
}

TEST(RivalTags, AreAllOfAChain) {
  EXPECT_THAT(SeenTogether({{0, 1}, {1, 2}, {2, 3}, {0, 3}}, 2).rivals(),
              UnorderedElementsAre(std::set{1}, std::set{2}, std::set{3}));
}

// Two tags on one board are carried, and hang twice, together.
TEST(RivalTags, AreBoardsThatAloneJoinTheTwoPlaces) {
  EXPECT_THAT(SeenTogether({{0, 1, 3, 4}, {1, 3, 4}, {0, 3, 4, 5}, {0, 3, 4}}, 2).rivals(),
              ElementsAre(std::set{3, 4}));
  EXPECT_THAT(SeenTogether({{0, 3, 4}, {1, 3, 4}, {0, 3, 4, 5}}, 2).rivals(), ElementsAre(std::set{3, 4}));
}

TEST(RivalTags, AreNoBoardWhereOneIsSeenAloneAsWell) {
  EXPECT_THAT(SeenTogether({{0, 1, 3, 4}, {1, 3}, {1, 4}, {0, 3, 4, 5}, {0, 3, 4}}, 3).rivals(), IsEmpty());
}

TEST(RivalTags, AreNoBoardWithATagThatJoinsAlone) {
  EXPECT_THAT(
      SeenTogether(
          {{0, 1}, {1, 3}, {3, 4}, {3, 4}, {3, 4}, {3, 4}, {3, 4}, {3, 4}, {3, 4}, {3, 4}, {4, 2}, {0, 2}}, 1)
          .rivals(),
      UnorderedElementsAre(std::set{1}, std::set{2}, std::set{3}, std::set{4}));
}

TEST(RivalTags, AreNotAllThatADeskShowsInEachFrame) {
  const auto desk = {0, 1, 2, 3, 4};
  EXPECT_THAT(SeenTogether({desk, desk, desk, desk, desk, desk}, 3).rivals(), IsEmpty());
}

TEST(RivalTags, AreNoneWhereTheyAreJoinedTwice) {
  EXPECT_THAT(SeenTogether({{0, 1, 2}, {1, 3}, {2, 3, 4}, {0, 3, 4}}, 2).rivals(), IsEmpty());
  EXPECT_THAT(SeenTogether({{0, 1, 2}, {0, 1, 2}}, 1).rivals(), IsEmpty());
}

TEST(RivalTags, AreSeenWithTheSuspectAloneAtOneOfItsPlaces) {
  EXPECT_THAT(SeenTogether({{0, 1, 2}, {1, 2, 3}, {0, 3}}, 2).rivals(), ElementsAre(std::set{3}));
}

// The map gave up the frame that joins them a second time.
TEST(RivalTags, AreToldByWhatTheMapRestsOn) {
  SeenTogether one({{0, 1, 2}, {1, 2, 3}, {2, 4}, {0, 3, 4}}, 2);
  EXPECT_THAT(one.rivals(), IsEmpty());
  Part kept = one.part;
  std::erase_if(kept.views, [&](std::size_t v) { return one.observations.views[v].frame == 2; });
  EXPECT_THAT(rival_tags(one.observations, one.part, kept, one.finding), ElementsAre(std::set{3}));
}

// Of many views some are looked at; the others are where those before and after them are.
TEST(RivalTags, AreNoneWhereViewsThatWereNotLookedAtJoinThem) {
  SeenTogether one({{0, 1, 2}, {1, 2, 3}, {0, 2}, {0, 1, 2}, {0, 3, 4}, {0, 2}, {0, 3, 4}}, 4);
  EXPECT_THAT(one.rivals(), IsEmpty());
  one.finding.views_by_place[1].erase(one.finding.views_by_place[1].begin() + 1);
  EXPECT_THAT(one.rivals(), IsEmpty());
}

TEST(RivalTags, AreNoneOfOnePlace) {
  EXPECT_THAT(SeenTogether({{0, 1}, {0, 1}}, 2).rivals(), IsEmpty());
}

/// Nine tags in a row, of which 4 is shifted from frame 40 on; before, frames show those up to 5, and then
/// those from 4 on, but 5 now and then only: the fit gives up that one's views.
std::vector<FrameDetections> filmed_in_two_halves(const SyntheticWorld& world) {
  std::vector<FrameDetections> frames =
      test::filmed_with(world, 4, [](const Eigen::Vector3d& corner, std::size_t i) {
        return Eigen::Vector3d(corner + Eigen::Vector3d(i < 40 ? 0.0 : 0.3, 0.0, 0.0));
      });
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::erase_if(frames[i].detections, [&](const Detection& one) {
      return i < 40 ? one.tag.id > 5 : one.tag.id < 4 || (one.tag.id == 5 && i % 5 > 0);
    });
  }
  RandomStream random(63);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  return frames;
}

SyntheticWorld row_of_nine() {
  SyntheticWorld world;
  for (int i = 0; i < 9; ++i)
    test::add_tag(world, 0.2, test::looking_along({0.3 * i, 2.0, 0.15 * (i % 2)}, {0.1 * (i % 3), 1.0, 0.0}));
  world.rig.cameras.push_back(test::perspective_camera());
  for (int k = 0; k < 80; ++k)
    world.T_world_rig.push_back(test::looking_along(
        {1.2 + 0.8 * std::sin(1.1 * k), -0.4 + 0.2 * std::cos(0.7 * k), 0.5 * std::sin(0.9 * k)},
        {0.0, 1.0, 0.0}));
  return world;
}

// The map with the one and without the other agrees with every view, and is folded where the wrong one stays.
TEST(RivalTags, AreBothLeftOutOfTheMap) {
  const SyntheticWorld world = row_of_nine();
  const CalibrationResult result = calibrate(world, filmed_in_two_halves(world));
  ASSERT_EQ(result.map.tags.size(), 4u);
  expect_truth(world, result.map, result.held_tag, 0.003, 0.01);
  for (const int id : {4, 5}) {
    EXPECT_EQ(result.map.find(tag36h11(id)), nullptr);
    EXPECT_THAT(result.warnings, Contains(AllOf(HasSubstr(to_string(tag36h11(id))), HasSubstr("moved"),
                                                HasSubstr("do not tell which"))));
  }
}

/// A corridor of eleven tags, of which each frame shows two neighbours; `copy` has the id 4. shows: whether a
/// frame is there, by its first tag and how often that was shown before.
CalibrationResult map_of_corridor(const std::function<bool(int first, int before)>& shows,
                                  const CalibrationOptions& options = {}, int copy = 7,
                                  const std::function<void(std::vector<FrameDetections>&)>& spoil = {}) {
  constexpr int kTags = 11, kShown = 8;
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  for (int i = 0; i < kTags; ++i)
    test::add_tag(world, 0.2, test::looking_along({0.6 * i, 2.0, 0.1 * (i % 2)}, {0.1 * (i % 3), 1.0, 0.0}));
  for (int k = 0; k < kShown * (kTags - 1); ++k) {
    const double x = 0.6 * (k % (kTags - 1)) + 0.3;
    world.T_world_rig.push_back(test::looking_along(
        {x + 0.7 * std::sin(1.1 * k), 0.3 * std::cos(0.7 * k), 0.5 * std::sin(0.9 * k)}, {0.0, 1.0, 0.0}));
  }
  std::vector<FrameDetections> frames = test::exact_detections(world);
  test::show_two_neighbours(kTags, frames);
  RandomStream random(64);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  int k = 0;
  std::erase_if(frames, [&](const FrameDetections&) {
    const bool is_shown = shows(k % (kTags - 1), k / (kTags - 1));
    ++k;
    return !is_shown;
  });
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections)
      if (detection.tag.id == copy) detection.tag.id = 4;
  }
  if (spoil) spoil(frames);
  const CalibrationResult result = calibrate(world, frames, options);
  if (result.map.find(tag36h11(4)) == nullptr) expect_truth(world, result.map, result.held_tag, 0.02, 0.05);
  return result;
}

// Of the tags between the copies any may be it, and so may the one that stays when they are gone.
TEST(RivalTags, AreLeftOutOfACorridorWithTheOneThatHangsTwice) {
  const CalibrationResult result = map_of_corridor([](int, int) { return true; });
  EXPECT_EQ(result.map.find(tag36h11(4)), nullptr);
  for (const int id : {4, 5, 6})
    EXPECT_THAT(result.warnings,
                Contains(AllOf(HasSubstr(to_string(tag36h11(id))), HasSubstr("hangs twice"))));
}

TEST(RivalTags, StayWhereTheMapIsHeldByThemAndThatItMayBeFoldedIsTold) {
  CalibrationOptions options;
  options.held_tag = tag36h11(4);
  const CalibrationResult result = map_of_corridor([](int, int) { return true; }, options);
  EXPECT_NE(result.map.find(tag36h11(4)), nullptr);
  EXPECT_THAT(result.warnings, Contains(AllOf(HasSubstr("Or tag36h11/4, which alone"), HasSubstr("folded"))));
}

TEST(RivalTags, AreToldWhereTheTagThatHoldsTheMapIsRefused) {
  const auto all = [](int, int) { return true; };
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { map_of_corridor(all, {.held_tag = tag36h11(5)}, 6); }),
              AllOf(HasSubstr("tag36h11/5 is seen at two places"),
                    HasSubstr("Or tag36h11/4, which alone joins"), HasSubstr("do not tell which")));
}

// One frame of two tags, which contradicts the map, is no proof, but all that there is.
TEST(LostLinks, AreToldWhereOneTagAloneJoinsTheirEnds) {
  const CalibrationResult result =
      map_of_corridor([](int first, int before) { return first != 5 || before == 3; });
  EXPECT_THAT(result.warnings,
              Contains(AllOf(HasSubstr("tag36h11/5 and tag36h11/6 are seen together in 1 frame only"),
                             HasSubstr("by way of tag36h11/4 alone"))));
}

/// What is told where 5 is seen with both that have the id 4, with the second in few frames: the map gives
/// these up.
std::vector<std::string> told_of_few_frames(const std::set<int>& shown) {
  const auto shows = [&](int first, int before) { return first != 5 || shown.contains(before); };
  return map_of_corridor(shows, {}, 6).warnings;
}

TEST(SplitLinks, AreToldWhereOneTagAloneJoinsOthers) {
  EXPECT_THAT(told_of_few_frames({3, 5}),
              Contains(AllOf(HasSubstr("tag36h11/4 and tag36h11/5 are seen together in 10 frames, of which 2 "
                                       "show tag36h11/4 1.2 m and"),
                             HasSubstr("folded"))));
}

// Nobody carries a tag a metre away and back between two frames.
TEST(SplitLinks, AreToldOfOneFrameThatShowsItFarAway) {
  EXPECT_THAT(told_of_few_frames({3}),
              Contains(AllOf(HasSubstr("in 9 frames, of which 1 shows tag36h11/4"), HasSubstr("folded"))));
}

TEST(SplitLinks, AreToldWithConstraintsThatTheFoldedMapBreaks) {
  const auto shows = [](int first, int before) { return first != 5 || before == 3; };
  const MapConstraint ends{.what = DistanceConstraint{{"", 0}, {"", 10}, 6.0, 0.01}};
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { map_of_corridor(shows, {.constraints = {ends}}, 6); }),
              AllOf(HasSubstr("distance 0-10"), HasSubstr("may be why: tag36h11/4 and tag36h11/5"),
                    HasSubstr("folded")));
}

/// Of the first frames that show 4 and 5 one corner of a tag is off.
std::function<void(std::vector<FrameDetections>&)> spoiling(int id, int num_frames, double error_px) {
  return [=](std::vector<FrameDetections>& frames) {
    int spoilt = 0;
    for (FrameDetections& frame : frames) {
      auto& seen = frame.detections;
      const auto shows = [&](int tag) {
        return std::ranges::any_of(seen, [=](const Detection& one) { return one.tag.id == tag; });
      };
      if (spoilt == num_frames || !shows(4) || !shows(5)) continue;
      ++spoilt;
      for (Detection& one : seen)
        if (one.tag.id == id) one.corners_px[2].x() += error_px;
    }
  };
}

// Of what the map gives up most is no second place, though it agrees.
TEST(SplitLinks, AreNoneInASoundCorridor) {
  const auto all = [](int, int) { return true; };
  for (const int id : {4, 5}) {
    for (const int num_frames : {1, 2}) {
      for (const double error_px : {3.0, 30.0}) {
        const CalibrationResult result = map_of_corridor(all, {}, 4, spoiling(id, num_frames, error_px));
        EXPECT_TRUE(result.observations_rejected > 0 || !result.left_out.empty());
        EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("folded"))))
            << id << ' ' << num_frames << ' ' << error_px;
      }
    }
  }
}

/// A corridor of eight boards of two tags, of which each frame shows two neighbours; the board at the place
/// of the fifth is a copy of the third, and is seen with the fourth in few frames.
CalibrationResult map_of_boards(int frames_with_copy) {
  constexpr int kBoards = 8, kShown = 8;
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  for (int i = 0; i < kBoards; ++i) {
    const Pose T_world_board = test::looking_along({0.9 * i, 2.0, 0.1 * (i % 2)}, {0.1 * (i % 3), 1.0, 0.0});
    test::add_tag(world, 0.15, T_world_board);
    test::add_tag(world, 0.15, T_world_board * Pose(Eigen::Quaterniond::Identity(), {0.2, 0.0, 0.0}));
  }
  std::vector<int> first_of_frame;
  for (int k = 0; k < kShown * (kBoards - 1); ++k) {
    const int first = k % (kBoards - 1);
    if (first == 3 && k / (kBoards - 1) >= frames_with_copy) continue;
    first_of_frame.push_back(first);
    world.T_world_rig.push_back(test::looking_along(
        {0.9 * first + 0.5 + 0.7 * std::sin(1.1 * k), 0.1 * std::cos(0.7 * k), 0.5 * std::sin(0.9 * k)},
        {0.0, 1.0, 0.0}));
  }
  std::vector<FrameDetections> frames = test::exact_detections(world);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    std::erase_if(frames[f].detections, [&](const Detection& one) {
      return one.tag.id / 2 < first_of_frame[f] || one.tag.id / 2 > first_of_frame[f] + 1;
    });
    for (Detection& one : frames[f].detections)
      if (one.tag.id == 8 || one.tag.id == 9) one.tag.id -= 4;
  }
  RandomStream random(65);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  const CalibrationResult result = calibrate(world, frames);
  if (result.map.find(tag36h11(4)) == nullptr) expect_truth(world, result.map, result.held_tag, 0.02, 0.05);
  return result;
}

// Each tag of a board joins no two others alone; the board does.
TEST(RivalTags, AreBoardsThatHangTwice) {
  const CalibrationResult result = map_of_boards(3);
  for (const int id : {4, 5, 6, 7}) {
    EXPECT_EQ(result.map.find(tag36h11(id)), nullptr) << id;
    EXPECT_THAT(result.warnings,
                Contains(AllOf(HasSubstr(to_string(tag36h11(id))), HasSubstr("hangs twice"))));
  }
}

TEST(SplitLinks, AreToldOfABoardThatAloneJoinsOthers) {
  EXPECT_THAT(
      map_of_boards(1).warnings,
      Contains(AllOf(HasSubstr("tag36h11/4, tag36h11/5 alone join other tags"), HasSubstr("folded"))));
}

TEST(RivalTags, AreNoneOfADeskWhoseOneTagWasMoved) {
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  for (int i = 0; i < 5; ++i)
    test::add_tag(world, 0.15,
                  test::looking_along({0.3 * (i % 3), 2.0, 0.3 * (i / 3)}, {0.1 * (i % 3), 1.0, 0.0}));
  for (int k = 0; k < 60; ++k)
    world.T_world_rig.push_back(
        test::looking_along({0.3 + 0.8 * std::sin(1.1 * k), 0.2 * std::cos(0.7 * k), 0.6 * std::sin(0.9 * k)},
                            Eigen::Vector3d(-0.3 * std::sin(1.1 * k), 1.0, -0.2 * std::sin(0.9 * k))));
  std::vector<FrameDetections> frames =
      test::filmed_with(world, 2, [](const Eigen::Vector3d& corner, std::size_t i) {
        return Eigen::Vector3d(corner + Eigen::Vector3d(i < 30 ? 0.0 : 0.1, 0.0, 0.0));
      });
  for (const FrameDetections& frame : frames) ASSERT_EQ(frame.detections.size(), 5u);
  RandomStream random(66);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  const CalibrationResult result = calibrate(world, frames);
  EXPECT_THAT(result.left_out, ElementsAre(tag36h11(2)));
  EXPECT_THAT(result.warnings,
              Contains(AllOf(HasSubstr("tag36h11/2 was moved"), Not(HasSubstr("another tag")))));
}

}  // namespace
}  // namespace apriltrack
