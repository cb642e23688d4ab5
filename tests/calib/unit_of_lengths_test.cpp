#include <gmock/gmock.h>

#include <optional>
#include <string>
#include <tuple>

#include "measured_walls.h"

// Constraints whose lengths are in another unit than metres, told before any is weighed.

namespace apriltrack {
namespace {

using test::calibrate;
using test::distance;
using test::error_of;
using test::gravity;
using test::noisy_frames;
using test::position;
using test::SyntheticWorld;
using test::true_distance_m;
using test::true_tag;
using test::walls;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

MapConstraint distance_in(double per_metre, int a, int b) {
  MapConstraint constraint = distance(a, b, (per_metre - 1.0) * true_distance_m(a, b), 0.001 * per_metre);
  constraint.where = "measured.yaml:7";
  return constraint;
}

MapConstraint position_in(double per_metre, int id) {
  return position(id, (per_metre - 1.0) * true_tag(id).T_map_tag.translation(), 0.001 * per_metre);
}

std::string why_not(const std::vector<MapConstraint>& constraints, const SyntheticWorld& world = walls()) {
  return error_of(ErrorKind::kNoResult,
                  [&] { calibrate(world, noisy_frames(2), {.constraints = constraints}); });
}

TEST(UnitOfLengths, OfDistancesInMillimetresIsAskedForByName) {
  EXPECT_THAT(why_not({distance_in(1000.0, 5, 13)}),
              AllOf(HasSubstr("over 10 times as long as in the map (1 of 1)"),
                    HasSubstr("measured.yaml:7: distance 5-13: "), HasSubstr("are they in millimetres?"),
                    HasSubstr("no map was made")));
  EXPECT_THAT(why_not({distance_in(100.0, 5, 13), distance_in(100.0, 3, 9), distance(7, 19, 0.0, 0.001)}),
              AllOf(HasSubstr("(2 of 3)"), HasSubstr("are they in centimetres?")));
  EXPECT_THAT(why_not({distance_in(15.0, 5, 13)}), AllOf(HasSubstr("15 times as long"), Not(HasSubstr("?"))))
      << "of no unit that is known";
}

TEST(UnitOfLengths, OfPositionsIsToldByTheWaysBetweenThem) {
  std::vector<MapConstraint> constraints = {gravity(7, 0.01)};
  for (const int id : {3, 9, 15, 21}) constraints.push_back(position_in(39.37, id));
  EXPECT_THAT(why_not(constraints),
              AllOf(HasSubstr("(3 of 3)"), HasSubstr("position "), HasSubstr("are they in inches?")));
}

TEST(UnitOfLengths, OfTagSizesIsAskedForWhereAllIsTooShort) {
  SyntheticWorld in_millimetres = walls();
  for (MapTag& tag : in_millimetres.map.tags) tag.size_m *= 1000.0;
  EXPECT_THAT(why_not({distance(5, 13, 0.0, 0.001), distance(3, 9, 0.0, 0.001)}, in_millimetres),
              AllOf(HasSubstr("over 10 times as short"), HasSubstr("are tag sizes in millimetres?")));
}

TEST(UnitOfLengths, IsNotBlamedForOneWrongFigureAmongOthers) {
  const std::string message =
      why_not({distance(3, 9, 0.0, 0.001), distance_in(100.0, 5, 13), distance(7, 19, 0.0, 0.001)});
  EXPECT_THAT(message, AllOf(HasSubstr("distance 5-13: distance: "), Not(HasSubstr("over 10 times"))));
}

TEST(UnitOfLengths, IsNotBlamedWhereTheErrorsExplainTheLength) {
  const MapConstraint loose = distance(5, 13, 20.0 * true_distance_m(5, 13), 10.0 * true_distance_m(5, 13));
  EXPECT_EQ(calibrate(walls(), noisy_frames(2), {.constraints = {loose}}).map.tags.size(), 10U);
}

TEST(UnitOfLengths, TellsWhichConstraintsAreInAnother) {
  try {
    calibrate(walls(), noisy_frames(2),
              {.constraints = {gravity(7, 0.01), distance_in(1000.0, 5, 13), distance_in(1000.0, 3, 9)}});
    FAIL() << "a map was made";
  } catch (const ConstraintError& error) {
    ASSERT_EQ(error.audits().size(), 3U);
    EXPECT_EQ(error.audits()[0].reason, "was not weighed");
    EXPECT_EQ(error.audits()[1].reason, "its length is in no metres");
    EXPECT_FALSE(error.audits()[2].is_used);
  }
}

}  // namespace
}  // namespace apriltrack
