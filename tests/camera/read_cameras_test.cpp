#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <fstream>
#include <locale>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/auto_response.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/camera/ros_topics.h"
#include "support/error_message.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::filesystem::path write_text(const std::string& name, const std::string& text) {
  const auto path = test::temporary_folder() / name;
  std::ofstream(path) << text;
  return path;
}

std::vector<double> coefficients(const Camera& camera) {
  return std::visit([](const auto& lens) { return lens.coefficients(); }, camera.model.distortion());
}

std::vector<double> intrinsics(const Camera& camera) {
  const Pinhole& p = camera.model.pinhole();
  return {p.fx, p.fy, p.cx, p.cy};
}

constexpr const char* kStereo = R"(# two cameras
cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.09, 0.0005, -0.0003]
  distortion_model: radtan
  intrinsics: [520.6, 519.4, 322.4, 237.3]
  resolution: [640, 480]
  rostopic: /left/image_raw
  timeshift_cam_imu: 0.001
  exposure_time: 0.0059
  line_delay: 2.5e-5
  response: gamma:2.2
cam1:
  T_cn_cnm1:
  - [0.0, -1.0, 0.0, 0.1]
  - [0.0, 0.0, -1.0, 0.2]
  - [1.0, 0.0, 0.0, 0.3]
  - [0.0, 0.0, 0.0, 1.0]
  T_cam_imu:
  - [1.0, 0.0, 0.0, 0.0]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_model: equidistant
  distortion_coeffs: [-0.01, 0.02, -0.03, 0.004]
  intrinsics: [470.3, 460.1, 620.7, 534.8]
  resolution: [1280, 1024]
  x_serial: 17
x_note: anything
)";

TEST(RosTopics, AreThoseOfTheCamerasThatHaveOne) {
  using ::testing::Pair;
  EXPECT_THAT(ros_topics(write_text("camera.yaml", kStereo)), ElementsAre(Pair("cam0", "/left/image_raw")));
  EXPECT_THAT(
      ros_topics(write_text("other.yaml", "camera_matrix: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nrostopic: /a\n")),
      IsEmpty());
}

TEST(RosTopics, GoByTheCamerasLabel) {
  using ::testing::Pair;
  std::string labelled = kStereo;
  labelled.insert(labelled.find("  rostopic"), "  label: left\n");
  EXPECT_THAT(ros_topics(write_text("camera.yaml", labelled)), ElementsAre(Pair("left", "/left/image_raw")));
}

TEST(RosTopics, AreNotInFilesThatAreNoYaml) {
  const auto path = write_text(
      "cameras.txt", "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 PINHOLE 640 480 500 501 320 240\n");
  EXPECT_EQ(read_cameras(path).cameras.size(), 1U);
  EXPECT_THAT(ros_topics(path), IsEmpty());
}

TEST(ReadCameras, ReadsKalibrsCamchain) {
  const CameraRig rig = read_cameras(write_text("camera.yaml", kStereo));
  ASSERT_EQ(rig.cameras.size(), 2U);
  const Camera& left = rig.find("cam0");
  EXPECT_THAT(intrinsics(left), ElementsAre(520.6, 519.4, 322.4, 237.3));
  EXPECT_EQ(left.model.distortion_name(), "radtan");
  EXPECT_THAT(coefficients(left), ElementsAre(-0.28, 0.09, 0.0005, -0.0003));
  EXPECT_EQ(left.width, 640);
  EXPECT_EQ(left.height, 480);
  EXPECT_EQ(left.exposure_s, 0.0059);
  EXPECT_EQ(left.line_delay_s, 2.5e-5);
  EXPECT_EQ(left.response.name(), "gamma:2.2");
  EXPECT_FALSE(left.T_this_previous);

  const Camera& right = rig.find("cam1");
  EXPECT_EQ(right.model.distortion_name(), "equidistant");
  EXPECT_THAT(coefficients(right), ElementsAre(-0.01, 0.02, -0.03, 0.004));
  EXPECT_FALSE(right.exposure_s);
  EXPECT_EQ(right.line_delay_s, 0.0);
  EXPECT_EQ(right.response.name(), "srgb");
  // Row by row: x_1 = -y_0 + 0.1, y_1 = -z_0 + 0.2, z_1 = x_0 + 0.3.
  const Eigen::Vector3d point_cam0(1.0, 2.0, 5.0);
  EXPECT_TRUE((*right.T_this_previous * point_cam0).isApprox(Eigen::Vector3d(-1.9, -4.8, 1.3), 1e-12));
  EXPECT_THAT(rig.T_camera_rig(1), test::PoseNear(*right.T_this_previous, 1e-15, 1e-15));
  EXPECT_THAT(rig.T_camera_rig(0), test::PoseNear(Pose(), 0.0, 0.0));
}

