#include "initialise/tag_groups.h"

#include <algorithm>
#include <map>
#include <utility>

#include "apriltrack/base/disjoint_sets.h"

namespace apriltrack {
namespace {

constexpr double kFullWeight_px = 60.0;  // of a tag's edge

using Pair = std::pair<int, int>;

/// By pair of tags: what the frames that show both say of how they lie to each other.
std::map<Pair, double> pair_weights(const Observations& observations, const Part& part) {
  std::map<Pair, double> weights;
  const std::vector<TagView>& views = observations.views;
  const auto weight = [&](std::size_t v) {
    return std::min(1.0, mean_edge_px(views[v].corners_px) / kFullWeight_px);
  };
  for (std::size_t begin = 0, end = 0; begin < part.views.size(); begin = end) {
    while (end < part.views.size() && views[part.views[end]].frame == views[part.views[begin]].frame) ++end;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t j = begin; j < end; ++j) {
        const int a = views[part.views[i]].tag, b = views[part.views[j]].tag;
        if (a < b) weights[{a, b}] += weight(part.views[i]) * weight(part.views[j]);
      }
    }
  }
  return weights;
}

/// Kruskal's.
std::map<int, std::vector<int>> spanning_tree(const Observations& observations, const Part& part) {
  const auto weights = pair_weights(observations, part);
  std::vector<std::pair<double, Pair>> links;
  for (const auto& [pair, weight] : weights) links.emplace_back(-weight, pair);
  std::sort(links.begin(), links.end());
  DisjointSets sets(observations.tags.size());
  std::map<int, std::vector<int>> neighbours;
  for (const auto& [weight, pair] : links) {
    if (!sets.join(static_cast<std::size_t>(pair.first), static_cast<std::size_t>(pair.second))) continue;
    neighbours[pair.first].push_back(pair.second);
    neighbours[pair.second].push_back(pair.first);
  }
  return neighbours;
}

/// What hangs on `tag` when the tree is cut between it and `parent`.
std::vector<int> side(const std::map<int, std::vector<int>>& tree, int tag, int parent) {
  std::vector<int> tags = {tag};
  std::vector<Pair> open = {{tag, parent}};
  while (!open.empty()) {
    const auto [at, from] = open.back();
    open.pop_back();
    for (const int next : tree.at(at)) {
      if (next == from) continue;
      tags.push_back(next);
      open.emplace_back(next, at);
    }
  }
  std::sort(tags.begin(), tags.end());
  return tags;
}

}  // namespace

std::vector<std::vector<int>> hinged_groups(const Observations& observations, const Part& part) {
  std::vector<std::vector<int>> groups;
  for (const int tag : part.tags) groups.push_back({tag});
  const auto tree = spanning_tree(observations, part);
  for (const auto& [tag, neighbours] : tree) {
    for (const int other : neighbours) {
      if (other < tag) continue;
      std::vector<int> one = side(tree, tag, other), two = side(tree, other, tag);
      std::vector<int>& smaller = one.size() < two.size() ? one : two;
      if (smaller.size() > 1) groups.push_back(std::move(smaller));
    }
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return groups;
}

}  // namespace apriltrack
