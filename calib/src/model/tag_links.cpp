#include "model/tag_links.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <set>

#include "apriltrack/base/disjoint_sets.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/geometry/rotation.h"
#include "numerics/spread_selection.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMaxFramesPerPair = 24;  // 96 candidates: every pair of a 36-tag grid in under a second
constexpr double kAgreementAngle_rad = 0.15;   // planar rotations scatter by degrees, flips differ by tens
// Of the distance between the tags, for their offset: a lever turned by half of the angle above.
constexpr double kAgreementShare = 0.08;
// A tag this large counts fully: with 0.1 to 0.2 px of noise its perspective tells flips apart by itself.
constexpr double kSharpTag_px = 60.0;

/// Views of both tags of a pair in one frame; two cameras may give several.
struct JointView {
  std::size_t view_a;
  std::size_t view_b;
};

using PairViews = std::map<std::pair<int, int>, std::vector<JointView>>;

PairViews collect_pairs(const Observations& observations, const Part& part) {
  PairViews pairs;
  const std::vector<TagView>& views = observations.views;
  for (std::size_t begin = 0, end = 0; begin < part.views.size(); begin = end) {
    while (end < part.views.size() && views[part.views[end]].frame == views[part.views[begin]].frame) ++end;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t j = begin; j < end; ++j) {
        const int a = views[part.views[i]].tag, b = views[part.views[j]].tag;
        if (a < b) pairs[{a, b}].push_back({part.views[i], part.views[j]});
      }
    }
  }
  return pairs;
}

struct RelativeCandidate {
  Pose T_a_b;
  double weight = 0.0;
  std::size_t frame = 0;  ///< Which joint view it comes from: each has one vote.
};

double size_weight(const CornersPx& corners) {
  return std::min(1.0, mean_edge_px(corners) / kSharpTag_px);
}

std::vector<RelativeCandidate> relative_candidates(const Observations& observations,
                                                   const std::vector<JointView>& joint_views,
                                                   const std::vector<ViewCandidates>& candidates) {
  std::vector<RelativeCandidate> result;
  for (std::size_t f = 0; f < joint_views.size(); ++f) {
    const auto& [view_a, view_b] = joint_views[f];
    const double size = size_weight(observations.views[view_a].corners_px) *
                        size_weight(observations.views[view_b].corners_px);
    for (const auto& a : candidates[view_a].candidates) {
      for (const auto& b : candidates[view_b].candidates)
        result.push_back({a.T_rig_tag.inverse() * b.T_rig_tag, size * a.weight * b.weight, f});
    }
  }
  return result;
}

/// 1 for equal poses, near 0 for those that cannot mean the same arrangement.
double agreement(const RelativeCandidate& x, const RelativeCandidate& y) {
  const double angle = rotation_angle_rad(x.T_a_b.rotation(), y.T_a_b.rotation()) / kAgreementAngle_rad;
  const double distance = 0.5 * (x.T_a_b.translation().norm() + y.T_a_b.translation().norm());
  const double offset =
      (x.T_a_b.translation() - y.T_a_b.translation()).norm() / (kAgreementShare * distance + 1e-9);
  return std::exp(-0.5 * (angle * angle + offset * offset));
}

double support_of(const RelativeCandidate& center, const std::vector<RelativeCandidate>& all,
                  std::size_t num_frames) {
  std::vector<double> votes(num_frames, 0.0);
  for (const RelativeCandidate& other : all)
    votes[other.frame] = std::max(votes[other.frame], other.weight * agreement(center, other));
  double sum = 0.0;
  for (const double vote : votes) sum += vote;
  // The centre's own weight breaks ties: a camera that hardly moves agrees with flips as well as with the
  // truth.
  return sum * std::sqrt(std::max(center.weight, 1e-6));
}

std::optional<TagLink> dominant_mode(const Observations& observations, std::pair<int, int> tags,
                                     const std::vector<JointView>& joint_views,
                                     const std::vector<ViewCandidates>& candidates) {
  const std::vector<JointView> selected = spread_selection(joint_views, kMaxFramesPerPair);
  const auto all = relative_candidates(observations, selected, candidates);
  std::optional<TagLink> best;
  for (const RelativeCandidate& center : all) {
    const double support = support_of(center, all, selected.size());
    if (!best || support > best->support) best = TagLink{tags.first, tags.second, center.T_a_b, support};
  }
  return best;
}

}  // namespace

