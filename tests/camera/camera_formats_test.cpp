// Foreign camera files, written out by hand as their own programs write them, with no two numbers alike.

#include "apriltrack/camera/camera_formats.h"

#include <gmock/gmock.h>

#include <fstream>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/io/atomic_file.h"
#include "foreign_camera_file.h"
#include "support/error_message.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using test::ForeignCameraFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kEcho = R"(header:
  stamp:
    sec: 1700000001
    nanosec: 5
  frame_id: optical
height: 481
width: 641
distortion_model: plumb_bob
d:
- 0.1
- -0.2
- 0.003
- -0.004
- 0.05
k:
- 606.5
- 0.0
- 317.25
- 0.0
- 608.75
- 255.5
- 0.0
- 0.0
- 1.0
binning_x: 0
binning_y: 0
roi:
  x_offset: 0
  y_offset: 0
  height: 0
  width: 0
  do_rectify: false
---
)";

/// The picture's pixel (i, j) joins 2 x 3 pixels of the sensor, those from (100 + 2 i, 60 + 3 j) on, whose
/// centre is at (100.5 + 2 i, 61 + 3 j).
TEST_F(ForeignCameraFile, EchoOfABinnedPartOfTheSensor) {
  std::string echo = kEcho;
  for (const auto& [from, to] : {std::pair("binning_x: 0", "binning_x: 2"),
                                 {"binning_y: 0", "binning_y: 3"},
                                 {"x_offset: 0", "x_offset: 100"},
                                 {"y_offset: 0", "y_offset: 60"},
                                 {"  width: 0", "  width: 320"},
                                 {"  height: 0", "  height: 240"}})
    echo.replace(echo.find(from), std::string(from).size(), to);
  EXPECT_THAT(numbers_of("echo.yaml", echo),
              ElementsAre(606.5 / 2, 608.75 / 3, (317.25 - 100.5) / 2, (255.5 - 61.0) / 3, 0.1, -0.2, 0.003,
                          -0.004, 0.05, 160, 80));
}

TEST_F(ForeignCameraFile, EchoOfRos2) {
  EXPECT_THAT(numbers_of("echo.yaml", kEcho),
              ElementsAre(606.5, 608.75, 317.25, 255.5, 0.1, -0.2, 0.003, -0.004, 0.05, 641, 481));
  EXPECT_EQ(file_.format, CameraFormat::kRosCameraInfo);
  EXPECT_EQ(file_.rig.cameras[0].response_origin, ResponseOrigin::kAssumed);
  EXPECT_THAT(lost(), ElementsAre("names of optical: cam0"));
}

TEST_F(ForeignCameraFile, EchoesOfSeveralMessagesAreRefusedWithTheWayOut) {
  EXPECT_THAT(test::message_of([&] { read("echo.yaml", std::string(kEcho) + kEcho); }),
              HasSubstr("ros2 topic echo --once"));
}

TEST_F(ForeignCameraFile, EchoOfRos1) {
  const char* text = R"(header: 
  seq: 1
  frame_id: "camera"
height: 480
width: 640
distortion_model: "equidistant"
D: [0.1, 0.2, -0.3, 0.4]
K: [606.9, 0.0, 317.1, 0.0, 608.7, 255.8, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [1.0, 0.0, 2.0, 0.0, 0.0, 3.0, 4.0, 0.0, 0.0, 0.0, 1.0, 0.0]
---
)";
  EXPECT_THAT(numbers_of("echo.yaml", text),
              ElementsAre(606.9, 608.7, 317.1, 255.8, 0.1, 0.2, -0.3, 0.4, 640, 480));
  EXPECT_EQ(file_.rig.cameras[0].model.distortion_name(), "equidistant");
  EXPECT_THAT(lost(), ElementsAre("names of camera: cam0", "rectification of cam0: P"));
}

TEST_F(ForeignCameraFile, KalibrWithKeysOfTagSlamAndOpenVins) {
  const char* text = R"(cam0:
  T_imu_cam:
    - [0.0, -1.0, 0.0, 0.1]
    - [1.0, 0.0, 0.0, 0.2]
    - [0.0, 0.0, 1.0, 0.3]
    - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  intrinsics: [1404.5, 1403.5, 962.25, 605.75]
  distortion_model: radtan
  distortion_coeffs: [-0.16, 0.09, -3e-5, -3e-4, 0.000000]
  resolution: [1920, 1200]
  tagtopic: /detector/tags
  rig_body: rig
x_lab: second floor
)";
  EXPECT_THAT(numbers_of("cameras.yaml", text),
              ElementsAre(1404.5, 1403.5, 962.25, 605.75, -0.16, 0.09, -3e-5, -3e-4, 0.0, 1920, 1200));
  EXPECT_EQ(file_.format, CameraFormat::kKalibr);
  EXPECT_THAT(lost(), ElementsAre("extrinsics of cam0: T_imu_cam", "camera_keys of cam0: tagtopic, rig_body",
                                  "camera_keys of cam0: x_lab"));
  EXPECT_THAT(warnings_, IsEmpty()) << "of no concern but to a conversion";
}

