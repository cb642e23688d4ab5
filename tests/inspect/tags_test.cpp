// Statistics of tags, and what they lead to.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hand_made.h"
#include "viewpoints.h"

namespace apriltrack {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<RecordingFinding> findings_of_tags(const InspectionFacts& facts) {
  return check_tags(summarise_tags(facts), joined_parts(facts.places));
}

TEST(InspectTags, AreCountedByFramesAndByMomentsWithOthers) {
  RecordingFacts film = recording({{1, 2}, {1}, {}, {1, 2, 3}});
  film.frames[0].tags[0].edge_px = 10.0;
  film.frames[1].tags[0].edge_px = 20.0;
  film.frames[3].tags[0].edge_px = 90.0;
  const auto tags = summarise_tags(facts_of(film));
  ASSERT_EQ(tags.size(), 3u);
  EXPECT_EQ(tags[0].tag, tag36(1));
  EXPECT_EQ(tags[0].frames, 3u);
  EXPECT_EQ(tags[0].places_together, 2u);
  EXPECT_EQ(tags[0].median_edge_px, 20.0);
  EXPECT_EQ(tags[0].smallest_edge_px, 10.0);
  EXPECT_EQ(tags[0].largest_edge_px, 90.0);
  EXPECT_EQ(tags[2].frames, 1u);
}

TEST(InspectTags, PartsAreWhatChainsOfMomentsJoin) {
  const InspectionFacts facts = facts_of(recording({{5, 6}, {1, 2}, {2, 3}, {3, 4}, {9}}));
  EXPECT_THAT(joined_parts(facts.places),
              ElementsAre(ElementsAre(tag36(1), tag36(2), tag36(3), tag36(4)),
                          ElementsAre(tag36(5), tag36(6)), ElementsAre(tag36(9))));
}

TEST(InspectTags, ALongChainIsOnePart) {
  std::vector<std::vector<int>> chain;
  for (int id = 0; id < 500; ++id) chain.push_back({id, id + 1});
  const auto parts = joined_parts(facts_of(recording(chain)).places);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts.front().size(), 501u);
}

TEST(InspectTags, OfAGoodFilmNothingIsFound) {
  EXPECT_THAT(findings_of_tags(facts_of(recording(frames_of(10, {1, 2, 3})))), IsEmpty());
}

TEST(InspectPlaces, OnePlaceStops) {
  EXPECT_THAT(check_viewpoints(facts_of(recording(frames_of(2, {1, 2})))), IsEmpty());
  InspectionFacts of_a_rig = facts_of(recording({{1}, {1, 2}, {1}}));  // whose other camera sees others
  of_a_rig.places = {{tag36(1), tag36(3)}, {tag36(1), tag36(2)}, {tag36(1), tag36(4)}};
  EXPECT_THAT(check_viewpoints(of_a_rig), IsEmpty());
  const auto of_one = check_viewpoints(facts_of(recording({{1}, {1, 2}, {2}})));
  ASSERT_THAT(abouts(of_one), ElementsAre("one_place"));
  EXPECT_EQ(of_one[0].severity, FindingSeverity::kStops);
  EXPECT_THAT(of_one[0].text, HasSubstr("only one picture shows two tags or more: a map"));
}

/// A tag of 40 px, so far to the right.
ViewedTag sight(const std::string& camera, int id, double right_px) {
  const Eigen::Vector2d corner(right_px, 100.0);
  return {camera,
          tag36(id),
          {corner, corner + Eigen::Vector2d(40.0, 0.0), corner + Eigen::Vector2d(40.0, -40.0),
           corner + Eigen::Vector2d(0.0, -40.0)}};
}

TEST(InspectPlaces, AreThoseWhereTagsLieMoreThanAPixelElsewhere) {
  std::vector<RigView> moments(5, {sight("cam0", 1, 50.0), sight("cam0", 2, 150.0)});
  moments[2][1] = sight("cam0", 2, 150.9);
  moments[3][1] = sight("cam0", 2, 151.1);
  std::swap(moments[4][0], moments[4][1]);
  EXPECT_THAT(tags_by_viewpoint(moments),
              ElementsAre(ElementsAre(tag36(1), tag36(2)), ElementsAre(tag36(1), tag36(2))));
}

