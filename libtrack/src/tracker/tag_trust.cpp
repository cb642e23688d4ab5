#include "tag_trust.h"

#include <algorithm>
#include <utility>

namespace apriltrack {
namespace {

/// Frames, each of which counts 1. So many more against than for make a suspect,
constexpr double kSuspect = 2.0;
/// so many more for than against clear it,
constexpr double kCleared = -2.0;
/// and more are not remembered of a pair: what is moved now was right before.
constexpr double kMostOfAPair = 6.0;
/// As many of two tags that stand one against one: nobody can tell which is right.
constexpr double kAlike = 0.5;

}  // namespace

void TagTrust::agree(const std::vector<int>& tags) {
  for (std::size_t i = 0; i < tags.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) add(tags[i], tags[j], -1.0);
  }
  find_suspects();
}

void TagTrust::disagree(const std::vector<int>& tags, const std::vector<int>& others, double weight) {
  for (const int tag : tags) {
    for (const int other : others) add(tag, other, weight);
  }
  find_suspects();
}

double TagTrust::doubt(int tag) const {
  std::set<int> others = suspects_;
  others.erase(tag);
  return doubt_but_of(tag, others);
}

bool TagTrust::is_confirmed(int tag) const {
  const auto known = against_.find(tag);
  return known != against_.end() && std::ranges::any_of(known->second, [&](const auto& other) {
           return other.second <= -1.0 && !is_suspect(other.first);
         });
}

void TagTrust::add(int a, int b, double weight) {
  if (a == b) return;
  double& value = against_[a][b];
  value = std::clamp(value + weight, -kMostOfAPair, kMostOfAPair);
  against_[b][a] = value;
}

double TagTrust::doubt_but_of(int tag, const std::set<int>& left_out) const {
  const auto known = against_.find(tag);
  if (known == against_.end()) return 0.0;
  double sum = 0.0;
  for (const auto& [other, value] : known->second) sum += left_out.contains(other) ? 0.0 : value;
  return sum;
}

/// The most doubtful first: what it said against the others falls with it. Those that are as doubtful go
/// together.
void TagTrust::find_suspects() {
  const std::set<int> before = std::exchange(suspects_, {});
  for (;;) {
    std::map<int, double> doubts;
    double most = kCleared;
    for (const auto& [tag, pairs] : against_) {
      if (suspects_.contains(tag)) continue;
      const double doubt = doubt_but_of(tag, suspects_);
      if (before.contains(tag) ? doubt <= kCleared : doubt < kSuspect) continue;
      doubts[tag] = doubt;
      most = std::max(most, doubt);
    }
    if (doubts.empty()) return;
    for (const auto& [tag, doubt] : doubts) {
      if (doubt >= most - kAlike) suspects_.insert(tag);
    }
  }
}

}  // namespace apriltrack