TEST(ReadCameras, NamesCamerasWhoseResponseIsToBeEstimated) {
  std::string text = kStereo;
  text.replace(text.find("gamma:2.2"), 9, "auto");
  const std::filesystem::path file = write_text("camera.yaml", text);
  const UnestimatedRig read = read_cameras_to_estimate(file);
  EXPECT_THAT(read.to_estimate, ElementsAre("cam0"));
  EXPECT_EQ(read.rig.find("cam0").response.name(), "srgb");
  EXPECT_THROW(read_cameras(file), Error);
  EXPECT_TRUE(read_cameras_to_estimate(write_text("camera.yaml", kStereo)).to_estimate.empty());
}

TEST(ReadCameras, ChainsThePlacesOfARig) {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    text += "cam" + std::to_string(i) + ":\n  camera_model: pinhole\n  intrinsics: [500, 500, 320, 240]\n" +
            "  distortion_model: none\n  resolution: [640, 480]\n";
    if (i == 1) text += "  T_cn_cnm1: [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
    if (i == 2) text += "  T_cn_cnm1: [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  }
  const CameraRig rig = read_cameras(write_text("camera.yaml", text));
  // First the turn, then the shift: (1, 2, 3) -> (-2, 1, 3) -> (3, 1, 3).
  EXPECT_TRUE((rig.T_camera_rig(2) * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(3, 1, 3), 1e-12));
}

