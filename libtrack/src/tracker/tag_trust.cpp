#include "tag_trust.h"

#include <algorithm>
#include <utility>

namespace apriltrack {
namespace {

/// Each pair of tags in a frame counts 1, and a tag's doubt is the sum of its pairs'. So many more against
/// than for make a suspect,
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
  const auto known = said_.find(tag);
  return known == said_.end() ? 0.0 : known->second.doubt;
}

bool TagTrust::is_confirmed(int tag) const {
  const auto known = said_.find(tag);
  return known != said_.end() && std::ranges::any_of(known->second.of_pairs, [&](const auto& other) {
           return other.second <= -1.0 && !is_suspect(other.first);
         });
}

void TagTrust::add(int a, int b, double weight) {
  if (a == b) return;
  ++work_;
  Said& of_a = said_[a];
  const auto [pair, is_new] = of_a.of_pairs.try_emplace(b, 0.0);
  const double value = std::clamp(pair->second + weight, -kMostOfAPair, kMostOfAPair);
  const double more = value - pair->second;
  if (more == 0.0) return;
  Said& of_b = said_[b];
  pair->second = of_b.of_pairs[a] = value;
  if (is_new) {
    of_a.num_suspects += is_suspect(b) ? 1 : 0;
    of_b.num_suspects += is_suspect(a) ? 1 : 0;
  }
  if (!is_suspect(b)) add_doubt(a, more);
  if (!is_suspect(a)) add_doubt(b, more);
  is_open_ = is_open_ || concerns_suspects(a) || concerns_suspects(b);
}

void TagTrust::add_doubt(int tag, double more) {
  double& doubt = said_[tag].doubt;
  doubt += more;
  if (doubt >= kSuspect)
    doubtful_.insert(tag);
  else
    doubtful_.erase(tag);
}

bool TagTrust::concerns_suspects(int tag) const {
  return is_suspect(tag) || doubtful_.contains(tag) || said_.at(tag).num_suspects > 0;
}

/// The most doubtful first: what it said against the others falls with it.
void TagTrust::find_suspects() {
  if (!std::exchange(is_open_, false)) return;
  const std::set<int> before = suspects_;
  for (const int tag : before) clear(tag);
  for (;;) {
    const std::vector<int> tags = most_doubtful(before);
    if (tags.empty()) break;
    for (const int tag : tags) suspect(tag);
  }
  is_open_ = suspects_ != before;
}

std::vector<int> TagTrust::most_doubtful(const std::set<int>& suspects_before) {
  std::vector<std::pair<double, int>> doubts;
  const auto look_at = [&](int tag, bool is_doubtful) {
    ++work_;
    if (is_doubtful && !is_suspect(tag)) doubts.emplace_back(doubt(tag), tag);
  };
  for (const int tag : suspects_before) look_at(tag, doubt(tag) > kCleared);
  for (const int tag : doubtful_) look_at(tag, !suspects_before.contains(tag));
  std::vector<int> tags;
  if (doubts.empty()) return tags;
  const double most = std::ranges::max_element(doubts)->first;
  for (const auto& [doubt, tag] : doubts) {
    if (doubt >= most - kAlike) tags.push_back(tag);
  }
  return tags;
}

void TagTrust::suspect(int tag) {
  suspects_.insert(tag);
  for (const auto& [other, value] : said_.at(tag).of_pairs) {
    ++work_;
    ++said_.at(other).num_suspects;
    add_doubt(other, -value);
  }
}

void TagTrust::clear(int tag) {
  suspects_.erase(tag);
  for (const auto& [other, value] : said_.at(tag).of_pairs) {
    ++work_;
    --said_.at(other).num_suspects;
    add_doubt(other, value);
  }
}

}  // namespace apriltrack