TEST(InspectPlaces, TagsThatComeAndGoMakeNoNewOnes) {
  std::vector<RigView> moments;
  for (int i = 0; i < 8; ++i) {
    moments.push_back({sight("cam0", 1, 50.0), sight("cam0", 2, 150.0), sight("cam0", 3, 250.0)});
    if (i % 2 == 1) moments.back().erase(moments.back().begin() + i / 3);
    if (i == 5) moments.back().push_back(sight("cam0", 4, 350.0));
  }
  EXPECT_THAT(tags_by_viewpoint(moments), ElementsAre(ElementsAre(tag36(1), tag36(2), tag36(3), tag36(4))));
}

TEST(InspectPlaces, OfARigAllCamerasMustStandStill) {
  const std::vector<RigView> moments = {{sight("left", 1, 50.0)},
                                        {sight("left", 1, 50.0), sight("right", 2, 70.0)},
                                        {sight("left", 1, 50.0), sight("right", 2, 80.0)},
                                        {sight("left", 1, 50.0), sight("right", 2, 80.0)}};
  EXPECT_THAT(tags_by_viewpoint(moments), ElementsAre(ElementsAre(tag36(1)), ElementsAre(tag36(1), tag36(2)),
                                                      ElementsAre(tag36(1), tag36(2))));
}

TEST(InspectPlaces, ACameraThatStandsStillIsToldOf) {
  InspectionFacts facts = facts_of(recording({{1}, {1, 2}, {2}}));
  facts.at_rest = 19;
  EXPECT_THAT(check_viewpoints(facts)[0].text,
              HasSubstr("all 20 pictures of two tags or more are from one place ("));
  facts = facts_of(recording(frames_of(9, {1, 2})));
  facts.at_rest = 9;
  EXPECT_THAT(check_viewpoints(facts), IsEmpty());
  facts.at_rest = 10;
  const auto findings = check_viewpoints(facts);
  ASSERT_THAT(abouts(findings), ElementsAre("at_rest"));
  EXPECT_THAT(findings[0].text, HasSubstr("10 of 19 pictures of two tags or more show what an earlier one"));
}

TEST(InspectPlaces, FramesOfAnotherSizeShowNone) {
  InspectionFacts facts = facts_of(recording(frames_of(9, {1, 2}) + frames_of(3, {})));
  EXPECT_THAT(check_viewpoints(facts), IsEmpty());
  for (std::size_t i = 0; i < 9; ++i) facts.recordings[0].frames[i].width = 320;
  EXPECT_THAT(summarise_tags(facts), IsEmpty());
  facts.places.clear();
  const auto findings = check_viewpoints(facts);
  ASSERT_THAT(abouts(findings), ElementsAre("camera_resolution"));
  EXPECT_EQ(findings[0].severity, FindingSeverity::kStops);
}

TEST(InspectTags, OneTagAloneStops) {
  const auto findings = findings_of_tags(facts_of(recording(frames_of(10, {4}))));
  ASSERT_THAT(abouts(findings), ElementsAre("none_together"));
  EXPECT_EQ(findings[0].severity, FindingSeverity::kStops);
  EXPECT_THAT(findings[0].text, HasSubstr("only one tag was seen, tag36h11/4"));
}

TEST(InspectTags, TagsThatAreNeverInViewTogetherStop) {
  const auto findings = findings_of_tags(facts_of(recording(frames_of(10, {4}) + frames_of(10, {5}))));
  ASSERT_THAT(abouts(findings), ElementsAre("none_together"));
  EXPECT_THAT(findings[0].text, HasSubstr("no two tags are ever in view together (2 seen)"));
}

TEST(InspectTags, GroupsThatNoFrameJoinsAreNamed) {
  const auto findings = findings_of_tags(facts_of(recording(frames_of(9, {1, 2}) + frames_of(9, {3, 4}))));
  ASSERT_THAT(abouts(findings), ElementsAre("disconnected"));
  EXPECT_THAT(findings[0].text, HasSubstr("{tag36h11/1, tag36h11/2} | {tag36h11/3, tag36h11/4}"));
}

