// Camera files of Basalt, VINS-Fusion and ORB-SLAM3, written out by hand as these programs read them, with no
// two numbers alike.

#include <gmock/gmock.h>

#include "apriltrack/base/error.h"
#include "foreign_camera_file.h"

namespace apriltrack {
namespace {

using test::ForeignCameraFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SlamCameraFile : public ForeignCameraFile {
 protected:
  void expect_refused(const std::string& name, const std::string& text,
                      const std::vector<std::string>& words) {
    try {
      read(name, text);
      ADD_FAILURE() << "is read: " << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      for (const std::string& word : words) EXPECT_THAT(error.what(), HasSubstr(word));
    }
  }
};

// Basalt. cam0 sits at (1, 2, 3) of the IMU, turned by a quarter about z: p_imu = R p + t, R = (0 -1 0; 1 0
// 0; 0 0 1); cam1 at (5, 7, 11), not turned. So p_cam1 = R p_cam0 + (1, 2, 3) - (5, 7, 11).
std::string basalt(const std::string& second_type = "pinhole-radtan8") {
  return R"({"value0": {
  "T_imu_cam": [
    {"px": 1, "py": 2, "pz": 3, "qx": 0, "qy": 0, "qz": 0.7071067811865476, "qw": 0.7071067811865476},
    {"px": 5, "py": 7, "pz": 11, "qx": 0, "qy": 0, "qz": 0, "qw": 1}
  ],
  "intrinsics": [
    {"camera_type": "kb4", "intrinsics": {"fx": 380.5, "fy": 381.25, "cx": 321.5, "cy": 241.75,
      "k1": 0.01, "k2": -0.02, "k3": 0.003, "k4": -0.0004}},
    {"camera_type": ")" +
         second_type + R"(", "intrinsics": {"fx": 269.5, "fy": 270.25, "cx": 322.5, "cy": 228.75,
      "k1": 0.3, "k2": -0.021, "p1": -0.00025, "p2": 0.000061, "k3": 0.0158, "k4": 0.575, "k5": -0.063,
      "k6": 0.034, "rpmax": 2.7276}}
  ],
  "resolution": [[640, 480], [648, 488]],
  "vignette": [], "imu_update_rate": 200.0, "cam_time_offset_ns": 0
}})";
}

TEST_F(SlamCameraFile, BasaltIsARigWithPlaces) {
  EXPECT_THAT(numbers_of("calibration.json", basalt()),
              ElementsAre(380.5, 381.25, 321.5, 241.75, 0.01, -0.02, 0.003, -0.0004, 640, 480));
  EXPECT_EQ(file_.format, CameraFormat::kBasalt);
  ASSERT_EQ(file_.rig.cameras.size(), 2U);
  EXPECT_EQ(file_.rig.cameras[0].model.distortion_name(), "equidistant");
  const Camera& second = file_.rig.cameras[1];
  EXPECT_EQ(second.name, "cam1");
  EXPECT_EQ(second.model.distortion_name(), "radtan");
  // OpenCV's order: k1 k2 p1 p2 k3 k4 k5 k6
  EXPECT_THAT(numbers(second), ElementsAre(269.5, 270.25, 322.5, 228.75, 0.3, -0.021, -0.00025, 0.000061,
                                           0.0158, 0.575, -0.063, 0.034, 648, 488));
  ASSERT_TRUE(second.T_this_previous);
  EXPECT_LT((*second.T_this_previous * Eigen::Vector3d(10, 20, 30) - Eigen::Vector3d(-24, 5, 22)).norm(),
            1e-12);
  EXPECT_THAT(lost(), ElementsAre("extrinsics of cam0: T_imu_cam"));
  std::string text = basalt();
  text.replace(text.find("\"cam_time_offset_ns\": 0"), 23, "\"cam_time_offset_ns\": 52000");
  read_here("calibration.json", text);
  EXPECT_THAT(lost(), ElementsAre("extrinsics of cam0: T_imu_cam", "extrinsics of cam0: cam_time_offset_ns"));
}

TEST_F(SlamCameraFile, BasaltOfOnePinhole) {
  EXPECT_THAT(
      numbers_of("calibration.json", R"({"value0": {"intrinsics": [{"camera_type": "pinhole", "intrinsics":
        {"fx": 500, "fy": 501, "cx": 320, "cy": 240}}], "resolution": [[640, 480]]}})"),
      ElementsAre(500, 501, 320, 240, 640, 480));
  EXPECT_EQ(file_.rig.cameras[0].model.distortion_name(), "none");
}

