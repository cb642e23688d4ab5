#include "blur_judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace apriltrack {
namespace {

/// A tag whose pixels are worth `samples`: three of them count as one.
TagEvidence evidence_of(int index, double correlation, int samples = 100, double contrast = 0.5) {
  return {.tag_index = index,
          .num_pixels = 3 * samples,
          .area_px = 3.0 * samples,
          .correlation = correlation,
          .contrast = contrast};
}

Explanation explanation_of(std::vector<TagEvidence> tags, TagVotes votes = {}, double prior_cost = 0.0) {
  Explanation explanation;
  explanation.fit.tags = std::move(tags);
  explanation.votes = std::move(votes);
  explanation.prior_cost = prior_cost;
  return explanation;
}

constexpr std::optional<double> kNextFrame_s = 1.0 / 30.0;

/// After a frame in which a detection of tag 0 agreed: tags 0 and 1 were well seen, both of contrast 0.5.
BlurJudge confirmed_judge() {
  BlurJudge judge;
  judge.claimed(explanation_of({evidence_of(0, 0.97), evidence_of(1, 0.97)}, {{0}, {}}));
  return judge;
}

TEST(BlurJudge, WantsMoreTagsForAStateThanAgainstIt) {
  const BlurJudge judge = confirmed_judge();
  struct Case {
    std::vector<double> correlations;
    TagVotes votes;
    int num_supporting;
    bool is_convincing;
  };
  const std::vector<Case> cases = {
      {{0.9, 0.9}, {{}, {}}, 2, true},          {{0.9, 0.9}, {{}, {5}}, 2, true},
      {{0.9, 0.9}, {{}, {5, 6}}, 2, false},     {{0.9, 0.0}, {{0}, {}}, 1, true},
      {{0.9, 0.0}, {{0}, {5}}, 1, false},       {{0.9, 0.9}, {{0}, {5}}, 2, true},
      {{0.6, 0.6}, {{0, 1}, {5}}, 2, true},  // they agree, though half of each is hidden
      {{0.6, 0.6}, {{0, 1}, {5, 6}}, 2, false},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& one = cases[i];
    const Explanation explanation =
        explanation_of({evidence_of(0, one.correlations[0]), evidence_of(1, one.correlations[1])}, one.votes);
    EXPECT_EQ(judge.num_supporting(explanation), one.num_supporting) << "case " << i;
    EXPECT_EQ(judge.is_convincing(explanation, kNextFrame_s), one.is_convincing) << "case " << i;
  }
}

TEST(BlurJudge, WantsMoreExplainedThanNotWhereALoneTagMayLieOnAnothersPlace) {
  const BlurJudge judge = confirmed_judge();
  const auto is_convincing = [&](double prior_spread, int samples_of_unexplained) {
    Explanation explanation =
        explanation_of({evidence_of(0, 0.97, 1000), evidence_of(1, 0.1, samples_of_unexplained)});
    explanation.prior_spread = prior_spread;
    return judge.is_convincing(explanation, kNextFrame_s);
  };
  EXPECT_TRUE(is_convincing(0.35, 999));
  EXPECT_FALSE(is_convincing(0.35, 1001));
  EXPECT_TRUE(is_convincing(0.25, 1001));  // it can be no other
}

TEST(BlurJudge, WithADetectionHalfATagBehindAHandIsEnough) {
  const BlurJudge judge;  // nothing is known of the frames before
  const auto is_convincing = [&](std::vector<TagEvidence> tags, double prior_cost = 0.0) {
    return judge.is_convincing(explanation_of(std::move(tags), {{0}, {}}, prior_cost), std::nullopt);
  };
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.5)}));
  EXPECT_FALSE(is_convincing({evidence_of(0, 0.499)}));
  // Only those that agree are asked, however large the others.
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.6), evidence_of(1, 0.0, 300)}));
  EXPECT_FALSE(is_convincing({evidence_of(0, 0.4), evidence_of(1, 0.99, 300)}));
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.6, 5)}));  // however small it is
  // Nine standard deviations and more off the motion, one of the two is wrong.
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.6)}, 0.5 * 8.99 * 8.99));
  EXPECT_FALSE(is_convincing({evidence_of(0, 0.6)}, 0.5 * 9.01 * 9.01));
}

