// Tags of which the views of single frames show two places.
#include "faults/tag_places.h"

#include <gmock/gmock.h>

#include <functional>
#include <map>

#include "adjusted_world.h"
#include "hypotheses/fault_finding.h"

namespace apriltrack {
namespace {

constexpr int kAtTwoPlaces = 11;

/// What is found of a tag that in some of its views, as they come, is 0.42 m away, which is farther than a
/// tag beside it must be.
TagFinding find_where_it_is_away(const std::function<bool(std::size_t view, std::size_t of)>& is_away,
                                 double size_there = 1.0, const Eigen::Vector3d& away_m = {0.3, 0.3, 0.0}) {
  const test::SyntheticWorld world = test::make_room(12, 120, test::perspective_camera());
  std::map<std::size_t, std::size_t> rank_of_frame;
  test::filmed_with(world, kAtTwoPlaces, [&](const Eigen::Vector3d& corner, std::size_t i) {
    rank_of_frame.try_emplace(i, rank_of_frame.size());
    return corner;
  });
  std::vector<FrameDetections> frames =
      test::filmed_with(world, kAtTwoPlaces, [&](const Eigen::Vector3d& corner, std::size_t i) {
        const bool is_here = !is_away(rank_of_frame.at(i), rank_of_frame.size());
        return is_here ? corner : Eigen::Vector3d(size_there * corner + away_m);
      });
  RandomStream random(77);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  const test::AdjustedWorld one(world, frames);
  return fault_of(one.task(), one.offered, one.solved, one.index_of(kAtTwoPlaces)).finding;
}

constexpr double kApart_m = 0.424;  // of (0.3, 0.3, 0)

/// Between the two places that were found; 0 where there are none.
double apart_m(const TagFinding& found) {
  return found.places ? found.places->T_first_second.translation().norm() : 0.0;
}

TEST(TwoPlaces, OneAfterTheOtherAreOfATagThatMoved) {
  for (const std::size_t few : {2u, 3u, 6u, 20u}) {
    const TagFinding late =
        find_where_it_is_away([=](std::size_t i, std::size_t of) { return i + few >= of; });
    EXPECT_EQ(late.kind, TagFinding::Kind::kMoved) << few;
    EXPECT_NEAR(apart_m(late), kApart_m, 0.02) << few;
    const TagFinding early = find_where_it_is_away([=](std::size_t i, std::size_t) { return i < few; });
    EXPECT_EQ(early.kind, TagFinding::Kind::kMoved) << few;
    EXPECT_NEAR(apart_m(early), kApart_m, 0.02) << few;
  }
}

// So few that on the whole the tag's views look as they should.
TEST(TwoPlaces, AreToldByThreeViewsThatNothingElseExplains) {
  const TagFinding found = find_where_it_is_away([](std::size_t i, std::size_t of) { return i + 3 >= of; },
                                                 1.0, {0.08, 0.06, 0.0});
  EXPECT_EQ(found.kind, TagFinding::Kind::kMoved);
  EXPECT_NEAR(apart_m(found), 0.1, 0.0015);
  EXPECT_FALSE(find_where_it_is_away([](std::size_t, std::size_t) { return false; }).places);
}

TEST(TwoPlaces, OfTwoSizesAreOfCopiesInWhateverOrder) {
  const TagFinding found =
      find_where_it_is_away([](std::size_t i, std::size_t of) { return 2 * i > of; }, 0.8);
  EXPECT_EQ(found.kind, TagFinding::Kind::kTwoPlaces);
  ASSERT_TRUE(found.places);
  EXPECT_FALSE(found.places->is_one_after_other);
}

TEST(TwoPlaces, ByTurnsAreOfCopies) {
  const TagFinding found = find_where_it_is_away([](std::size_t i, std::size_t) { return i / 8 % 2 == 1; });
  EXPECT_EQ(found.kind, TagFinding::Kind::kTwoPlaces);
  ASSERT_TRUE(found.places);
  EXPECT_FALSE(found.places->is_one_after_other);
}

}  // namespace
}  // namespace apriltrack