std::vector<TagLink> find_links(const Observations& observations, const Part& part,
                                const std::vector<ViewCandidates>& candidates, const ParallelFor& parallel) {
  const PairViews by_pair = collect_pairs(observations, part);
  const std::vector<std::pair<std::pair<int, int>, std::vector<JointView>>> pairs(by_pair.begin(),
                                                                                  by_pair.end());
  std::vector<std::optional<TagLink>> links(pairs.size());
  parallel(pairs.size(), [&](std::size_t i) {
    links[i] = dominant_mode(observations, pairs[i].first, pairs[i].second, candidates);
  });
  std::vector<TagLink> result;
  for (const auto& link : links) {
    if (link) result.push_back(*link);
  }
  return result;
}

namespace {

void strongest_first(std::vector<TagLink>& links) {
  std::ranges::stable_sort(links, std::greater<>(), &TagLink::support);
}

/// Kruskal: links, the strongest first, that close no loop; those of tag `without` are passed over.
class Forest {
 public:
  Forest(std::size_t num_tags, const std::vector<TagLink>& links, int without = -1)
      : neighbours_(num_tags), T_root_tag_(num_tags) {
    DisjointSets sets(num_tags);
    for (const TagLink& link : links) {
      if (link.tag_a == without || link.tag_b == without) continue;
      const auto a = static_cast<std::size_t>(link.tag_a), b = static_cast<std::size_t>(link.tag_b);
      if (!sets.join(a, b)) continue;
      neighbours_[a].emplace_back(link.tag_b, link.T_a_b);
      neighbours_[b].emplace_back(link.tag_a, link.T_a_b.inverse());
    }
  }

  /// Of the tree in which `root` is.
  void place_from(int root) {
    T_root_tag_[static_cast<std::size_t>(root)] = Pose::identity();
    std::queue<int> open({root});
    while (!open.empty()) {
      const auto tag = static_cast<std::size_t>(open.front());
      open.pop();
      for (const auto& [next, T_tag_next] : neighbours_[tag]) {
        if (T_root_tag_[static_cast<std::size_t>(next)]) continue;
        T_root_tag_[static_cast<std::size_t>(next)] = *T_root_tag_[tag] * T_tag_next;
        open.push(next);
      }
    }
  }
  void place_all() {
    for (std::size_t tag = 0; tag < T_root_tag_.size(); ++tag)
      if (!T_root_tag_[tag]) place_from(static_cast<int>(tag));
  }
  /// Each in its tree; nullopt where none was placed.
  std::vector<std::optional<Pose>>& poses() { return T_root_tag_; }

 private:
  std::vector<std::vector<std::pair<int, Pose>>> neighbours_;  ///< (tag, T_this_tag)
  std::vector<std::optional<Pose>> T_root_tag_;
};

/// What the forest contradicts, of the support of each link.
std::vector<double> contradicted_support(std::size_t num_tags, const std::vector<TagLink>& links,
                                         int without = -1) {
  Forest forest(num_tags, links, without);
  forest.place_all();
  std::vector<double> result;
  for (const TagLink& link : links) {
    const Pose& T_root_a = *forest.poses()[static_cast<std::size_t>(link.tag_a)];
    const Pose& T_root_b = *forest.poses()[static_cast<std::size_t>(link.tag_b)];
    const RelativeCandidate by_forest{T_root_a.inverse() * T_root_b}, by_link{link.T_a_b};
    const bool is_asked = link.tag_a != without && link.tag_b != without;
    result.push_back(is_asked ? link.support * (1.0 - agreement(by_forest, by_link)) : 0.0);
  }
  return result;
}

}  // namespace

std::vector<std::optional<Pose>> poses_along_tree(std::size_t num_tags, int root,
                                                  std::vector<TagLink> links) {
  strongest_first(links);
  Forest forest(num_tags, links);
  forest.place_from(root);
  return std::move(forest.poses());
}

std::vector<std::pair<double, int>> support_freed_by_tags(std::size_t num_tags, std::vector<TagLink> links) {
  strongest_first(links);
  std::set<int> tags;
  for (const TagLink& link : links) tags.insert({link.tag_a, link.tag_b});
  const std::vector<double> with_all = contradicted_support(num_tags, links);
  std::vector<std::pair<double, int>> result;
  for (const int tag : tags) {
    const std::vector<double> without = contradicted_support(num_tags, links, tag);
    double freed = 0.0;
    for (std::size_t i = 0; i < links.size(); ++i)
      if (links[i].tag_a != tag && links[i].tag_b != tag) freed += with_all[i] - without[i];
    if (freed > 0.0) result.emplace_back(freed, tag);
  }
  std::ranges::sort(result, std::greater<>());
  return result;
}

}  // namespace apriltrack