TEST_F(SlamCameraFile, BasaltOfOtherLensesOrWithoutPlacesIsRefused) {
  for (const char* model : {"ds", "eucm", "ucm", "fov"})
    expect_refused("c.json", basalt(model),
                   {"c.json:9", std::string("'") + model + "' is not supported", "kb4"});
  std::string text = basalt();
  text.replace(text.find("[640, 480], "), 12, "");
  expect_refused("c.json", text, {"resolution", "each of the 2 cameras (has 1)"});
  text = basalt();
  text.replace(text.find("\"qw\": 1}"), 8, "\"qw\": 3}");
  expect_refused("c.json", text, {"T_imu_cam[1]", "must be 1 (is 3)"});
}

// VINS-Fusion.

TEST_F(SlamCameraFile, VinsPinhole) {
  EXPECT_THAT(numbers_of("cam0.yaml", R"(%YAML:1.0
---
model_type: PINHOLE
camera_name: camera
image_width: 752
image_height: 480
distortion_parameters:
   k1: -0.29
   k2: 0.09
   p1: 0.00012
   p2: -0.00003
projection_parameters:
   fx: 461.5
   fy: 460.25
   cx: 363.5
   cy: 248.125
)"),
              ElementsAre(461.5, 460.25, 363.5, 248.125, -0.29, 0.09, 0.00012, -0.00003, 752, 480));
  EXPECT_EQ(file_.format, CameraFormat::kVins);
  EXPECT_THAT(lost(), ElementsAre("names of camera: cam0"));
  EXPECT_EQ(file_.rig.cameras[0].model.distortion_name(), "radtan");
}

TEST_F(SlamCameraFile, VinsFisheyeWhoseCoefficientsBeginAtK2) {
  const std::string head =
      "%YAML:1.0\n---\nmodel_type: KANNALA_BRANDT\nimage_width: 512\nimage_height: 510\n";
  const std::string k = "   k2: -0.01\n   k3: 0.03\n   k4: -0.04\n   k5: 0.016\n";
  const std::string p = "   mu: 190.5\n   mv: 191.25\n   u0: 254.5\n   v0: 256.75\n";
  for (const std::string& text : {"projection_parameters:\n" + k + p,
                                  "distortion_parameters:\n" + k + "projection_parameters:\n" + p}) {
    EXPECT_THAT(numbers_of("cam0.yaml", head + text),
                ElementsAre(190.5, 191.25, 254.5, 256.75, -0.01, 0.03, -0.04, 0.016, 512, 510));
    EXPECT_EQ(file_.rig.cameras[0].model.distortion_name(), "equidistant");
  }
  expect_refused("cam0.yaml",
                 "model_type: MEI\nimage_width: 4\nimage_height: 3\nmirror_parameters: {xi: 2}\n",
                 {"cam0.yaml:1: model_type: 'MEI' is not supported", "kannala-brandt"});
}

// ORB-SLAM.

const std::string kOrbSlamHead = "%YAML:1.0\n\n# Camera Parameters\nFile.version: \"1.0\"\n";
const std::string kOrbSlamSize =
    "Camera.width: 752\nCamera.height: 480\nCamera.fps: 20\n"
    "IMU.T_b_c1: !!opencv-matrix\n   rows: 2\n   cols: 2\n   dt: f\n   data: [1, 0, 0, 1]\n";

std::string orbslam_camera(const std::string& prefix, const std::string& lens) {
  std::string text = "fx: 458.5\nfy: 457.25\ncx: 367.125\ncy: 248.5\n" + lens, all;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at) + 1;
    all += prefix + text.substr(at, end - at);
    at = end;
  }
  return all;
}

