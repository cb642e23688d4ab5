#pragma once

#include <utility>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "model/view_candidates.h"
#include "observations/parts.h"

namespace apriltrack {

/// How two tags lie to each other, as most frames that show both agree.
struct TagLink {
  int tag_a = 0;
  int tag_b = 0;  ///< > tag_a.
  Pose T_a_b;
  double support = 0.0;  ///< Frames that agree, weighted by how large both tags are in them.
};

/// For every pair of tags seen together: all combinations of both tags' planar solutions in all frames (of
/// long recordings an even selection) are candidates; the one that most frames agree with wins. A flipped
/// solution moves with the camera, the true one does not, so flips do not gather support.
std::vector<TagLink> find_links(const Observations& observations, const Part& part,
                                const std::vector<ViewCandidates>& candidates, const ParallelFor& parallel);

/// The part's tags in the frame of `root`, along the spanning tree of greatest support; indexed like
/// observations.tags, nullopt for tags that the tree does not reach.
std::vector<std::optional<Pose>> poses_along_tree(std::size_t num_tags, int root, std::vector<TagLink> links);

/// How much of the links' support the tree contradicts, and how much less of it where the tree is grown
/// without one tag: by tag, most first, of those without which it is less. A tag that hangs at two places
/// folds the tree, and what is folded are links far from it; no tree without it is. Links of the tag itself
/// do not count.
std::vector<std::pair<double, int>> support_freed_by_tags(std::size_t num_tags, std::vector<TagLink> links);

}  // namespace apriltrack
