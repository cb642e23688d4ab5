// Every camera through every pair of formats that can hold it; and what the others say.

#include <gmock/gmock.h>

#include <fstream>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/io/input_file.h"
#include "format_cameras.h"
#include "support/error_message.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kMaxError_px = 1e-6;

std::vector<CameraFormat> written_formats() {
  std::vector<CameraFormat> formats;
  for (const CameraFormatInfo& info : camera_formats())
    if (info.is_written) formats.push_back(info.format);
  return formats;
}

bool holds_fisheyes(CameraFormat format) {
  return format != CameraFormat::kWpilib && format != CameraFormat::kPhotonVision &&
         format != CameraFormat::kMrcal;
}

bool can_hold(CameraFormat format, const Camera& camera) {
  return holds_fisheyes(format) || camera.model.distortion_name() != "equidistant";
}

/// The camera after it went into a file of this format and out again.
Camera through(CameraFormat format, const Camera& camera) {
  const auto path = test::temporary_folder() / "through";
  write_cameras_as(path, {{camera}}, format);
  const CameraFile file = read_camera_file(path);
  EXPECT_EQ(file.format, format) << "recognised by its content, for the name has no ending";
  EXPECT_EQ(file.rig.cameras.size(), 1U);
  Camera read = file.rig.cameras.front();
  if (read.width == 0) {  // WPILib has no place for it
    read.width = camera.width;
    read.height = camera.height;
  }
  return read;
}

/// Largest difference over the picture, projected and unprojected (as an angle, in pixels of the mean focal
/// length).
double largest_difference_px(const Camera& a, const Camera& b) {
  double largest = 0.0;
  int count = 0;
  for (const Eigen::Vector2d& pixel : test::pixels_over(a)) {
    const auto ray_a = a.model.unproject(pixel);
    const auto ray_b = b.model.unproject(pixel);
    if (!ray_a || !ray_b) continue;
    const auto pixel_b = b.model.project(*ray_a);
    if (!pixel_b) continue;
    ++count;
    largest = std::max({largest, (*pixel_b - pixel).norm(), a.model.pinhole().fx * (*ray_a - *ray_b).norm()});
  }
  EXPECT_GE(count, 1000);
  return largest;
}

TEST(ConvertCameras, EveryPairOfFormatsKeepsEveryPixel) {
  int num_pairs = 0;
  for (const Camera& camera : test::format_cameras()) {
    for (const CameraFormat first : written_formats()) {
      for (const CameraFormat second : written_formats()) {
        if (!can_hold(first, camera) || !can_hold(second, camera)) continue;
        const Camera converted = through(second, through(first, camera));
        EXPECT_LE(largest_difference_px(camera, converted), kMaxError_px)
            << info_of(first).name << " to " << info_of(second).name << ", "
            << camera.model.distortion_name();
        EXPECT_EQ(converted.width, camera.width);
        EXPECT_EQ(converted.height, camera.height);
        ++num_pairs;
      }
    }
  }
  EXPECT_EQ(num_pairs, 4 * 7 * 7 + 4 * 4);
}

TEST(ConvertCameras, NumbersComeBackToTheLastDigit) {
  for (const Camera& camera : test::format_cameras()) {
    for (const CameraFormat format : written_formats()) {
      if (!can_hold(format, camera)) continue;
      const Camera read = through(format, camera);
      const double offset_px = format == CameraFormat::kColmap ? 1e-12 : 0.0;  // 0.5 is added and taken off
      EXPECT_EQ(read.model.pinhole().fx, camera.model.pinhole().fx) << info_of(format).name;
      EXPECT_EQ(read.model.pinhole().fy, camera.model.pinhole().fy) << info_of(format).name;
      EXPECT_NEAR(read.model.pinhole().cx, camera.model.pinhole().cx, offset_px) << info_of(format).name;
      EXPECT_NEAR(read.model.pinhole().cy, camera.model.pinhole().cy, offset_px) << info_of(format).name;
    }
  }
}