TEST_F(SlamCameraFile, OrbSlamOfEitherStyle) {
  for (const std::string prefix : {"Camera1.", "Camera."}) {
    EXPECT_THAT(numbers_of("EuRoC.yaml",
                           kOrbSlamHead + "Camera.type: \"PinHole\"\n" +
                               orbslam_camera(prefix, "k1: -0.28\nk2: 0.07\np1: 0.0002\np2: 0.00002\n") +
                               kOrbSlamSize),
                ElementsAre(458.5, 457.25, 367.125, 248.5, -0.28, 0.07, 0.0002, 0.00002, 752, 480));
    EXPECT_EQ(file_.format, CameraFormat::kOrbSlam);
    EXPECT_THAT(
        numbers_of("TUM.yaml",
                   kOrbSlamHead + "Camera.type: \"PinHole\"\n" +
                       orbslam_camera(prefix, "k1: -0.28\nk2: 0.07\np1: 0.0002\np2: 0.00002\nk3: 1.1\n") +
                       kOrbSlamSize),
        ElementsAre(458.5, 457.25, 367.125, 248.5, -0.28, 0.07, 0.0002, 0.00002, 1.1, 752, 480));
    EXPECT_THAT(
        numbers_of("VI.yaml", kOrbSlamHead + "Camera.type: \"KannalaBrandt8\"\n" +
                                  orbslam_camera(prefix, "k1: 0.003\nk2: 0.0007\nk3: -0.002\nk4: 0.0002\n") +
                                  kOrbSlamSize),
        ElementsAre(458.5, 457.25, 367.125, 248.5, 0.003, 0.0007, -0.002, 0.0002, 752, 480));
    EXPECT_EQ(file_.rig.cameras[0].model.distortion_name(), "equidistant");
  }
  EXPECT_THAT(numbers_of("KITTI.yaml", orbslam_camera("Camera.", "") + kOrbSlamSize),
              ElementsAre(458.5, 457.25, 367.125, 248.5, 752, 480));
}

TEST_F(SlamCameraFile, OrbSlamOfTwoCameras) {
  std::string second = orbslam_camera("Camera2.", "k1: 0.1\nk2: 0.2\nk3: 0.3\nk4: 0.4\n");
  second.replace(second.find("458.5"), 5, "459.5");
  const CameraRig rig = read("stereo.yaml", kOrbSlamHead + "Camera.type: \"KannalaBrandt8\"\n" +
                                                orbslam_camera("Camera1.", "k1: 1\nk2: 2\nk3: 3\nk4: 4\n") +
                                                second + kOrbSlamSize)
                            .rig;
  ASSERT_EQ(rig.cameras.size(), 2U);
  EXPECT_EQ(rig.cameras[1].name, "cam1");
  EXPECT_THAT(numbers(rig.cameras[1]),
              ElementsAre(459.5, 457.25, 367.125, 248.5, 0.1, 0.2, 0.3, 0.4, 752, 480));
  EXPECT_FALSE(rig.cameras[1].T_this_previous);
}

TEST_F(SlamCameraFile, PlacesOfOrbSlamAreToldToBeLost) {
  const std::string lens = "k1: -0.28\nk2: 0.07\np1: 0.0002\np2: 0.00002\n";
  const std::string two = orbslam_camera("Camera1.", lens) + orbslam_camera("Camera2.", lens);
  read_here("stereo.yaml",
            kOrbSlamHead + two + kOrbSlamSize + "Stereo.T_c1_c2: !!opencv-matrix\n   rows: 1\n");
  EXPECT_THAT(lost(), ElementsAre("extrinsics of cam1: Stereo.T_c1_c2", "extrinsics of cam0: IMU.T_b_c1"));
  read_here("old.yaml", orbslam_camera("Camera.", lens) + "Camera.width: 7\nCamera.height: 4\n" +
                            "Camera.bf: 47.9\nTbc: !!opencv-matrix\n   rows: 1\n");
  EXPECT_THAT(lost(), ElementsAre("extrinsics of cam0: Camera.bf", "extrinsics of cam0: Tbc"));
}

TEST_F(SlamCameraFile, OrbSlamThatWouldMisleadIsRefused) {
  const std::string old = orbslam_camera("Camera.", "k1: 0\nk2: 0\np1: 0\np2: 0\n") + kOrbSlamSize;
  expect_refused("EuRoC.yaml", old + "LEFT.K: [1, 2, 3]\n", {"LEFT.K", "of rectified pictures"});
  expect_refused("other.yaml", "Camera.type: \"Sphere\"\n" + old,
                 {"Camera.type: 'Sphere' is not supported", "PinHole"});
}

}  // namespace
}  // namespace apriltrack