std::string ros_fisheye(const std::string& skew) {
  return "image_width: 3280\nimage_height: 2464\ncamera_name: wide\ncamera_matrix:\n  rows: 3\n  cols: 3\n  "
         "data: "
         "[1138.5, " +
         skew +
         ", 1635.5,\n            0.     , 1140.0, 1208.0,\n            0.     ,    0.     ,    1.     ]\n"
         "distortion_model: equidistant\ndistortion_coefficients:\n  rows: 1\n  cols: 4\n"
         "  data: [0.03, 0.009, -0.0017, 0.001]\n";
}

TEST_F(ForeignCameraFile, SmallSkewOfRosIsReadWithAWarningOfHowFarItMovesPoints) {
  EXPECT_THAT(numbers_of("skew.yaml", ros_fisheye("-0.75")),
              ElementsAre(1138.5, 1140.0, 1635.5, 1208.0, 0.03, 0.009, -0.0017, 0.001, 3280, 2464));
  // 0.75 (2463 - 1208) / 1140 at the last row, which is farther from cy than the first.
  EXPECT_THAT(warnings_,
              ElementsAre(testing::AllOf(
                  HasSubstr("skew.yaml:4: camera_matrix: a skew of -0.75 pixels is passed over; points move "
                            "by up to 0.83 px"),
                  HasSubstr("cameracalibrator --fisheye-fix-skew"))));
  EXPECT_EQ(file_.lost.at(0).kind, LossKind::kSkew);
  EXPECT_NO_THROW(read("skew.yaml", ros_fisheye("0.905")));  // 0.996 px
  EXPECT_THROW(read("skew.yaml", ros_fisheye("0.91")), Error) << "moves by 1.002 px";
}

constexpr const char* kIni = R"(# Camera intrinsics

[image]

width
640

height
480

[narrow_stereo/left]

camera matrix
369.25 0.00000 320.75
0.00000 367.5 203.125
0.00000 0.00000 1.00000

distortion
-0.19 0.018 -0.0006 0.0005 0.02

rectification
1.00000 0.00000 0.00000
0.00000 1.00000 0.00000
0.00000 0.00000 1.00000

projection
262.9 0.00000 320.9 0.00000
0.00000 302.0 188.5 0.00000
0.00000 0.00000 1.00000 0.00000
)";

TEST_F(ForeignCameraFile, RosIni) {
  EXPECT_THAT(numbers_of("cal.ini", kIni),
              ElementsAre(369.25, 367.5, 320.75, 203.125, -0.19, 0.018, -0.0006, 0.0005, 0.02, 640, 480));
  EXPECT_EQ(file_.format, CameraFormat::kRosIni);
  EXPECT_THAT(lost(), ElementsAre("names of narrow_stereo/left: cam0", "rectification of cam0: projection"));
  std::string right = kIni;
  right.replace(right.find("320.9 0.00000"), 13, "320.9 -26.29");
  read_here("right.ini", right);
  EXPECT_EQ(lost().back(), "extrinsics of cam0: projection");
  EXPECT_NEAR(file_.lost.back().numbers[0], 0.1, 1e-15);
}

TEST_F(ForeignCameraFile, RosIniWithEightCoefficients) {
  std::string text = kIni;
  text.replace(text.find("-0.19 0.018"), 32, "0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8");
  EXPECT_THAT(numbers_of("cal.ini", text),
              ElementsAre(369.25, 367.5, 320.75, 203.125, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 640, 480));
}

// A vertical tab separates no words, so that a line of it is a name; as a line without words it was read past
// its end.
TEST_F(ForeignCameraFile, RosIniWithALineOfAVerticalTab) {
  EXPECT_THROW(read("cal.ini", "[]\n\v\ncamera matrix"), Error);
  EXPECT_THROW(read("cal.ini", "[image]\n\v\n640\n[camera]\ncamera matrix\n\f\n"), Error);
}

TEST_F(ForeignCameraFile, NumbersOfPicturesThatWereMadeSmallerAreWarnedOf) {
  read(
      "transforms.json",
      R"({"w": 1280, "h": 960, "fl_x": 606.5, "fl_y": 608.75, "cx": 317.5, "cy": 245.0, "camera_model": "OPENCV"})");
  EXPECT_THAT(warnings_,
              ElementsAre(HasSubstr(
                  "is the middle of a picture of 635 x 490 pixels, but the file is of 1280 x 960")));
}

