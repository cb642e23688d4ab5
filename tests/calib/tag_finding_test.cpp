// What is said of a faulty tag, and where another may be at fault.
#include "model/tag_finding.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "messages/tag_messages.h"

namespace apriltrack {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Optional;
using ::testing::StartsWith;
using Kind = TagFinding::Kind;

/// Of tags 0 to 9, at rest since the first frame.
Observations of_ten_tags() {
  Observations observations;
  for (int id = 0; id < 10; ++id) observations.tags.push_back({"tag36h11", id});
  observations.frames = {Timestamp{0}};
  return observations;
}

TagFinding moved_tag(TagFinding::Blame blame, std::vector<std::vector<int>> others = {}) {
  TagFinding finding{.tag = 1, .kind = Kind::kMoved};
  finding.places = PlaceChange{.T_first_second = Pose(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0}),
                               .is_one_after_other = true,
                               .last_at_first = Timestamp{1'000'000'000},
                               .first_at_second = Timestamp{2'000'000'000}};
  finding.is_left_out = true;
  finding.blame = blame;
  finding.others = std::move(others);
  return finding;
}

TEST(TagMessages, SayThatAnotherMayBeAtFault) {
  using Blame = TagFinding::Blame;
  const Observations observations = of_ten_tags();
  EXPECT_THAT(
      message_of(observations, moved_tag(Blame::kThisTag)),
      StartsWith("tag36h11/1 was moved by 0.1 m and 0.0 degrees while filming, between 1.00 and 2.00 s"));
  EXPECT_THAT(message_of(observations, moved_tag(Blame::kThisOrAnother)),
              AllOf(StartsWith("Perhaps tag36h11/1 was moved"),
                    EndsWith(". Or another tag is at fault: the views do not tell which")));
}

TEST(TagMessages, NameTheOneOrTheSeveralThatMayBe) {
  using Blame = TagFinding::Blame;
  const Observations observations = of_ten_tags();
  EXPECT_THAT(message_of(observations, moved_tag(Blame::kThisOrOthersInMap, {{4}})),
              HasSubstr(". Or tag36h11/4, which alone joins its two places"));
  EXPECT_THAT(message_of(observations, moved_tag(Blame::kThisOrOthersInMap, {{4, 5}})),
              HasSubstr("Or the board (tag36h11/4, tag36h11/5), which alone joins its two places"));
  EXPECT_THAT(
      message_of(observations, moved_tag(Blame::kThisOrOthersNoMap, {{6}, {4, 5}})),
      HasSubstr("Or one of tag36h11/6, the board (tag36h11/4, tag36h11/5), each of which alone joins"));
  TagFinding joint{.tag = 4, .kind = Kind::kMoved, .blame = Blame::kJoinsPlacesOfAnother, .joined_tag = 7};
  joint.others = {{4}};
  EXPECT_THAT(message_of(observations, joint),
              HasSubstr("tag36h11/4 alone joins the two places at which tag36h11/7 is seen: it may be what"));
  joint.others = {{4, 5}};
  EXPECT_THAT(message_of(observations, joint),
              HasSubstr("tag36h11/4 (of the board tag36h11/4, tag36h11/5) alone joins"));
}

TEST(TagMessages, AreBesideTypedFields) {
  const Observations observations = of_ten_tags();
  const CalibrationFinding moved =
      reported(observations, moved_tag(TagFinding::Blame::kThisOrOthersInMap, {{4, 5}}));
  EXPECT_EQ(moved.kind, CalibrationFinding::Kind::kMoved);
  EXPECT_THAT(moved.tags, ElementsAre(TagKey{"tag36h11", 1}));
  EXPECT_THAT(moved.value, Optional(DoubleNear(0.1, 1e-12)));
  EXPECT_EQ(moved.unit, "m");
  EXPECT_EQ(moved.timestamp, Timestamp{2'000'000'000});
  EXPECT_THAT(moved.alternatives, ElementsAre(ElementsAre(TagKey{"tag36h11", 4}, TagKey{"tag36h11", 5})));
  EXPECT_TRUE(moved.is_in_doubt);
  EXPECT_TRUE(moved.is_left_out);

  TagFinding larger{.tag = 2, .kind = Kind::kSize};
  larger.shape = ShapeError{.size_m = 0.16, .log_scale = std::log(1.25), .scale_sigma = 0.01};
  const CalibrationFinding size = reported(observations, larger);
  EXPECT_EQ(to_string(size.kind), "wrong_size");
  EXPECT_THAT(size.value, Optional(DoubleNear(1.25, 1e-12)));
  EXPECT_THAT(size.sigma, Optional(DoubleNear(0.0125, 1e-12)));
  EXPECT_FALSE(size.is_in_doubt);
}

// The words of docs/file_formats.md.
TEST(CalibrationFinding, HasTheWordsOfTheDocuments) {
  using enum CalibrationFinding::Kind;
  const std::pair<CalibrationFinding::Kind, std::string_view> words[] = {
      {kWrongSize, "wrong_size"},
      {kDuplicateId, "duplicate_id"},
      {kContradictsOthers, "contradicts_others"},
      {kLostWithOthers, "lost_with_others"},
      {kSeparateComponent, "separate_component"},
      {kDisplacedAtRest, "displaced_at_rest"},
      {kPrintAnisotropy, "print_anisotropy"},
      {kNoCovariances, "no_covariances"},
      {kOtherLens, "other_lens"},
      {kReadout, "readout"},
      {kFrameNotMeasured, "frame_not_measured"}};
  for (const auto& [kind, word] : words) EXPECT_EQ(to_string(kind), word);
}

}  // namespace
}  // namespace apriltrack
