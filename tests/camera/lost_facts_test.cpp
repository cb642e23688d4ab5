// What foreign camera files say beside the lens, and that reading them tells.

#include <gmock/gmock.h>

#include "foreign_camera_file.h"
#include "support/error_message.h"

namespace apriltrack {
namespace {

using test::ForeignCameraFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The right camera of a pair that is 0.125 m wide: P(0, 3) = -fx' B = -512 * 0.125.
constexpr const char* kRightOfAPair = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo/right
camera_matrix: {rows: 3, cols: 3, data: [500.5, 0, 320.25, 0, 501.75, 240.5, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0.1, -0.2, 0.003, -0.004, 0]}
rectification_matrix: {rows: 3, cols: 3, data: [0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1]}
projection_matrix: {rows: 3, cols: 4, data: [512, 0, 310, -64, 0, 512, 230, 0, 0, 0, 1, 0]}
)";

TEST_F(ForeignCameraFile, NameAndRectificationAndBaselineOfRosAreToldToBeLost) {
  read_here("right.yaml", kRightOfAPair);
  EXPECT_THAT(
      lost(),
      ElementsAre("names of narrow_stereo/right: cam0", "rectification of cam0: rectification_matrix",
                  "rectification of cam0: projection_matrix", "extrinsics of cam0: projection_matrix"));
  EXPECT_THAT(file_.lost.back().numbers, ElementsAre(0.125, 0.0));
  EXPECT_THAT(warnings_, IsEmpty()) << "of no concern but to a conversion";
  std::string above = kRightOfAPair;
  above.replace(above.find("310, -64, 0, 512, 230, 0,"), 25, "310, 0, 0, 256, 230, 32, ");
  read_here("below.yaml", above);
  EXPECT_THAT(file_.lost.back().numbers, ElementsAre(0.0, -0.125));
  // What the camera's own matrix says already is not lost.
  std::string alone = kRightOfAPair;
  alone.replace(alone.find("512, 0, 310, -64, 0, 512, 230"), 29, "500.5, 0, 320.25, 0, 0, 501.75, 240.5");
  alone.replace(alone.find("0.8, -0.6, 0, 0.6, 0.8, 0,"), 26, "1, 0, 0, 0, 1, 0,");
  alone.replace(alone.find("narrow_stereo/right"), 19, "cam0");
  read_here("alone.yaml", alone);
  EXPECT_THAT(lost(), IsEmpty());
  EXPECT_THAT(test::message_of([&] {
                std::string wrong = kRightOfAPair;
                wrong.replace(wrong.find("[0.8, -0.6"), 10, "[0.8");
                read("wrong.yaml", wrong);
              }),
              HasSubstr("wrong.yaml:7: rectification_matrix"));
}

TEST_F(ForeignCameraFile, PlaceOfEurocIsToldToBeLost) {
  read_here("sensor.yaml", R"(sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.5, 457.25, 367.125, 248.5]
distortion_model: radial-tangential
distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]
)");
  EXPECT_THAT(lost(), ElementsAre("extrinsics of cam0: T_BS"));
}

}  // namespace
}  // namespace apriltrack