TEST(ReadCameras, BringsAnAlmostRotationToTheNearestOne) {
  const CameraRig rig = read_cameras(write_text("camera.yaml", R"(
cam0: {camera_model: pinhole, intrinsics: [5, 5, 3, 2], distortion_model: none, resolution: [6, 4]}
cam1:
  camera_model: pinhole
  intrinsics: [5, 5, 3, 2]
  distortion_model: none
  resolution: [6, 4]
  T_cn_cnm1: [[0.0001, -1.0001, 0, 1], [1.0002, 0.0, 0, 2], [0, 0, 0.9999, 3], [0, 0, 0, 1]]
)"));
  const Eigen::Matrix3d R = rig.cameras[1].T_this_previous->rotation_matrix();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_NEAR(R(0, 1), -1.0, 1e-7);
  EXPECT_NEAR(R(1, 0), 1.0, 1e-7);
}

TEST(ReadCameras, ReadsRosCameraInfo) {
  const std::string head =
      "image_width: 752\nimage_height: 480\ncamera_name: left\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [458.6, 0.0, 367.2, 0.0, 457.3, 248.4, 0.0, 0.0, 1.0]\n";
  const std::string tail =
      "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [400, 0, 1, 0, 0, 4, 2, 0, 0, 0, 1, 0]\n";
  struct Case {
    std::string model;
    std::vector<double> values;
    std::string data;
    std::string expected_model;
  };
  const std::vector<Case> cases = {
      {"plumb_bob", {-0.28, 0.07, 0.0002, 1.8e-5, 0.01}, "[-0.28, 0.07, 0.0002, 1.8e-05, 0.01]", "radtan"},
      {"rational_polynomial",
       {0.8, -1.5, 0.1, 0.2, 3.2, 0.5, 0.16, -0.11},
       "[0.8, -1.5, 0.1, 0.2, 3.2, 0.5, 0.16, -0.11]",
       "radtan"},
      {"equidistant", {0.1, 0.2, 0.3, 0.4}, "[0.1, 0.2, 0.3, 0.4]", "equidistant"},
      {"fisheye", {0.1, 0.2, 0.3, 0.4}, "[0.1, 0.2, 0.3, 0.4]", "equidistant"},
  };
  for (const Case& c : cases) {
    const auto size = std::to_string(c.values.size());
    const CameraRig rig =
        read_cameras(write_text("info.yaml", head + "distortion_model: " + c.model +
                                                 "\ndistortion_coefficients:\n  rows: 1\n  cols: " + size +
                                                 "\n  data: " + c.data + "\n" + tail));
    ASSERT_EQ(rig.cameras.size(), 1U);
    EXPECT_THAT(intrinsics(rig.find("cam0")), ElementsAre(458.6, 457.3, 367.2, 248.4));
    EXPECT_EQ(rig.cameras[0].model.distortion_name(), c.expected_model);
    EXPECT_EQ(coefficients(rig.cameras[0]), c.values);
    EXPECT_EQ(rig.cameras[0].width, 752);
    EXPECT_EQ(rig.cameras[0].height, 480);
  }
}

TEST(ReadCameras, ReadsOpenCvFileStorage) {
  const CameraRig rig = read_cameras(write_text("calibration.yml", R"(%YAML:1.0
---
calibration_time: "Thu 01 Jan 1970"
image_width: 1280
image_height: 720
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 9.1e+02, 0., 6.4e+02, 0., 9.05e+02,
       3.6e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -1.e-01, 2.e-02, 3.e-03, -4.e-04, 5.e-05 ]
avg_reprojection_error: 3.1e-01
)"));
  EXPECT_THAT(intrinsics(rig.cameras[0]), ElementsAre(910.0, 905.0, 640.0, 360.0));
  EXPECT_THAT(coefficients(rig.cameras[0]), ElementsAre(-0.1, 0.02, 0.003, -0.0004, 5e-5));
  EXPECT_EQ(rig.cameras[0].width, 1280);
  EXPECT_EQ(rig.cameras[0].height, 720);
}

TEST(ReadCameras, ReadsTheOtherNamesThatOpenCvProgramsUse) {
  const std::string matrix = "[[400, 0, 300], [0, 410, 200], [0, 0, 1]]\n";
  for (const std::string coefficient_name :
       {"distortion_vector", "dist_coeffs", "distortion_coefficients", "D"}) {
    const auto rig = read_cameras(
        write_text("c.yaml", "%YAML:1.0\nK: " + matrix + coefficient_name + ": [0.1, 0.2, 0.3, 0.4]\n"));
    EXPECT_THAT(intrinsics(rig.cameras[0]), ElementsAre(400, 410, 300, 200));
    EXPECT_THAT(coefficients(rig.cameras[0]), ElementsAre(0.1, 0.2, 0.3, 0.4)) << coefficient_name;
    EXPECT_EQ(rig.cameras[0].width, 0);
  }
  const auto fisheye =
      read_cameras(write_text("f.yaml", "K: " + matrix + "D: [0.1, 0.2, 0.3, 0.4]\nfisheye_model: 1\n"));
  EXPECT_EQ(fisheye.cameras[0].model.distortion_name(), "equidistant");
}

TEST(ReadCameras, DropsATailOfZerosOnly) {
  for (const std::string tail : {", 0, 0, 0, 0", ", 0, 0, 0, 0, 0., 0"}) {
    const auto rig = read_cameras(write_text(
        "c.yaml",
        "K: [4, 0, 3, 0, 5, 2, 0, 0, 1]\nD: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8" + tail + "]\n"));
    EXPECT_THAT(coefficients(rig.cameras[0]), ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8));
  }
}

