#include <gmock/gmock.h>

#include "apriltrack/source/bag_input.h"
#include "bag_pictures.h"
#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// Cameras.

fs::path bag_with_camera(const CameraInfoFields& info, const std::string& images = "/left/image_raw",
                         const std::string& infos = "/left/camera_info", Wire wire = Wire::kCdr) {
  const fs::path path = temporary_folder() / "camera.mcap";
  TestMessage picture = small_picture(images, kSecond);
  ImageFields fields = picture_of("mono8", "a");
  picture.bytes = image_message(wire, fields);
  write_mcap(path, wire,
             {picture, {infos, "sensor_msgs/CameraInfo", kSecond, camera_info_message(wire, info)}});
  return path;
}

const CameraInfoFields kInfo = {.width = 640,
                                .height = 480,
                                .model = "rational_polynomial",
                                .d = {0.1, -0.2, 0.001, -0.002, 0.03, 0.4, -0.05, 0.006, 0, 0, 0, 0, 0, 0},
                                .k = {400, 0, 321, 0, 410, 242, 0, 0, 1},
                                .p = {390, 0, 318, -40, 0, 395, 238, 0, 0, 0, 1, 0}};

std::vector<double> numbers_of(const Camera& camera) {
  const Pinhole& p = camera.model.pinhole();
  return {p.fx, p.fy, p.cx, p.cy, double(camera.width), double(camera.height)};
}

TEST(BagCamera, IsReadOfEitherByteOrderAndOfRos1) {
  for (const Wire wire : {Wire::kRos1, Wire::kCdr, Wire::kCdrBigEndian}) {
    const auto camera =
        bag_camera(bag_with_camera(kInfo, "/left/image_raw", "/left/camera_info", wire).string());
    ASSERT_TRUE(camera);
    EXPECT_EQ(numbers_of(*camera), (std::vector<double>{400, 410, 321, 242, 640, 480}));
    EXPECT_EQ(std::get<RadtanDistortion>(camera->model.distortion()).coefficients(),
              (std::vector{0.1, -0.2, 0.001, -0.002, 0.03, 0.4, -0.05, 0.006}));
  }
}

TEST(BagCamera, ReadsFisheyes) {
  for (const char* model : {"equidistant", "fisheye", "kannala_brandt"}) {
    CameraInfoFields info = kInfo;
    info.model = model;
    info.d = {0.1, -0.02, 0.003, -0.0004};
    const auto camera = bag_camera(bag_with_camera(info).string());
    ASSERT_TRUE(camera);
    EXPECT_EQ(std::get<EquidistantDistortion>(camera->model.distortion()).coefficients(), info.d);
  }
}

TEST(BagCamera, LooksBesideTheTopic) {
  EXPECT_TRUE(bag_camera(bag_with_camera(kInfo, "/left/image_raw/compressed").string(), ""));
  EXPECT_TRUE(bag_camera(bag_with_camera(kInfo, "/image", "/camera_info").string()));
  EXPECT_FALSE(bag_camera(bag_with_camera(kInfo, "/right/image_raw").string()));
}

/// The picture's pixel (i, j) joins 2 x 3 pixels of the sensor: those from (100 + 2 i, 60 + 3 j) on. A point
/// that the sensor shows at its pixel (u, v) is at i = (u - 100 - 0.5) / 2, j = (v - 60 - 1) / 3.
TEST(BagCamera, HeedsBinningAndRegion) {
  CameraInfoFields info = kInfo;
  info.binning_x = 2;
  info.binning_y = 3;
  info.roi_x = 100;
  info.roi_y = 60;
  info.roi_width = 320;
  info.roi_height = 240;
  const auto camera = bag_camera(bag_with_camera(info).string());
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 160);
  EXPECT_EQ(camera->height, 80);
  const auto full = bag_camera(bag_with_camera(kInfo).string());
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.1, -0.2, 1.0), Eigen::Vector3d(-0.3, 0.15, 1.2)}) {
    const Eigen::Vector2d of_sensor = *full->model.project(point), of_picture = *camera->model.project(point);
    EXPECT_NEAR(of_picture.x(), (of_sensor.x() - 100.5) / 2.0, 1e-9);
    EXPECT_NEAR(of_picture.y(), (of_sensor.y() - 61.0) / 3.0, 1e-9);
  }
}

