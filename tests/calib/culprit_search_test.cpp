// Which tags of a large map are tried.
#include "hypotheses/culprit_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace apriltrack {
namespace {

Part part_of(int num_tags) {
  Part part;
  part.tags.resize(static_cast<std::size_t>(num_tags));
  std::iota(part.tags.begin(), part.tags.end(), 0);
  return part;
}

TEST(CulpritCandidates, AreAllTagsOfASmallMap) {
  EXPECT_EQ(culprit_candidates(part_of(40), {}), part_of(40).tags);
}

TEST(CulpritCandidates, AreThoseOfALargeOneThatAreAccusedMostOften) {
  Contradictions contradictions;
  for (int tag = 0; tag < 90; ++tag) contradictions.links.emplace_back(tag, 95);
  const std::vector<int> tags = culprit_candidates(part_of(100), contradictions);
  EXPECT_EQ(tags.front(), 95);
  EXPECT_EQ(tags.size(), 40u);
}

}  // namespace
}  // namespace apriltrack
