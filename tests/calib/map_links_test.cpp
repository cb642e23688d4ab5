// Parts that few frames tie to the rest, on graphs made by hand and against all ways to cut a graph in two.
#include "assess/map_links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "apriltrack/calib/assess_map.h"
#include "calibrating.h"

namespace apriltrack {
namespace {

using test::tag36h11;
using testing::ElementsAre;
using testing::HasSubstr;

struct Graph {
  TagMap map;
  MapEvidence evidence;
};

Graph graph_of(int num_tags, const std::vector<std::vector<int>>& moments) {
  Graph graph;
  for (int id = 0; id < num_tags; ++id) {
    MapTag tag;
    tag.key = tag36h11(id);
    tag.size_m = 0.16;
    graph.map.tags.push_back(tag);
  }
  for (std::size_t moment = 0; moment < moments.size(); ++moment) {
    graph.evidence.moments.push_back({Timestamp{static_cast<std::int64_t>(moment)}, Pose()});
    for (const int tag : moments[moment]) {
      MappedView view;
      view.corners_px.fill(Eigen::Vector2d::Zero());
      view.residuals_px.fill(Eigen::Vector2d::Zero());
      view.whitened.setZero();
      view.tag = tag;
      view.moment = static_cast<int>(moment);
      graph.evidence.views.push_back(view);
    }
  }
  return graph;
}

void add_moments(std::vector<std::vector<int>>& moments, int count, const std::vector<int>& tags) {
  for (int i = 0; i < count; ++i) moments.push_back(tags);
}

TEST(MapLinks, NamesAPartThatHangsOnFewFrames) {
  std::vector<std::vector<int>> moments;
  add_moments(moments, 12, {1, 2, 3, 6});
  add_moments(moments, 9, {7, 8, 9});
  add_moments(moments, 2, {6, 7});
  add_moments(moments, 20, {0, 1});
  add_moments(moments, 20, {4, 5, 6});
  const Graph graph = graph_of(10, moments);
  const MapAssessment result = assess_map(graph.map, {}, graph.evidence, {});
  ASSERT_EQ(result.hanging.size(), 1u);
  const HangingPart& part = result.hanging[0];
  EXPECT_THAT(part.tags, ElementsAre(tag36h11(7), tag36h11(8), tag36h11(9)));
  EXPECT_EQ(part.frames, 2);
  EXPECT_THAT(part.hinge_of_part, ElementsAre(tag36h11(7)));
  EXPECT_THAT(part.hinge_of_rest, ElementsAre(tag36h11(6)));
  EXPECT_EQ(
      part.words,
      "tag36h11/7, tag36h11/8, tag36h11/9 hang on the rest by 2 frames only, showing tag36h11/7 together "
      "with tag36h11/6");
  for (const SeenTogether& link : result.links)
    EXPECT_EQ(link.is_bridge, link.tag_a == 6 && link.tag_b == 7) << link.tag_a << " " << link.tag_b;
}

TEST(MapLinks, CountsTheFramesOfAllLinksOfACut) {
  // No two tags of both sides share more than two frames, but six frames tie the sides.
  std::vector<std::vector<int>> moments;
  add_moments(moments, 12, {0, 1, 2});
  add_moments(moments, 9, {3, 4, 5});
  for (const auto& [a, b] : {std::pair(0, 3), {1, 4}, {2, 5}}) add_moments(moments, 2, {a, b});
  const Graph graph = graph_of(6, moments);
  EXPECT_TRUE(assess_map(graph.map, {}, graph.evidence, {}).hanging.empty());
}

TEST(MapLinks, TellsEveryWellKnitSideOfRandomGraphs) {
  constexpr int kTags = 7;
  int found = 0;
  for (std::uint64_t trial = 0; trial < 60; ++trial) {
    RandomStream random(23, trial);
    std::vector<std::vector<int>> moments;
    for (int i = 0; i < 8; ++i) {
      const int a = static_cast<int>(kTags * random.uniform()),
                b = static_cast<int>(kTags * random.uniform());
      if (a != b)
        add_moments(moments, 1 + static_cast<int>(9.0 * random.uniform()), {std::min(a, b), std::max(a, b)});
    }
    const Graph graph = graph_of(kTags, moments);
    const MapAssessment result = assess_map(graph.map, {}, graph.evidence, {});
    const auto together = [&](int a, int b) {
      return std::ranges::count_if(moments, [&](const auto& tags) {
        return std::ranges::count(tags, a) + std::ranges::count(tags, b) == 2;
      });
    };
    const auto is_well_knit = [&](unsigned side) {  // by links of more than four frames
      unsigned reached = side & (~side + 1);
      for (int round = 0; round < kTags; ++round) {
        for (int a = 0; a < kTags; ++a) {
          for (int b = 0; b < kTags; ++b) {
            if ((reached >> a & 1u) && (side >> b & 1u) && together(a, b) > 4) reached |= 1u << b;
          }
        }
      }
      return reached == side;
    };
    constexpr unsigned kAll = (1u << kTags) - 1;
    for (unsigned side = 1; side < kAll; side += 2) {  // with tag 0; the others are their complements
      if (!is_well_knit(side) || !is_well_knit(kAll & ~side)) continue;
      const auto crossing = std::ranges::count_if(
          moments, [&](const auto& tags) { return (side >> tags[0] & 1u) != (side >> tags[1] & 1u); });
      if (crossing == 0 || crossing > 4) continue;
      ++found;
      EXPECT_EQ(std::ranges::count_if(result.hanging,
                                      [&](const HangingPart& part) {
                                        unsigned tags = 0;
                                        for (const TagKey& tag : part.tags) tags |= 1u << tag.id;
                                        return (tags == side || tags == (kAll & ~side)) &&
                                               part.frames == crossing;
                                      }),
                1)
          << trial;
    }
  }
  EXPECT_GE(found, 5);
}

}  // namespace
}  // namespace apriltrack
