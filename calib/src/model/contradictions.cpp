#include "model/contradictions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace apriltrack {
namespace {

constexpr double kMaxAccused = 1.0 / 3.0;   // of a tag's frames
constexpr double kMaxRejected = 1.0 / 2.0;  // of a link's frames
constexpr double kLogChance = 10.0;         // one in 20,000
constexpr double kMinOutlierShare = 0.01;   // of frames: what chance may do at the least

struct FrameTags {
  std::set<int> fitting;
  std::set<int> rejected;

  bool contradicts() const { return !rejected.empty(); }
  std::set<int> all() const {
    std::set<int> tags = fitting;
    tags.insert(rejected.begin(), rejected.end());
    return tags;
  }
  std::set<int> accused() const { return rejected.empty() || fitting.size() >= 2 ? rejected : all(); }
};

/// Of the frames that show one tag, or two.
struct Count {
  std::size_t frames = 0;
  std::size_t contradicting = 0;
  std::size_t bad = 0;

  double share() const { return static_cast<double>(bad) / static_cast<double>(frames); }
  /// How unlikely so many bad frames among these are, if the outliers here are as many as elsewhere:
  /// Chernoff's bound of the binomial's tail, nats.
  double beyond_chance(const Contradictions& all) const {
    const double others = static_cast<double>(std::max<std::size_t>(all.frames - frames, 1));
    const double elsewhere = static_cast<double>(all.contradicting - contradicting) / others;
    return divergence(share(), std::clamp(elsewhere, kMinOutlierShare, 1.0 - kMinOutlierShare)) *
           static_cast<double>(frames);
  }
};

std::map<int, FrameTags> frames_of(const Observations& observations, const Part& part,
                                   const std::vector<std::size_t>& gross) {
  std::map<int, FrameTags> frames;
  for (const std::size_t v : part.views) {
    const TagView& view = observations.views[v];
    const bool is_gross = std::binary_search(gross.begin(), gross.end(), v);
    (is_gross ? frames[view.frame].rejected : frames[view.frame].fitting).insert(view.tag);
  }
  return frames;
}

}  // namespace

double divergence(double share, double chance) {
  if (share <= chance) return 0.0;
  const double rest = share < 1.0 ? (1.0 - share) * std::log((1.0 - share) / (1.0 - chance)) : 0.0;
  return share * std::log(share / chance) + rest;
}

Contradictions find_contradictions(const Observations& observations, const Part& part,
                                   const std::vector<std::size_t>& gross) {
  Contradictions result;
  std::map<int, Count> tags;
  std::map<std::pair<int, int>, Count> links;
  for (const auto& [index, frame] : frames_of(observations, part, gross)) {
    ++result.frames;
    if (frame.contradicts()) ++result.contradicting;
    const std::set<int> all = frame.all();
    for (auto a = all.begin(); a != all.end(); ++a) {
      ++tags[*a].frames;
      if (frame.contradicts()) ++tags[*a].contradicting;
      for (auto b = std::next(a); b != all.end(); ++b) {
        Count& link = links[{*a, *b}];
        ++link.frames;
        if (frame.contradicts()) ++link.contradicting;
        if (frame.rejected.contains(*a) || frame.rejected.contains(*b)) ++link.bad;
      }
    }
    for (const int tag : frame.accused()) ++tags[tag].bad;
  }
  std::vector<std::pair<double, int>> doubtful;
  for (const auto& [tag, count] : tags) {
    const double beyond = count.beyond_chance(result);
    if (beyond <= kLogChance) continue;
    doubtful.emplace_back(-beyond, tag);
    if (count.share() > kMaxAccused) result.tags.push_back(tag);
  }
  for (const auto& [link, count] : links)
    if (count.share() > kMaxRejected && count.beyond_chance(result) > kLogChance)
      result.links.push_back(link);
  std::ranges::sort(doubtful);
  for (const auto& [beyond, tag] : doubtful) result.doubtful_tags.push_back(tag);
  return result;
}

}  // namespace apriltrack
