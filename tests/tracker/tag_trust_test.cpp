#include "tag_trust.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

using Tags = std::set<int>;

/// The same by looking at all pairs that were ever seen, each time.
class AllPairs {
 public:
  void say(const std::vector<int>& tags, const std::vector<int>& others, double weight) {
    std::set<std::pair<int, int>> pairs;
    for (const int a : tags) {
      for (const int b : others) {
        if (a != b) pairs.insert({std::min(a, b), std::max(a, b)});
      }
    }
    for (const auto& pair : pairs) against_[pair] = std::clamp(against_[pair] + weight, -6.0, 6.0);
    find_suspects();
  }

  double doubt(int tag) const {
    double sum = 0.0;
    for (const auto& [pair, value] : against_) {
      const int other = pair.first == tag ? pair.second : pair.first;
      if ((pair.first == tag || pair.second == tag) && !suspects_.contains(other)) sum += value;
    }
    return sum;
  }
  const Tags& suspects() const { return suspects_; }

 private:
  void find_suspects() {
    Tags tags;
    for (const auto& [pair, value] : against_) tags.insert({pair.first, pair.second});
    const Tags before = std::exchange(suspects_, {});
    for (;;) {
      std::map<int, double> doubts;
      for (const int tag : tags) {
        const bool is_doubtful = before.contains(tag) ? doubt(tag) > -2.0 : doubt(tag) >= 2.0;
        if (is_doubtful && !suspects_.contains(tag)) doubts[tag] = doubt(tag);
      }
      if (doubts.empty()) return;
      double most = -2.0;
      for (const auto& [tag, doubt] : doubts) most = std::max(most, doubt);
      for (const auto& [tag, doubt] : doubts) {
        if (doubt >= most - 0.5) suspects_.insert(tag);
      }
    }
  }

  std::map<std::pair<int, int>, double> against_;
  Tags suspects_;
};

std::vector<int> tags_from(int first, int count) {
  std::vector<int> tags(static_cast<std::size_t>(count));
  std::iota(tags.begin(), tags.end(), first);
  return tags;
}

/// Rooms of six tags each, the second of which is not where the map has it.
void walk_through_rooms(TagTrust& trust, int first, int num_rooms) {
  for (int room = 0; room < num_rooms; ++room) {
    const int tag = first + 6 * room;
    for (int frame = 0; frame < 10; ++frame) {
      trust.agree({tag, tag + 2, tag + 3, tag + 4, tag + 5});
      trust.disagree({tag, tag + 2, tag + 3, tag + 4, tag + 5}, {tag + 1});
    }
  }
}

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

TEST(TagTrust, FindsWhatAllPairsSay) {
  constexpr int kNumTags = 9;
  constexpr int kNumFrames = 400;
  int num_changes = 0, num_suspects = 0;
  for (std::uint64_t run = 0; run < 20; ++run) {
    RandomStream random(4217, run);
    TagTrust trust;
    AllPairs all;
    Tags before;
    const auto some_tags = [&](double share) {
      std::vector<int> tags;
      for (int tag = 0; tag < kNumTags; ++tag) {
        if (random.uniform() < share) tags.push_back(tag);
      }
      return tags;
    };
    for (int frame = 0; frame < kNumFrames; ++frame) {
      if (random.uniform() < 0.5) {
        const std::vector<int> tags = some_tags(0.4);
        trust.agree(tags);
        all.say(tags, tags, -1.0);
      } else {
        const int odd = std::min(kNumTags - 1, static_cast<int>(kNumTags * random.uniform()));
        std::vector<int> tags = some_tags(0.4);
        std::erase(tags, odd);
        const double weight = random.uniform() < 0.5 ? 0.5 : 1.0;
        trust.disagree(tags, {odd}, weight);
        all.say(tags, {odd}, weight);
      }
      ASSERT_EQ(trust.suspects(), all.suspects()) << "run " << run << ", frame " << frame;
      for (int tag = 0; tag < kNumTags; ++tag) ASSERT_EQ(trust.doubt(tag), all.doubt(tag));
      num_changes += trust.suspects() != before ? 1 : 0;
      num_suspects += static_cast<int>(trust.suspects().size());
      before = trust.suspects();
    }
  }
  EXPECT_GT(num_changes, 100);
  EXPECT_GT(num_suspects, 1000);
}

TEST(TagTrust, AFrameCostsWhatItShowsWhateverWasSeenElsewhere) {
  constexpr int kNumSeen = 20;
  const auto work_of_a_frame = [](int num_rooms_elsewhere) {
    TagTrust trust;
    walk_through_rooms(trust, 1000, num_rooms_elsewhere);
    EXPECT_EQ(trust.suspects().size(), static_cast<std::size_t>(num_rooms_elsewhere));
    trust.agree(tags_from(0, kNumSeen));
    const std::uint64_t before = trust.work();
    trust.agree(tags_from(0, kNumSeen));
    return trust.work() - before;
  };
  EXPECT_EQ(work_of_a_frame(0), kNumSeen * (kNumSeen - 1) / 2);
  EXPECT_EQ(work_of_a_frame(60), work_of_a_frame(0));
}

TEST(TagTrust, BesideASuspectAFrameCostsWhatWasSaidOfSuspectsBesides) {
  const auto work_of_a_frame = [](int num_rooms_without_suspects) {
    TagTrust trust;
    for (int room = 0; room < num_rooms_without_suspects; ++room)
      trust.agree(tags_from(1000 + 20 * room, 20));
    walk_through_rooms(trust, 0, 1);
    const std::uint64_t before = trust.work();
    trust.agree({0, 2});
    trust.disagree({0, 2}, {1});
    return trust.work() - before;
  };
  EXPECT_LT(work_of_a_frame(0), 100);
  EXPECT_EQ(work_of_a_frame(60), work_of_a_frame(0));
}

}  // namespace
}  // namespace apriltrack
