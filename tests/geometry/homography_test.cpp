#include "apriltrack/geometry/homography.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points mapped(const Eigen::Matrix3d& H, const Points& points) {
  Points out;
  for (const Eigen::Vector2d& point : points) out.emplace_back((H * point.homogeneous()).hnormalized());
  return out;
}

Eigen::Matrix3d random_homography(RandomStream& random) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 9; ++i) H(i / 3, i % 3) += (i < 6 ? 0.4 : 0.1) * random.uniform(-1.0, 1.0);
  return H;
}

TEST(Homography, FindsTheMapThatMadeThePoints) {
  RandomStream random(221);
  for (const std::size_t num_points : {std::size_t{4}, std::size_t{5}, std::size_t{20}}) {
    for (int i = 0; i < 100; ++i) {
      const Eigen::Matrix3d truth = random_homography(random);
      Points plane = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
      while (plane.size() < num_points)
        plane.push_back({random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
      const auto H = estimate_homography(plane, mapped(truth, plane));
      ASSERT_TRUE(H);
      EXPECT_NEAR(H->norm(), 1.0, 1e-12);
      EXPECT_LT((*H - truth / truth.norm()).norm(), 1e-10);
    }
  }
}

TEST(Homography, DoesNotDependOnUnitsOrOrigin) {
  // A tag of 1 mm at pixels around (2000, 1500): without normalisation the equations are ill conditioned.
  RandomStream random(222);
  const Points plane = {{-5e-4, 5e-4}, {5e-4, 5e-4}, {5e-4, -5e-4}, {-5e-4, -5e-4}};
  Eigen::Matrix3d truth;
  truth << 8e4, 1e3, 2000, -2e3, 9e4, 1500, 20, 30, 1;
  const Points image = mapped(truth, plane);
  const auto H = estimate_homography(plane, image);
  ASSERT_TRUE(H);
  const Points again = mapped(*H, plane);
  for (std::size_t i = 0; i < plane.size(); ++i) EXPECT_LT((again[i] - image[i]).norm(), 1e-8);
}

TEST(Homography, SpreadsNoiseOverAllPoints) {
  RandomStream random(223);
  const Eigen::Matrix3d truth = random_homography(random);
  Points plane;
  for (int i = 0; i < 400; ++i) plane.push_back({random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
  Points image = mapped(truth, plane);
  for (Eigen::Vector2d& point : image) point += 1e-3 * Eigen::Vector2d{random.normal(), random.normal()};
  const auto H = estimate_homography(plane, image);
  ASSERT_TRUE(H);
  EXPECT_LT((*H - truth / truth.norm()).norm(),
            1e-3);  // eight numbers from 800: 1e-3 * sqrt(8 / 800) = 1e-4, times 10
}

TEST(Homography, RefusesPointsThatDoNotDetermineIt) {
  const Points square = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
  EXPECT_TRUE(estimate_homography(square, square));
  const Points line = {{0, 0}, {1, 1}, {2, 2}, {3, 3}};
  EXPECT_FALSE(estimate_homography(square, line));
  EXPECT_FALSE(estimate_homography(line, square));
  const Points three_on_a_line = {{-1, 1}, {0, 1}, {1, 1}, {-1, -1}};
  EXPECT_FALSE(estimate_homography(square, three_on_a_line));
  const Points coincident = {{0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5}};
  EXPECT_FALSE(estimate_homography(square, coincident));
  const Points three = {{-1, 1}, {1, 1}, {1, -1}};
  EXPECT_FALSE(estimate_homography(three, three));
  Points not_finite = square;
  not_finite[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(estimate_homography(square, not_finite));
  EXPECT_THROW(estimate_homography(square, three), MisuseError);
}

}  // namespace
}  // namespace apriltrack
