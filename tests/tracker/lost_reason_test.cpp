#include "lost_reason.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace apriltrack {
namespace {

const std::array<MapTag, 8> kTagsOfMap = {};

/// A frame in which as many tags were detected; of these, so many are of the map and take part.
BlurFrame frame_with(int num_detected, const std::vector<int>& read, const std::vector<int>& taking_part) {
  const auto observed = [](const std::vector<int>& tags) {
    std::vector<TagObservation> observations;
    for (const int tag : tags) {
      TagObservation& seen = observations.emplace_back();
      seen.tag = &kTagsOfMap.at(static_cast<std::size_t>(tag));
      seen.tag_index = tag;
    }
    return observations;
  };
  BlurFrame frame;
  frame.detections.resize(static_cast<std::size_t>(num_detected));
  frame.read = observed(read);
  frame.observations = observed(taking_part);
  return frame;
}

std::vector<Explanation> explained_with(const TagVotes& votes) {
  Explanation explanation;
  explanation.votes = votes;
  return {explanation};
}

TEST(LostReason, TellsWhatWasNotSeen) {
  EXPECT_EQ(lost_reason(frame_with(0, {}, {}), {}), "no tag seen, and no recent pose to look from");
  EXPECT_EQ(lost_reason(frame_with(2, {}, {}), {}),
            "no tag of the map seen, and no recent pose to look from");
}

TEST(LostReason, TellsOfTagsThatOthersShowedToBeElsewhere) {
  EXPECT_EQ(lost_reason(frame_with(1, {4}, {}), {}),
            "the tag seen is not where the map has it, as others showed");
  // Seen twice, it is one tag.
  EXPECT_EQ(lost_reason(frame_with(2, {4, 4}, {}), {}),
            "the tag seen is not where the map has it, as others showed");
  EXPECT_EQ(lost_reason(frame_with(2, {4, 5}, {}), {}), "the tags seen do not agree on a pose");
}

TEST(LostReason, TellsWhetherOneTagOrSeveralFitNoPose) {
  EXPECT_EQ(lost_reason(frame_with(1, {4}, {4}), {}), "the corners seen fit no pose");
  EXPECT_EQ(lost_reason(frame_with(1, {4}, {4}), explained_with({{}, {4}})), "the corners seen fit no pose");
  EXPECT_EQ(lost_reason(frame_with(2, {4, 4}, {4, 4}), explained_with({})), "the corners seen fit no pose");
  EXPECT_EQ(lost_reason(frame_with(2, {4, 5}, {4, 5}), explained_with({{4}, {5}})),
            "the tags seen do not agree on a pose");
}

TEST(LostReason, DoubtsThePixelsWhereMostCornersFit) {
  const std::string pixels =
      "a pose fits the corners, but not the pixels around them: exposure, or response?";
  EXPECT_EQ(lost_reason(frame_with(1, {4}, {4}), explained_with({{4}, {}})), pixels);
  EXPECT_EQ(lost_reason(frame_with(3, {4, 5, 6}, {4, 5, 6}), explained_with({{4, 5}, {6}})), pixels);
}

TEST(LostReason, LooksAtTheBestExplanationAlone) {
  std::vector<Explanation> found = explained_with({{}, {4}});
  found.push_back(explained_with({{4}, {}}).front());
  EXPECT_EQ(lost_reason(frame_with(1, {4}, {4}), found), "the corners seen fit no pose");
}

}  // namespace
}  // namespace apriltrack