TEST(ReadCameras, ReadsWpilibAndPhotonVisionJson) {
  const auto wpilib = read_cameras(write_text("camera.json", R"({
    "avg_reprojection_error": 0.57,
    "camera_matrix": [1706.8, 0.0, 960.5, 0.0, 1700.0, 554.3, 0.0, 0.0, 1.0],
    "distortion_coefficients": [0.8, -1.5, -0.002, 0.001, 3.2, 0.57, 0.16, -0.11, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
})"));
  EXPECT_THAT(intrinsics(wpilib.cameras[0]), ElementsAre(1706.8, 1700.0, 960.5, 554.3));
  EXPECT_THAT(coefficients(wpilib.cameras[0]), ElementsAre(0.8, -1.5, -0.002, 0.001, 3.2, 0.57, 0.16, -0.11));
  EXPECT_EQ(wpilib.cameras[0].width, 0);
  EXPECT_NO_THROW(check_resolution(wpilib.cameras[0], 1920, 1080, "any"));

  const auto photon = read_cameras(write_text(
      "photon.json",
      R"({"resolution":{"width":1280.0,"height":720},"cameraIntrinsics":{"rows":3,"cols":3,"type":6,"data":[910.5,0.0,)"
      R"(640.25,0.0,905.5,360.75,0.0,0.0,1.0]},"distCoeffs":{"rows":1,"cols":5,"type":6,"data":[0.1,-0.2,0.003,0.004,)"
      R"(0.5]},"calobjectWarp":[0.0,1.0],"observations":[],"lensmodel":"LENSMODEL_OPENCV"})"));
  EXPECT_THAT(intrinsics(photon.cameras[0]), ElementsAre(910.5, 905.5, 640.25, 360.75));
  EXPECT_THAT(coefficients(photon.cameras[0]), ElementsAre(0.1, -0.2, 0.003, 0.004, 0.5));
  EXPECT_EQ(photon.cameras[0].width, 1280);
  EXPECT_EQ(photon.cameras[0].height, 720);
}

// PhotonVision/photonvision, CameraCalibrationCoefficients.java: until 2023 the key of the coefficients was
// "cameraExtrinsics", which is an alias of distCoeffs since.
TEST(ReadCameras, ReadsOlderPhotonVisionJson) {
  const auto photon = read_cameras(write_text(
      "photon.json",
      R"({"resolution":{"width":1280.0,"height":720.0},"cameraIntrinsics":{"rows":3,"cols":3,"type":6,"data":[910.5,)"
      R"(0.0,640.25,0.0,905.5,360.75,0.0,0.0,1.0]},"cameraExtrinsics":{"rows":1,"cols":5,"type":6,"data":[0.1,-0.2,)"
      R"(0.003,0.004,0.5]},"perViewErrors":[0.1],"standardDeviation":0.2})"));
  EXPECT_THAT(coefficients(photon.cameras[0]), ElementsAre(0.1, -0.2, 0.003, 0.004, 0.5));
}

TEST(ReadCameras, AnEmptyFileIsCalledSo) {
  for (const char* text : {"", " \n\t\n"})
    EXPECT_THAT(test::message_of([&] { read_cameras(write_text("camera.yaml", text)); }),
                HasSubstr("camera.yaml: is empty"));
}

TEST(ReadCameras, ReadsEurocSensorFiles) {
  const auto rig = read_cameras(write_text("sensor.yaml", R"(# General sensor definitions.
sensor_type: camera
comment: VI-Sensor cam0 (MT9M034)
T_BS:
  cols: 4
  rows: 4
  data: [0.01, -0.99, 0.0, -0.02, 0.99, 0.01, 0.02, -0.06, -0.02, 0.0, 0.99, 0.0, 0.0, 0.0, 0.0, 1.0]
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
)"));
  EXPECT_THAT(intrinsics(rig.cameras[0]), ElementsAre(458.654, 457.296, 367.215, 248.375));
  EXPECT_THAT(coefficients(rig.cameras[0]), ElementsAre(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05));
  EXPECT_EQ(rig.cameras[0].width, 752);
}

TEST(ReadCameras, WarnsOfOddButPossibleCameras) {
  std::vector<std::string> warnings;
  const LogSink log = [&](LogLevel, std::string_view text) { warnings.emplace_back(text); };
  const auto read = [&](const std::string& intrinsics, const std::string& k1) {
    warnings.clear();
    read_cameras(write_text("c.yaml", "cam0:\n  camera_model: pinhole\n  intrinsics: " + intrinsics +
                                          "\n  distortion_model: radtan\n  distortion_coeffs: [" + k1 +
                                          ", 0, 0, 0]\n  resolution: [640, 480]\n"),
                 log);
    return warnings;
  };
  EXPECT_THAT(read("[500, 500, 320, 240]", "0.0"), IsEmpty());
  EXPECT_THAT(read("[500, 500, 700, 240]", "0.0"),
              ElementsAre(HasSubstr("principal point (700, 240) lies at the edge")));
  EXPECT_THAT(read("[500, 500, 0, 0]", "0.0"),
              ElementsAre(HasSubstr("principal point (0, 0) lies at the edge")));
  // 2 atan(400 / 0.52) = 179.9 degrees; 2 atan(400 / 50000) = 0.92.
  EXPECT_THAT(read("[0.52, 0.52, 320, 240]", "0.0"),
              ElementsAre(HasSubstr("a field of view of 180 degrees")));
  EXPECT_THAT(read("[50000, 50000, 320, 240]", "0.0"),
              ElementsAre(HasSubstr("a field of view of 0.917 degrees")));
  EXPECT_THAT(read("[120, 120, 320, 240]", "0.0"), IsEmpty()) << "147 degrees";
  EXPECT_THAT(read("[300, 300, 320, 240]", "-0.4"), ElementsAre(HasSubstr("4 of the picture's corners")));
}

/// A decimal comma and thousands apart, as a German program would set it.
class CommaNumbers : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(ReadCameras, DoesNotCareForTheProgramsLocale) {
  const auto path = write_text("camera.yaml", kStereo);
  const auto copy = path.parent_path() / "copy.yaml";
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaNumbers));
  const char* c_before = std::setlocale(LC_NUMERIC, nullptr);
  const std::string c_name = c_before ? c_before : "C";
  std::setlocale(LC_NUMERIC, "de_DE.UTF-8");  // where it is installed
  const CameraRig rig = read_cameras(path);
  write_cameras(copy, rig);
  const CameraRig again = read_cameras(copy);
  std::setlocale(LC_NUMERIC, c_name.c_str());
  std::locale::global(before);
  EXPECT_THAT(intrinsics(rig.cameras[1]), ElementsAre(470.3, 460.1, 620.7, 534.8));
  EXPECT_THAT(intrinsics(again.cameras[1]), ElementsAre(470.3, 460.1, 620.7, 534.8));
  EXPECT_EQ(again.cameras[1].width, 1280);
}