TEST(InspectTags, OnesSeenSeldomWithOthersAreWeakOrLeftOut) {
  const auto ids = frames_of(10, {1, 2}) + frames_of(4, {1, 2, 3}) + frames_of(1, {1, 4}) + frames_of(7, {5});
  const auto findings = findings_of_tags(facts_of(recording(ids)));
  ASSERT_THAT(abouts(findings), ElementsAre("left_out", "few_frames"));
  EXPECT_THAT(findings[0].text,
              HasSubstr("tag36h11/4 (1 place in 1 frame), tag36h11/5 (0 places in 7 frames)."));
  EXPECT_THAT(findings[1].text, HasSubstr("weak: tag36h11/3 (4 places)."));
}

TEST(InspectTags, FiveFramesWithOthersAreEnough) {
  EXPECT_THAT(findings_of_tags(facts_of(recording(frames_of(5, {1, 2})))), IsEmpty());
}

TEST(InspectTags, AnIdTwiceInAFrameIsTold) {
  RecordingFacts film = recording(frames_of(10, {1, 2}));
  for (const std::size_t i : {2u, 3u, 4u}) film.frames[i].tags.push_back(seen(2));
  const InspectionFacts facts = facts_of(film);
  const auto findings = findings_of_tags(facts);
  ASSERT_THAT(abouts(findings), ElementsAre("same_id_twice"));
  EXPECT_THAT(findings[0].text, HasSubstr("tag36h11/2 (3 of 10 frames)"));
  EXPECT_EQ(summarise_tags(facts)[1].frames, 10u) << "frames are counted, not readings";
}

TEST(InspectTags, SmallOnesAndThoseAtTheBorderAreTold) {
  RecordingFacts film = recording(frames_of(10, {1, 2, 3}));
  for (FrameFacts& one : film.frames) {
    one.tags[0].edge_px = 19.0;
    one.tags[1].edge_px = 21.0;
    one.tags[2].is_at_border = true;
  }
  film.frames[0].tags[0].is_at_border = true;  // once is no fault
  const auto findings = findings_of_tags(facts_of(film));
  ASSERT_THAT(abouts(findings), ElementsAre("small_tags", "only_at_border"));
  EXPECT_THAT(findings[0].text, HasSubstr(": tag36h11/1 (19 px)."));
  EXPECT_THAT(findings[1].text, HasSubstr(": tag36h11/3 (10 views)."));
}

TEST(InspectTags, ManyAreNotAllNamed) {
  std::vector<std::vector<int>> ids = frames_of(10, {0, 1});
  for (int id = 2; id < 22; ++id) ids.push_back({id});
  const auto findings = findings_of_tags(facts_of(recording(ids)));
  ASSERT_THAT(abouts(findings), ElementsAre("left_out"));
  EXPECT_THAT(findings[0].text, HasSubstr("and 12 more"));
}

/// Readings of a family in so many frames.
InspectionFacts with_other(const std::vector<std::vector<int>>& ids, const FamilyReadings& other,
                           std::size_t sampled = 20) {
  RecordingFacts film = recording(ids);
  film.sampled = sampled;
  film.other_families = {other};
  return facts_of(film);
}

TEST(InspectFamilies, AnotherOneInPlaceOfTheOneAskedForIsNamed) {
  const FamilyReadings grid{"tag36h11b2", 41, 15, 12, 60.0};
  const auto findings = check_families(with_other(frames_of(20, {}), grid));
  ASSERT_THAT(abouts(findings), ElementsAre("other_family"));
  EXPECT_EQ(findings[0].severity, FindingSeverity::kStops);
  EXPECT_THAT(findings[0].text,
              HasSubstr("no tag36h11, but 41 readings of tag36h11b2 in 20 frames looked at"));
  EXPECT_THAT(findings[0].text, HasSubstr("Kalibr"));
  EXPECT_THAT(findings[0].text, HasSubstr("use --family tag36h11b2"));
}

TEST(InspectFamilies, AnotherOneBesidesIsAWarning) {
  const auto findings = check_families(with_other(frames_of(20, {1}), {"tag36h10", 9, 9, 9, 60.0}));
  ASSERT_THAT(abouts(findings), ElementsAre("other_family"));
  EXPECT_EQ(findings[0].severity, FindingSeverity::kWarning);
}

