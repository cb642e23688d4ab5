#include "assess/tag_flags.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace apriltrack {
namespace {

Matrix6d of_sigmas(double sigma_m, double sigma_rad) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variances.asDiagonal();
}

TEST(TagFlags, CallATagWeakThatFewViewsShowOrLeaveLoose) {
  MapTag tag;
  tag.size_m = 0.16;
  const Matrix6d firm = of_sigmas(0.002, 0.002), turns = of_sigmas(0.002, 0.05),
                 slides = of_sigmas(0.02, 0.002);
  EXPECT_FALSE(is_weak(tag, 5, firm, std::nullopt));
  EXPECT_TRUE(is_weak(tag, 4, firm, std::nullopt));
  EXPECT_TRUE(is_weak(tag, 4, std::nullopt, std::nullopt));
  EXPECT_FALSE(is_weak(tag, 5, std::nullopt, std::nullopt));
  EXPECT_TRUE(is_weak(tag, 50, turns, std::nullopt));
  EXPECT_TRUE(is_weak(tag, 50, slides, std::nullopt));
  EXPECT_TRUE(is_weak(tag, 50, slides, turns));
  EXPECT_FALSE(is_weak(tag, 4, slides, firm)) << "measured beside the images";
}

TEST(TagFlags, KeepOthers) {
  TagStatistics statistics{.flags = {"weak", "outliers"}};
  flag_weak(true, statistics);
  EXPECT_EQ(statistics.flags, (std::vector<std::string>{"weak", "outliers"}));
  flag_weak(false, statistics);
  EXPECT_EQ(statistics.flags, (std::vector<std::string>{"outliers"}));
}

}  // namespace
}  // namespace apriltrack