TEST(SharedCameras, AllRecordingsCamerasAreRead) {
  APRILTRACK_SHARED_OR_SKIP(data, "data");
  int count = 0;
  for (const auto& folder : std::filesystem::directory_iterator(data)) {
    for (const char* name : {"camera.yaml", "camera_wpilib.json"}) {
      if (!std::filesystem::exists(folder.path() / name)) continue;
      CameraRig rig;
      ASSERT_NO_THROW(rig = read_cameras(folder.path() / name)) << folder.path();
      for (const Camera& camera : rig.cameras) EXPECT_GT(camera.model.pinhole().fx, 100.0);
      ++count;
    }
  }
  EXPECT_GE(count, 11);
}

TEST(SharedCameras, TheRoomsCameraIsTheOneItsReadmeNames) {
  APRILTRACK_SHARED_OR_SKIP(path, "data/room_gentle/camera.yaml");
  const Camera camera = read_cameras(path).find("cam0");
  EXPECT_THAT(intrinsics(camera), ElementsAre(520.6, 519.4, 322.4, 237.3));
  EXPECT_THAT(coefficients(camera), ElementsAre(-0.28, 0.09, 0.0005, -0.0003));
  EXPECT_EQ(camera.exposure_s, 0.005953);
}

}  // namespace
}  // namespace apriltrack
