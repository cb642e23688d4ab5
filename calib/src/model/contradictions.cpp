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

  /// Whether so many bad frames among these would be chance, if the outliers here were as many as elsewhere:
  /// Chernoff's bound of the binomial's tail.
  bool is_more_than_chance(double max_share, const Contradictions& all) const {
    if (static_cast<double>(bad) <= max_share * static_cast<double>(frames)) return false;
    const double others = static_cast<double>(std::max<std::size_t>(all.frames - frames, 1));
    const double elsewhere = static_cast<double>(all.contradicting - contradicting) / others;
    return divergence(static_cast<double>(bad) / static_cast<double>(frames),
                      std::clamp(elsewhere, kMinOutlierShare, 1.0 - kMinOutlierShare)) *
               static_cast<double>(frames) >
           kLogChance;
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
  for (const auto& [tag, count] : tags)
    if (count.is_more_than_chance(kMaxAccused, result)) result.tags.push_back(tag);
  for (const auto& [link, count] : links)
    if (count.is_more_than_chance(kMaxRejected, result)) result.links.push_back(link);
  return result;
}

}  // namespace apriltrack