TEST(BlurJudge, AFollowedStateIsClaimedWhereHalfOfTheSamplesAreExplained) {
  const BlurJudge judge = confirmed_judge();
  const auto is_convincing = [&](int samples_explained, int samples_unexplained) {
    const Explanation explanation = explanation_of(
        {evidence_of(0, 0.851, samples_explained), evidence_of(1, 0.849, samples_unexplained)});
    return judge.is_convincing(explanation, kNextFrame_s);
  };
  EXPECT_TRUE(is_convincing(100, 99));
  EXPECT_FALSE(is_convincing(100, 101));
}

TEST(BlurJudge, AFollowedStateRestsOnFortySamplesOfTheTagsThatAreExplained) {
  const BlurJudge judge = confirmed_judge();
  const auto is_convincing = [&](const std::vector<TagEvidence>& tags) {
    return judge.is_convincing(explanation_of(tags), kNextFrame_s);
  };
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.97, 40)}));
  EXPECT_FALSE(is_convincing({evidence_of(0, 0.97, 39)}));
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.97, 20), evidence_of(1, 0.97, 20)}));
  EXPECT_FALSE(is_convincing({evidence_of(0, 0.97, 39), evidence_of(1, 0.8, 30)}));
}

TEST(BlurJudge, WithoutADetectionAStateLiesWithinNineStandardDeviationsOfTheMotion) {
  for (const bool is_followed : {true, false}) {
    const BlurJudge judge = is_followed ? confirmed_judge() : BlurJudge();
    const auto is_convincing = [&](const std::vector<TagEvidence>& tags, double sigmas) {
      return judge.is_convincing(explanation_of(tags, {}, 0.5 * sigmas * sigmas), kNextFrame_s);
    };
    const std::vector<TagEvidence> alone = {evidence_of(0, 0.97)},
                                   two = {evidence_of(0, 0.97), evidence_of(1, 0.97)};
    EXPECT_TRUE(is_convincing(two, 9.0));
    EXPECT_FALSE(is_convincing(two, 9.01));
    // A cost of 14: one in 200 of what goes on as expected costs more.
    const double of_alone = is_followed ? 9.0 : std::sqrt(28.0) - 1e-6;
    EXPECT_TRUE(is_convincing(alone, of_alone));
    EXPECT_FALSE(is_convincing(alone, of_alone + 0.01));
  }
}

/// 0.9 is enough for what is followed, not for what is found again: 0.95 is.
void expect_followed(const BlurJudge& judge, std::optional<double> interval_s, bool is_followed) {
  const auto is_convincing = [&](double correlation) {
    return judge.is_convincing(explanation_of({evidence_of(0, correlation)}), interval_s);
  };
  EXPECT_EQ(is_convincing(0.9), is_followed);
  EXPECT_EQ(is_convincing(0.949), is_followed);
  EXPECT_TRUE(is_convincing(0.95));
}

TEST(BlurJudge, FollowsForATenthOfASecond) {
  expect_followed(confirmed_judge(), 0.1, true);
  expect_followed(confirmed_judge(), 0.1001, false);
  expect_followed(confirmed_judge(), std::nullopt, false);
}

TEST(BlurJudge, FollowsFromADetectionOnThroughFramesWithEvidence) {
  const Explanation undetected = explanation_of({evidence_of(0, 0.96)});
  BlurJudge judge;
  expect_followed(judge, kNextFrame_s, false);
  judge.claimed(undetected);
  expect_followed(judge, kNextFrame_s, false);  // nothing was read so far
  judge.claimed(explanation_of({evidence_of(0, 0.96)}, {{0}, {}}));
  expect_followed(judge, kNextFrame_s, true);
  judge.claimed(undetected);
  expect_followed(judge, kNextFrame_s, true);
  judge.missed();
  expect_followed(judge, kNextFrame_s, false);
  judge.claimed(undetected);
  expect_followed(judge, kNextFrame_s, false);  // found again, but not read again
}

TEST(BlurJudge, WithoutADetectionATagOfAnotherContrastDoesNotCount) {
  BlurJudge judge = confirmed_judge();
  judge.missed();  // what is known of the tags stays
  const auto num_supporting = [&](double contrast, const TagVotes& votes = {}) {
    return judge.num_supporting(explanation_of({evidence_of(0, 0.97, 100, contrast)}, votes));
  };
  EXPECT_EQ(num_supporting(0.69), 1);
  EXPECT_EQ(num_supporting(0.71), 0);  // 1.4 times 0.5 is 0.7
  EXPECT_EQ(num_supporting(0.36), 1);
  EXPECT_EQ(num_supporting(0.355), 0);            // 0.5 / 1.4 is 0.357
  EXPECT_EQ(num_supporting(0.71, {{1}, {}}), 2);  // a detection agrees: the light has changed
  EXPECT_FALSE(judge.is_convincing(explanation_of({evidence_of(0, 0.97, 100, 0.71)}), kNextFrame_s));
}