TEST_F(ForeignCameraFile, WpilibPhotonVisionOpenCvAndEurocAreToldApart) {
  const std::string matrix = "[400.0, 0.0, 300.0, 0.0, 410.0, 200.0, 0.0, 0.0, 1.0]";
  const auto format_of = [&](const std::string& name, const std::string& text) {
    return read(name, text).format;
  };
  EXPECT_EQ(
      format_of("c.json", R"({"camera_matrix": )" + matrix + R"(, "distortion_coefficients": [0, 0, 0, 0]})"),
      CameraFormat::kWpilib);
  EXPECT_EQ(format_of("c.json", R"({"cameraIntrinsics": {"data": )" + matrix +
                                    R"(}, "distCoeffs": {"data": [0, 0, 0, 0]}})"),
            CameraFormat::kPhotonVision);
  EXPECT_EQ(
      format_of(
          "c.json",
          R"({"camera_matrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d", "data": )" +
              matrix + R"(}, "distortion_coefficients": [0, 0, 0, 0]})"),
      CameraFormat::kOpenCv);
  EXPECT_EQ(format_of("c.yml", "%YAML:1.0\n---\nK: " + matrix + "\nD: [0, 0, 0, 0]\n"),
            CameraFormat::kOpenCv);
  EXPECT_EQ(
      format_of("c.yaml", "camera_matrix: {rows: 3, cols: 3, data: " + matrix +
                              "}\ndistortion_model: plumb_bob\ndistortion_coefficients: [0, 0, 0, 0, 0]\n"),
      CameraFormat::kRosCameraInfo);
  EXPECT_EQ(format_of("sensor.yaml",
                      "intrinsics: [5, 5, 3, 2]\nresolution: [6, 4]\ndistortion_model: radial-tangential\n"
                      "distortion_coefficients: [0.1, 0.2, 0.3, 0.4]\n"),
            CameraFormat::kEuroc);
}

TEST_F(ForeignCameraFile, NamesNoResponseTables) {
  for (const auto& [name, text] :
       {std::pair<std::string, std::string>{"cal.ini", kIni},
        {"cameras.txt", "1 PINHOLE 640 480 600 610 320 241\n"},
        {"c.cameramodel", "{ 'lensmodel': 'LENSMODEL_PINHOLE', 'imagersize': [7, 4] }"}}) {
    const auto path = test::temporary_folder() / name;
    std::ofstream(path) << text;
    EXPECT_THAT(response_tables(path), IsEmpty()) << name;
  }
}

/// As Windows' editors leave files: a byte order mark, lines that end in CR LF.
TEST(CameraFormats, AreReadAsWindowsWritesThem) {
  const auto folder = test::temporary_folder();
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string text :
       {"1 OPENCV 640 480 500 510 319.5 239.5 0.1 -0.2 0.003 0.004\r\n",
        "{ 'lensmodel': 'LENSMODEL_OPENCV4',\r\n 'intrinsics': [500, 510, 319, 239, 0.1, -0.2, "
        "0.003, 0.004],\r\n 'imagersize': [640, 480],\r\n 'extrinsics': [0,0,0,0,0,0] }\r\n"}) {
    write_file_atomically(folder / "camera", mark + text);
    const Camera camera = read_cameras(folder / "camera").cameras.at(0);
    EXPECT_EQ(camera.model.pinhole().fx, 500);
    EXPECT_EQ(camera.model.pinhole().cx, 319);
    EXPECT_EQ(std::get<RadtanDistortion>(camera.model.distortion()).coefficients(),
              (std::vector{0.1, -0.2, 0.003, 0.004}));
  }
}

TEST(CameraFormats, AreFoundByNameAndByEnding) {
  for (const CameraFormatInfo& info : camera_formats())
    EXPECT_EQ(camera_format_named(info.name), info.format);
  EXPECT_EQ(camera_format_named("matlab"), std::nullopt);
  EXPECT_EQ(camera_format_of_ending("a/b.cameramodel"), CameraFormat::kMrcal);
  EXPECT_EQ(camera_format_of_ending("cameras.txt"), CameraFormat::kColmap);
  EXPECT_EQ(camera_format_of_ending("camera.yaml"), CameraFormat::kKalibr);
  EXPECT_EQ(camera_format_of_ending("a.yaml/camera.yml"), CameraFormat::kKalibr);
  EXPECT_EQ(camera_format_of_ending("camera.json"), std::nullopt);
  EXPECT_EQ(camera_format_of_ending("camera"), std::nullopt);
}

}  // namespace
}  // namespace apriltrack
