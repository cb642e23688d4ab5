#include "tag_trust.h"

#include <gtest/gtest.h>

#include <set>

namespace apriltrack {
namespace {

using Tags = std::set<int>;

TEST(TagTrust, SuspectsTheTagThatFitsNoOther) {
  TagTrust trust;
  trust.agree({0, 2});
  trust.disagree({0, 2}, {1});
  EXPECT_EQ(trust.suspects(), Tags{1});
  EXPECT_TRUE(trust.is_confirmed(0));
  EXPECT_FALSE(trust.is_confirmed(1));
}

TEST(TagTrust, WhatTheTwoWereToOthersTellsWhichOfThemIsWrong) {
  TagTrust trust;
  for (int i = 0; i < 4; ++i) trust.agree({0, 2});
  for (int i = 0; i < 3; ++i) trust.disagree({1}, {0});  // the pose rested on the wrong one
  EXPECT_EQ(trust.suspects(), Tags{1});
}

TEST(TagTrust, OneAgainstOneBothAreSuspectUntilAThirdTells) {
  TagTrust trust;
  trust.disagree({0}, {1});
  EXPECT_EQ(trust.suspects(), Tags{});  // one frame may err
  trust.disagree({0}, {1});
  EXPECT_EQ(trust.suspects(), (Tags{0, 1}));
  for (int i = 0; i < 6; ++i) trust.agree({0, 2});
  EXPECT_EQ(trust.suspects(), Tags{1});
}

TEST(TagTrust, SwappedTagsAreBothSuspect) {
  TagTrust trust;
  for (int i = 0; i < 3; ++i) {
    trust.agree({0, 2});
    trust.disagree({0, 2}, {4});
    trust.disagree({0, 2}, {6});
    trust.disagree({4}, {6});
  }
  EXPECT_EQ(trust.suspects(), (Tags{4, 6}));
}

TEST(TagTrust, ATagThatFitsAgainForLongEnoughComesBack) {
  TagTrust trust;
  for (int i = 0; i < 50; ++i) trust.disagree({0, 2}, {1});
  int num_frames = 0;
  while (trust.is_suspect(1) && num_frames < 50) {
    trust.agree({0, 1, 2});
    ++num_frames;
  }
  EXPECT_GE(num_frames, 4);
  EXPECT_LE(num_frames, 10);  // however long it did not fit
}

TEST(TagTrust, OneFalseFrameAgainstATrustedTagChangesNothing) {
  TagTrust trust;
  for (int i = 0; i < 10; ++i) trust.agree({0, 1, 2});
  for (int i = 0; i < 3; ++i) trust.disagree({0, 2}, {1});
  EXPECT_EQ(trust.suspects(), Tags{});
}

}  // namespace
}  // namespace apriltrack