TEST(ConvertCameras, FisheyesAreRefusedWhereThereIsNoModelForThem) {
  const Camera fisheye = test::format_cameras().back();
  int num_refused = 0;
  for (const CameraFormat format : written_formats()) {
    if (holds_fisheyes(format)) continue;
    const auto path = test::temporary_folder() / "fisheye";
    const std::string message = test::message_of([&] { write_cameras_as(path, {{fisheye}}, format); });
    EXPECT_THAT(message, HasSubstr(path.string() + ": camera 'cam0' has the lens model equidistant"));
    EXPECT_THAT(message, HasSubstr("kalibr, ros, opencv, colmap"));
    EXPECT_FALSE(std::filesystem::exists(path));
    ++num_refused;
  }
  EXPECT_EQ(num_refused, 3);
}

TEST(ConvertCameras, FormatsThatNeedAResolutionNameTheOptionThatGivesIt) {
  Camera camera = test::format_cameras()[1];
  camera.width = camera.height = 0;
  const auto path = test::temporary_folder() / "camera";
  for (const CameraFormat format :
       {CameraFormat::kKalibr, CameraFormat::kRosCameraInfo, CameraFormat::kPhotonVision,
        CameraFormat::kMrcal, CameraFormat::kColmap}) {
    EXPECT_THAT(test::message_of([&] { write_cameras_as(path, {{camera}}, format); }),
                HasSubstr(path.string() + ": camera 'cam0' has no resolution"))
        << info_of(format).name;
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  for (const CameraFormat format : {CameraFormat::kOpenCv, CameraFormat::kWpilib})
    EXPECT_THAT(write_cameras_as(path, {{camera}}, format), IsEmpty()) << info_of(format).name;
}

TEST(ConvertCameras, WhatIsOnlyReadIsNotWritten) {
  const auto path = test::temporary_folder() / "camera";
  EXPECT_THAT(
      test::message_of(
          [&] { write_cameras_as(path, {{test::format_cameras()[0]}}, CameraFormat::kNerfstudio); }),
      HasSubstr("nerfstudio transforms.json is read, not written; written are kalibr, ros, opencv, wpilib"));
}

/// A rig of which every fact is told.
CameraRig told_rig() {
  CameraRig rig{{test::format_cameras()[1], test::format_cameras()[2]}};
  rig.cameras[0].name = "front";
  rig.cameras[1].name = "cam1";
  for (Camera& camera : rig.cameras) {
    camera.response = ResponseCurve::gamma(2.25);
    camera.response_origin = ResponseOrigin::kStated;
    camera.exposure_s = 0.0125;
    camera.line_delay_s = 3e-5;
  }
  Vector6d xi;
  xi << 0.1, -0.2, 0.3, 0.4, 0.5, -0.6;
  rig.cameras[1].T_this_previous = Pose::exp(xi);
  return rig;
}

std::vector<LossKind> kinds(const std::vector<ConversionLoss>& lost) {
  std::vector<LossKind> all;
  for (const ConversionLoss& fact : lost) all.push_back(fact.kind);
  return all;
}

TEST(ConvertCameras, TellWhatIsLost) {
  using enum LossKind;
  const CameraRig rig = told_rig();
  const auto lost_in = [&](CameraFormat format, const std::string& only = {}) {
    return kinds(write_cameras_as(test::temporary_folder() / "rig", rig, format, only));
  };
  EXPECT_THAT(lost_in(CameraFormat::kKalibr), ElementsAre(kUnreadLens));  // of cam1
  EXPECT_THAT(lost_in(CameraFormat::kKalibr, "cam1"), ElementsAre(kUnreadLens, kExtrinsics, kFurtherCameras));
  EXPECT_THAT(lost_in(CameraFormat::kRosCameraInfo),
              ElementsAre(kResponse, kExposure, kLineDelay, kFurtherCameras));
  EXPECT_THAT(lost_in(CameraFormat::kOpenCv),
              ElementsAre(kResponse, kExposure, kLineDelay, kNames, kFurtherCameras));
  EXPECT_THAT(
      lost_in(CameraFormat::kWpilib, "cam1"),
      ElementsAre(kResolution, kResponse, kExposure, kLineDelay, kNames, kExtrinsics, kFurtherCameras));
  EXPECT_THAT(lost_in(CameraFormat::kMrcal, "cam1"),
              ElementsAre(kResponse, kExposure, kLineDelay, kNames, kFurtherCameras));
  EXPECT_THAT(lost_in(CameraFormat::kColmap),
              ElementsAre(kResponse, kExposure, kLineDelay, kNames,  // of the first
                          kResponse, kExposure, kLineDelay, kExtrinsics));
  const auto lost = losses_of_writing(rig, CameraFormat::kWpilib, "front");
  EXPECT_THAT(lost[0].which, ElementsAre("front"));
  EXPECT_EQ(lost[0].value, "1283 x 967");
  EXPECT_EQ(lost[1].value, "gamma:2.25");
  EXPECT_THAT(lost[2].numbers, ElementsAre(0.0125));  // exposure
  EXPECT_THAT(lost.back().which, ElementsAre("cam1"));
}

// ethz-asl/kalibr knows radtan of four coefficients; ours may have five or eight.
TEST(ConvertCameras, ALensThatKalibrItselfDoesNotReadIsTold) {
  CameraRig rig;
  rig.cameras.push_back(
      {.model = CameraModel({500, 510, 320, 240}, RadtanDistortion({0.1, -0.2, 0.003, 0.004})),
       .width = 640,
       .height = 480,
       .response_origin = ResponseOrigin::kAssumed});
  EXPECT_TRUE(losses_of_writing(rig, CameraFormat::kKalibr).empty());
  for (const std::vector<double>& more : {std::vector<double>{0.1, -0.2, 0.003, 0.004, 0.05},
                                          {0.1, -0.2, 0.003, 0.004, 0.05, 0.06, 0.07, 0.08}}) {
    rig.cameras[0].model = CameraModel({500, 510, 320, 240}, RadtanDistortion(more));
    const auto lost = losses_of_writing(rig, CameraFormat::kKalibr);
    ASSERT_EQ(lost.size(), 1U);
    EXPECT_EQ(lost[0].kind, LossKind::kUnreadLens);
    EXPECT_THAT(lost[0].numbers, ElementsAre(static_cast<double>(more.size()), 4.0));
    EXPECT_TRUE(losses_of_writing(rig, CameraFormat::kRosCameraInfo).empty());
  }
}

/// As ROS's calibrator states it.
TEST(ConvertCameras, AFifthCoefficientOfZeroIsNoneToKalibr) {
  CameraRig rig;
  rig.cameras.push_back(
      {.model = CameraModel({500, 510, 320, 240}, RadtanDistortion({0.1, -0.2, 0.003, 0.004, 0.0})),
       .width = 640,
       .height = 480,
       .response_origin = ResponseOrigin::kAssumed});
  const auto path = test::temporary_folder() / "camera.yaml";
  EXPECT_TRUE(write_cameras_as(path, rig, CameraFormat::kKalibr).empty());
  EXPECT_THAT(read_file(path), HasSubstr("[0.1, -0.2, 0.003, 0.004]"));
}

TEST(ConvertCameras, ACameraThatIsNotThereIsRefused) {
  EXPECT_THAT(test::message_of([&] {
                write_cameras_as(test::temporary_folder() / "rig", told_rig(), CameraFormat::kRosCameraInfo,
                                 "left");
              }),
              HasSubstr("there is no camera 'left'; the camera file has front, cam1"));
}

TEST(ConvertCameras, ARigStaysARigInColmapAndInOurOwnFormat) {
  const CameraRig rig = told_rig();
  for (const CameraFormat format : {CameraFormat::kColmap, CameraFormat::kKalibr}) {
    const auto path = test::temporary_folder() / "rig";
    write_cameras_as(path, rig, format);
    const CameraRig read = read_camera_file(path).rig;
    ASSERT_EQ(read.cameras.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_LE(largest_difference_px(rig.cameras[i], read.cameras[i]), kMaxError_px);
  }
}

}  // namespace
}  // namespace apriltrack