TEST(InspectFamilies, ChanceReadingsOfFewBitsAreNone) {
  constexpr std::size_t kFrames = 400;                         // 0.04 chance readings are expected
  const FamilyReadings scattered{"tag16h5", 30, 18, 3, 40.0};  // over 30 ids
  const FamilyReadings faint{"tag16h5", 130, 118, 118, 9.0};   // one shadow, frame after frame
  for (const FamilyReadings& chance : {scattered, faint}) {
    EXPECT_FALSE(is_surely_there(chance, kFrames));
    EXPECT_THAT(check_families(with_other(frames_of(20, {1}), chance, kFrames)), IsEmpty());
    EXPECT_THAT(abouts(check_families(with_other(frames_of(20, {}), chance, kFrames))),
                ElementsAre("no_tags"));
  }
  EXPECT_TRUE(is_surely_there({"tag16h5", 130, 118, 117, 40.0}, kFrames));
  EXPECT_TRUE(is_surely_there({"tag16h5", 1, 1, 1, 40.0}, 20)) << "0.002 are expected";
}

TEST(InspectFamilies, WhatMayBeChanceOfTheFamilyAskedForIsTold) {
  RecordingFacts film = recording(frames_of(400, {}));
  for (const std::size_t i : {3u, 9u, 20u, 33u})
    film.frames[i].tags = {{.tag = {"tag16h5", static_cast<int>(i)}, .edge_px = 30.0, .margin = 40.0}};
  InspectionFacts facts = facts_of(film);
  facts.families = {"tag16h5"};
  const auto findings = check_families(facts);
  ASSERT_THAT(abouts(findings), ElementsAre("chance_readings"));
  EXPECT_THAT(findings[0].text, HasSubstr("the 4 readings of tag16h5 may be chance"));
  for (FrameFacts& one : facts.recordings[0].frames)
    one.tags = {{.tag = {"tag16h5", 7}, .edge_px = 30.0, .margin = 40.0}};
  EXPECT_THAT(check_families(facts), IsEmpty());
}

TEST(InspectOddPictures, AreToldInPlaceOfTagsThatAreNotThere) {
  InspectionFacts facts = facts_of(recording(frames_of(20, {})));
  facts.recordings[0].odd_pictures = OddPictures{.are_mirrored = true, .tags = {tag36(3), tag36(4)}};
  auto findings = inspection_findings(facts);
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].about, "mirrored");
  EXPECT_EQ(findings[0].severity, FindingSeverity::kStops);
  EXPECT_THAT(findings[0].text, HasSubstr("tags are read in their mirror image (tag36h11/3 and 1 more)"));
  EXPECT_EQ(std::ranges::count(findings, "no_tags", &RecordingFinding::about), 0);
  facts.recordings[0].odd_pictures = OddPictures{.are_inverted = true, .tags = {tag36(3)}};
  findings = inspection_findings(facts);
  EXPECT_EQ(findings[0].about, "inverted");
  EXPECT_THAT(findings[0].text, HasSubstr("print tags black on white"));
}

TEST(InspectLeftOut, ReadingsAreANote) {
  InspectionFacts facts = facts_of(recording(frames_of(20, {1, 2})));
  facts.recordings[0].left_out.add(
      std::vector<LeftOutTag>{{{tag36(8), {}, 0, 90.0}, LeftOutReason::kEdgesNotFitted}});
  const auto findings = inspection_findings(facts);
  ASSERT_THAT(abouts(findings), ElementsAre("readings_left_out"));
  EXPECT_EQ(findings[0].severity, FindingSeverity::kNote);
  EXPECT_THAT(findings[0].text, HasSubstr("1 reading of a tag (tag36h11/8) was left out because the edges"));
}

TEST(InspectFamilies, OneReadingOfManyBitsIsEnough) {
  EXPECT_TRUE(is_surely_there({"tagStandard41h12", 1, 1, 1, 10.0}, 20));
}

}  // namespace
}  // namespace apriltrack