TEST(BagCamera, TakesTheProjectionMatrixOfRectifiedPictures) {
  const auto camera = bag_camera(bag_with_camera(kInfo, "/left/image_rect").string());
  ASSERT_TRUE(camera);
  EXPECT_EQ(numbers_of(*camera), (std::vector<double>{390, 395, 318, 238, 640, 480}));
  EXPECT_EQ(camera->model.distortion_name(), "none");
}

TEST(BagCamera, SaysThatACameraWasNotCalibrated) {
  CameraInfoFields info = kInfo;
  info.k = std::vector<double>(9, 0.0);
  std::string told;
  EXPECT_FALSE(
      bag_camera(bag_with_camera(info).string(), "", [&](LogLevel, std::string_view text) { told = text; }));
  EXPECT_THAT(told, AllOf(HasSubstr("/left/camera_info"), HasSubstr("not calibrated")));
}

TEST(BagCamera, WarnsOfASmallSkew) {
  CameraInfoFields info = kInfo;
  info.k[1] = 1.5;
  std::string told;
  EXPECT_TRUE(
      bag_camera(bag_with_camera(info).string(), "", [&](LogLevel, std::string_view text) { told = text; }));
  EXPECT_THAT(told, AllOf(HasSubstr("a skew of 1.5 pixels"), HasSubstr("0.89 px")));
}

/// A driver that published before it had read its calibration.
TEST(BagCamera, TakesTheFirstThatWasCalibrated) {
  const fs::path path = temporary_folder() / "camera.mcap";
  CameraInfoFields none = kInfo;
  none.k = std::vector<double>(9, 0.0);
  std::vector<TestMessage> messages = {small_picture("/left/image_raw", kSecond)};
  for (int i = 0; i < 5; ++i)
    messages.push_back({"/left/camera_info", "sensor_msgs/CameraInfo", kSecond * (i + 1),
                        camera_info_message(Wire::kCdr, i < 2 ? none : kInfo)});
  write_mcap(path, Wire::kCdr, messages);
  std::string told;
  const auto camera = bag_camera(path.string(), "", [&](LogLevel, std::string_view text) { told = text; });
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->model.pinhole().fx, 400);
  EXPECT_EQ(told, "");
}

TEST(BagCamera, SaysThatItChanges) {
  const fs::path path = temporary_folder() / "camera.mcap";
  CameraInfoFields other = kInfo;
  other.k[0] = 401;
  std::vector<TestMessage> messages = {small_picture("/left/image_raw", kSecond)};
  for (int i = 0; i < 5; ++i)
    messages.push_back({"/left/camera_info", "sensor_msgs/CameraInfo", kSecond * (i + 1),
                        camera_info_message(Wire::kCdr, i == 4 ? other : kInfo)});
  write_mcap(path, Wire::kCdr, messages);
  std::string told;
  const auto camera = bag_camera(path.string(), "", [&](LogLevel, std::string_view text) { told = text; });
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->model.pinhole().fx, 400);
  EXPECT_THAT(told, HasSubstr("changes within the bag"));
}

TEST(BagCamera, RefusesOtherLenses) {
  const auto refused = [](const CameraInfoFields& info, const std::vector<std::string>& words) {
    const std::string path = bag_with_camera(info).string();
    expect_error(ErrorKind::kInvalidInput, words, [&] { bag_camera(path); });
  };
  CameraInfoFields info = kInfo;
  info.model = "double_sphere";
  refused(info, {"/left/camera_info", "'double_sphere' is not supported"});
  info = kInfo;
  info.k[1] = 50;  // (480 - 1 - 242) / 410 of it at the lower edge; 242 / 410 at the upper one
  refused(info, {"/left/camera_info", "a skew of 50 pixels", "29.51 px", "--fisheye-fix-skew"});
  info = kInfo;
  info.k[8] = 2;
  refused(info, {"/left/camera_info", "0 0 2"});
  info = kInfo;
  info.k[3] = 30;
  refused(info, {"/left/camera_info", "30 410 242"});
  info = kInfo;
  info.d[9] = 0.1;
  refused(info, {"D has 14"});
  info = kInfo;
  info.k[4] = -3;
  refused(info, {"focal lengths must be > 0"});
}

}  // namespace
}  // namespace apriltrack::test
