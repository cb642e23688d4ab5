#include "assess/map_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "apriltrack/base/disjoint_sets.h"
#include "observations/observations.h"
#include "observations/parts.h"

namespace apriltrack {
namespace {

constexpr int kFewMoments = 4;  // "weak" are tags of fewer than five views, too

using Edges = std::vector<std::pair<int, int>>;

/// Kruskal's: edges of most moments first.
Edges tree_of_most_moments(std::vector<SeenTogether> links, std::size_t num_tags) {
  std::ranges::stable_sort(links, std::greater(), &SeenTogether::frames);
  DisjointSets sets(num_tags);
  Edges tree;
  for (const SeenTogether& link : links) {
    if (sets.join(static_cast<std::size_t>(link.tag_a), static_cast<std::size_t>(link.tag_b)))
      tree.emplace_back(link.tag_a, link.tag_b);
  }
  return tree;
}

/// Whether each tag lies on the side of the edge's first tag.
std::vector<bool> side_of(const Edges& tree, std::size_t without, std::size_t num_tags) {
  DisjointSets sets(num_tags);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (i != without)
      sets.join(static_cast<std::size_t>(tree[i].first), static_cast<std::size_t>(tree[i].second));
  }
  std::vector<bool> side(num_tags);
  const std::size_t root = sets.find(static_cast<std::size_t>(tree[without].first));
  for (std::size_t tag = 0; tag < num_tags; ++tag) side[tag] = sets.find(tag) == root;
  return side;
}

struct Cut {
  int moments = 0;
  std::set<int> hinge[2];  ///< Of the side that is false, and of the one that is true.
};

Cut cut_between(const std::vector<bool>& side, const std::vector<std::vector<int>>& moments) {
  Cut cut;
  for (const std::vector<int>& tags : moments) {
    const auto num_true =
        std::ranges::count_if(tags, [&](int tag) { return side[static_cast<std::size_t>(tag)]; });
    if (num_true == 0 || num_true == static_cast<std::ptrdiff_t>(tags.size())) continue;
    ++cut.moments;
    for (const int tag : tags) cut.hinge[side[static_cast<std::size_t>(tag)] ? 1 : 0].insert(tag);
  }
  return cut;
}

void mark_bridges(const std::vector<bool>& side, std::vector<SeenTogether>& links) {
  for (SeenTogether& link : links) {
    if (side[static_cast<std::size_t>(link.tag_a)] != side[static_cast<std::size_t>(link.tag_b)])
      link.is_bridge = true;
  }
}

std::vector<TagKey> keys_at(const TagMap& map, const std::set<int>& tags) {
  std::vector<TagKey> keys;
  for (const int tag : tags) keys.push_back(map.tags[static_cast<std::size_t>(tag)].key);
  return keys;
}

std::string words_of(const HangingPart& part) {
  constexpr std::size_t kNamed = 6;
  return fmt::format("{} {} on the rest by {} {} only, showing {} together with {}",
                     list_tags(part.tags, kNamed), part.tags.size() == 1 ? "hangs" : "hang", part.frames,
                     part.frames == 1 ? "frame" : "frames", list_tags(part.hinge_of_part, kNamed),
                     list_tags(part.hinge_of_rest, kNamed));
}

}  // namespace

std::vector<std::vector<int>> tags_by_moment(const MapEvidence& evidence) {
  std::vector<std::vector<int>> tags(evidence.moments.size());
  for (const MappedView& view : evidence.views)
    tags[static_cast<std::size_t>(view.moment)].push_back(view.tag);
  for (std::vector<int>& of_moment : tags) {
    std::ranges::sort(of_moment);
    of_moment.erase(std::unique(of_moment.begin(), of_moment.end()), of_moment.end());
  }
  return tags;
}

std::vector<SeenTogether> links_of(const std::vector<std::vector<int>>& moments) {
  std::map<std::pair<int, int>, int> counts;
  for (const std::vector<int>& tags : moments) {
    for (std::size_t b = 0; b < tags.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) ++counts[{tags[a], tags[b]}];
    }
  }
  std::vector<SeenTogether> links;
  for (const auto& [tags, frames] : counts) links.push_back({tags.first, tags.second, frames, false});
  return links;
}

std::vector<HangingPart> hanging_parts(const TagMap& map, const std::vector<std::vector<int>>& moments,
                                       std::vector<SeenTogether>& links) {
  const std::size_t num_tags = map.tags.size();
  const Edges tree = tree_of_most_moments(links, num_tags);
  std::map<std::pair<int, int>, int> frames_of;
  for (const SeenTogether& link : links) frames_of[{link.tag_a, link.tag_b}] = link.frames;
  std::vector<HangingPart> parts;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (frames_of.at(tree[i]) > kFewMoments) continue;  // more moments than that tie the sides
    const std::vector<bool> side = side_of(tree, i, num_tags);
    const Cut cut = cut_between(side, moments);
    if (cut.moments > kFewMoments) continue;
    mark_bridges(side, links);
    std::set<int> sides[2];
    for (std::size_t tag = 0; tag < num_tags; ++tag) sides[side[tag] ? 1 : 0].insert(static_cast<int>(tag));
    const std::size_t lesser = sides[1].size() < sides[0].size() ? 1 : 0;
    parts.push_back({keys_at(map, sides[lesser]), cut.moments, keys_at(map, cut.hinge[lesser]),
                     keys_at(map, cut.hinge[1 - lesser]), ""});
    parts.back().words = words_of(parts.back());
  }
  std::ranges::stable_sort(parts, {}, &HangingPart::frames);
  return parts;
}

}  // namespace apriltrack
