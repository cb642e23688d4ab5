// What corners claim where nothing tells which of two responses the camera has.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <string>

#include "apriltrack/detect/detector.h"
#include "apriltrack/detect/estimate_response.h"
#include "apriltrack/geometry/homography.h"
#include "lit_boards.h"

namespace apriltrack {
namespace {

/// Squares of the corners' errors over what is claimed of them, a degree of freedom.
double mean_nees(const ResponseCurve& truth, const DetectorOptions& options) {
  Detector detector(options);
  double nees = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Scene scene = test::lit_boards(seed);
    scene.camera.response = truth;
    const GrayImage image = Renderer(scene, {.seed = seed}).render(0).pixels;
    for (const Detection& detection : detector.detect(image.view())) {
      const MapTag* tag = scene.map.find(detection.tag);
      if (!tag || !detection.covariance_px2) continue;
      Eigen::Matrix<double, 8, 1> error;
      for (std::size_t k = 0; k < kNumCorners; ++k)
        error.segment<2>(2 * static_cast<Eigen::Index>(k)) =
            detection.corners_px[k] - *scene.camera.model.project(corners_in_map(*tag)[k]);
      nees += error.dot(detection.covariance_px2->ldlt().solve(error)) / 8.0;
      ++count;
    }
  }
  EXPECT_GE(count, 80) << "of 96";
  ::testing::Test::RecordProperty(options.rival_response ? "nees_in_doubt" : "nees_when_sure",
                                  std::to_string(nees / count));
  return nees / count;
}

DetectorOptions in_doubt() {
  DetectorOptions options;
  options.camera_model =
      CameraModel(Pinhole{test::kBoardsFocal_px, test::kBoardsFocal_px, 319.5, 239.5}, NoDistortion{});
  options.rival_response = rival_response(options.response, ResponseOrigin::kAssumed);
  return options;
}

// Along the difference of the two fits the error is the difference, whose square is twice the rival's part of
// the variance: 2 of 8 in place of 1. Where the response is right, it is nearly 0.
TEST(RivalResponse, OfLinearPicturesIsCountedInTheCorners) {
  DetectorOptions sure = in_doubt();
  sure.rival_response.reset();
  EXPECT_GT(mean_nees(ResponseCurve::linear(), sure), 4.0) << "the pictures must be such that it matters";
  const double nees = mean_nees(ResponseCurve::linear(), in_doubt());
  EXPECT_GT(nees, 0.7);
  EXPECT_LT(nees, 1.6);
}

TEST(RivalResponse, CostsLittleWhereTheResponseIsRight) {
  const double nees = mean_nees(ResponseCurve::srgb(), in_doubt());
  EXPECT_GT(nees, 0.7);
  EXPECT_LT(nees, 1.6);
}

TEST(RivalResponse, IsThatOfFilesOrThatOfSensors) {
  EXPECT_EQ(rival_response(ResponseCurve::srgb(), ResponseOrigin::kAssumed)->name(), "linear");
  EXPECT_EQ(rival_response(ResponseCurve::linear(), ResponseOrigin::kAssumed)->name(), "srgb");
  EXPECT_FALSE(rival_response(ResponseCurve::srgb(), ResponseOrigin::kStated));
  EXPECT_FALSE(rival_response(ResponseCurve::srgb(), ResponseOrigin::kEstimated));
}

}  // namespace
}  // namespace apriltrack