TEST(BlurJudge, AChangeOfContrastThatTheExposureOrItsAbsenceExplainsIsNoReasonToDoubt) {
  const BlurJudge judge = confirmed_judge();  // contrast 0.5 at a sensitivity of 1
  const auto counts = [&](double contrast, double sensitivity) {
    Explanation explanation = explanation_of({evidence_of(0, 0.97, 100, contrast)});
    explanation.sensitivity = sensitivity;
    return judge.num_supporting(explanation) == 1;
  };
  EXPECT_TRUE(counts(0.25, 0.5));
  EXPECT_TRUE(counts(1.0, 2.0));
  EXPECT_TRUE(counts(0.5, 2.0));  // a gain that nobody tells makes up for it
  EXPECT_FALSE(counts(1.0, 1.0));
  EXPECT_FALSE(counts(0.25, 2.0));
}

TEST(BlurJudge, AStateFoundFromADetectionAloneMustAgreeWithOne) {
  const BlurJudge judge = confirmed_judge();
  for (const bool agrees : {true, false}) {
    Explanation explanation = explanation_of({evidence_of(0, 0.99), evidence_of(1, 0.99)},
                                             {agrees ? std::vector{0} : std::vector<int>{}, {}});
    explanation.is_cold = true;
    EXPECT_EQ(judge.is_convincing(explanation, kNextFrame_s), agrees);
    EXPECT_EQ(judge.is_convincing(explanation, std::nullopt), agrees);
  }
}

TEST(BlurJudge, AgainstAMotionThatIsKnownMostOfWhatShouldBeSeenMustBe) {
  const BlurJudge judge = confirmed_judge();
  Explanation elsewhere =
      explanation_of({evidence_of(0, 0.97), evidence_of(1, 0.3), evidence_of(2, 0.2)}, {{0}, {}});
  elsewhere.is_cold = true;
  EXPECT_FALSE(judge.is_convincing(elsewhere, kNextFrame_s));
  EXPECT_TRUE(judge.is_convincing(elsewhere, std::nullopt));  // a hand may cover the others
  elsewhere.fit.tags[1].correlation = 0.97;
  EXPECT_TRUE(judge.is_convincing(elsewhere, kNextFrame_s));
}

TEST(BlurJudge, ACostThatIsNoNumberIsNoReasonToBelieve) {
  const BlurJudge judge = confirmed_judge();
  EXPECT_FALSE(
      judge.is_convincing(explanation_of({evidence_of(0, 0.97)}, {{0}, {}}, std::nan("")), kNextFrame_s));
}

TEST(BlurJudge, ALoneTagIsFollowedOnlyWhereTheMotionSaysWithinATagWhereItIs) {
  const BlurJudge judge = confirmed_judge();
  const auto is_convincing = [&](std::vector<TagEvidence> tags, double spread, const TagVotes& votes = {}) {
    Explanation explanation = explanation_of(std::move(tags), votes);
    explanation.prior_spread = spread;
    return judge.is_convincing(explanation, kNextFrame_s);
  };
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.99)}, 1.0));
  EXPECT_FALSE(is_convincing({evidence_of(0, 0.99)}, 1.01));
  EXPECT_FALSE(is_convincing({evidence_of(0, 0.99), evidence_of(1, 0.84, 50)}, 1.01));
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.99), evidence_of(1, 0.86, 50)}, 1.01));
  EXPECT_TRUE(is_convincing({evidence_of(0, 0.99)}, 1.01, {{0}, {}}));  // it was read
}

TEST(BlurJudge, OnlyADetectionTeachesAnotherContrast) {
  const auto counts = [](const BlurJudge& judge, double contrast) {
    return judge.num_supporting(explanation_of({evidence_of(0, 0.97, 100, contrast)})) == 1;
  };
  const std::vector<TagEvidence> twice_as_light = {evidence_of(0, 0.97, 100, 1.0), evidence_of(1, 0.97)};
  BlurJudge judge = confirmed_judge();
  judge.claimed(explanation_of(twice_as_light));  // tag 1 carries the claim
  EXPECT_TRUE(counts(judge, 0.5));
  EXPECT_FALSE(counts(judge, 1.0));
  judge.claimed(explanation_of(twice_as_light, {{1}, {}}));
  EXPECT_FALSE(counts(judge, 0.5));
  EXPECT_TRUE(counts(judge, 1.0));
}

}  // namespace
}  // namespace apriltrack
