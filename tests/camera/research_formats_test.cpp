// Camera files of COLMAP, mrcal, nerfstudio and OpenImuCameraCalibrator, written out by hand as these
// programs write them, with no two numbers alike.

#include <gmock/gmock.h>

#include "foreign_camera_file.h"

namespace apriltrack {
namespace {

using test::ForeignCameraFile;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST_F(ForeignCameraFile, ColmapWhosePixelsAreHalfAPixelOff) {
  const std::string head =
      "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, "
      "PARAMS[]\n# Number of cameras: 1\n";
  struct Case {
    std::string line;
    std::vector<double> expected;
    std::string model;
  };
  const std::vector<Case> cases = {
      {"1 SIMPLE_PINHOLE 640 480 600 320 241", {600, 600, 319.5, 240.5, 640, 480}, "none"},
      {"1 PINHOLE 640 480 600 610 320 241", {600, 610, 319.5, 240.5, 640, 480}, "none"},
      {"3 SIMPLE_RADIAL 640 480 600 320 241 0.1", {600, 600, 319.5, 240.5, 0.1, 0, 0, 0, 640, 480}, "radtan"},
      {"1 RADIAL 640 480 600 320 241 0.1 -0.2",
       {600, 600, 319.5, 240.5, 0.1, -0.2, 0, 0, 640, 480},
       "radtan"},
      {"1 OPENCV 640 480 600 610 320 241 0.1 -0.2 0.003 0.004",
       {600, 610, 319.5, 240.5, 0.1, -0.2, 0.003, 0.004, 640, 480},
       "radtan"},
      {"1 FULL_OPENCV 640 480 600 610 320 241 0.1 -0.2 0.003 0.004 0.05 0.06 0.07 0.08",
       {600, 610, 319.5, 240.5, 0.1, -0.2, 0.003, 0.004, 0.05, 0.06, 0.07, 0.08, 640, 480},
       "radtan"},
      {"1 SIMPLE_RADIAL_FISHEYE 640 480 600 320 241 0.1",
       {600, 600, 319.5, 240.5, 0.1, 0, 0, 0, 640, 480},
       "equidistant"},
      {"1 RADIAL_FISHEYE 640 480 600 320 241 0.1 -0.2",
       {600, 600, 319.5, 240.5, 0.1, -0.2, 0, 0, 640, 480},
       "equidistant"},
      {"1 OPENCV_FISHEYE 640 480 600 610 320 241 0.1 -0.2 0.03 0.04",
       {600, 610, 319.5, 240.5, 0.1, -0.2, 0.03, 0.04, 640, 480},
       "equidistant"},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(numbers_of("cameras.txt", head + c.line + "\n"), c.expected) << c.line;
    EXPECT_EQ(file_.rig.cameras[0].model.distortion_name(), c.model) << c.line;
    EXPECT_EQ(file_.format, CameraFormat::kColmap);
  }
}

TEST_F(ForeignCameraFile, ColmapOfSeveralCamerasIsARigWithoutPlaces) {
  const CameraRig rig =
      read("cameras.txt", "7 PINHOLE 640 480 600 610 320 241\r\n9 PINHOLE 320 240 300 305 160 121\r\n").rig;
  ASSERT_EQ(rig.cameras.size(), 2U);
  EXPECT_EQ(rig.cameras[1].name, "cam1");
  EXPECT_THAT(numbers(rig.cameras[1]), ElementsAre(300, 305, 159.5, 120.5, 320, 240));
  EXPECT_FALSE(rig.cameras[1].T_this_previous);
}

TEST_F(ForeignCameraFile, Mrcal) {
  const char* text = R"(# generated on 2023-01-02 with mrcal-calibrate-cameras --lensmodel LENSMODEL_OPENCV8
# more
{
    'lensmodel':  'LENSMODEL_OPENCV8',

    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....
    'intrinsics': [ 1761.5, 1761.25, 1965.75, 1087.5, -0.01, 0.02, -0.003, 0.004, 5e-05, 0.6, 0.07, 0.008,],

    'valid_intrinsics_region': [
     [ 3, 4 ],
     [ 5, 6 ],
    ],
    # extrinsics are rt_fromref
    'extrinsics': [ 0.1, -0, 0, 0, 2, 0,],

    'imagersize': [ 4000, 2200,],

    'icam_intrinsics': 0,

    'optimization_inputs': b'P)h>@6aWAK2mt$eR#N0}0001)0RR#L6aW~#{,}[]:&*!|>%`"',

}
)";
  EXPECT_THAT(numbers_of("left.cameramodel", text),
              ElementsAre(1761.5, 1761.25, 1965.75, 1087.5, -0.01, 0.02, -0.003, 0.004, 5e-05, 0.6, 0.07,
                          0.008, 4000, 2200));
  EXPECT_EQ(file_.format, CameraFormat::kMrcal);
  ASSERT_EQ(file_.lost.size(), 1U);
  EXPECT_EQ(file_.lost[0].kind, LossKind::kExtrinsics);
}

TEST_F(ForeignCameraFile, MrcalOfOtherVersionsAndModels) {
  EXPECT_THAT(numbers_of("c.cameramodel",
                         "{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [ 5., 6., 3., 2. ],\n"
                         "'rt_cam_ref': [0, 0, 0, 0, 0, 0], 'imagersize': [7, 4] }"),
              ElementsAre(5, 6, 3, 2, 7, 4));
  EXPECT_THAT(file_.lost, IsEmpty()) << "it is at the reference";
  EXPECT_THAT(numbers_of("c.cameramodel",
                         "{ 'distortion_model': 'DISTORTION_OPENCV4', 'intrinsics': [5, 6, 3, 2, .1, .2, "
                         ".3, .4], 'imagersize': [7, 4], 'extrinsics': [0, 0, 0, 0, 0, 0] }"),
              ElementsAre(5, 6, 3, 2, 0.1, 0.2, 0.3, 0.4, 7, 4));
  EXPECT_THAT(numbers_of("c.cameramodel",
                         "{ 'lensmodel': 'LENSMODEL_OPENCV12', 'intrinsics': [5, 6, 3, 2, .1, .2, .3, .4, "
                         ".5, .6, .7, .8, 0, 0, 0, 0], 'imagersize': [7, 4] }"),
              ElementsAre(5, 6, 3, 2, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 7, 4));
}

TEST_F(ForeignCameraFile, Nerfstudio) {
  EXPECT_THAT(
      numbers_of(
          "transforms.json",
          R"({"w": 640, "h": 480, "fl_x": 606.5, "fl_y": 608.75, "cx": 317.5, "cy": 255.25, "k1": 0.1, )"
          R"("k2": -0.2, "k3": 0.03, "p1": 0.004, "p2": -0.005, "camera_model": "OPENCV", "frames": []})"),
      ElementsAre(606.5, 608.75, 317.0, 254.75, 0.1, -0.2, 0.004, -0.005, 0.03, 640, 480));
  EXPECT_EQ(file_.format, CameraFormat::kNerfstudio);
  EXPECT_THAT(lost(), IsEmpty());
  read_here("transforms.json",
            R"({"w": 640, "h": 480, "fl_x": 606.5, "fl_y": 608.75, "cx": 317.5, "cy": 255.25,
    "frames": [{"file_path": "a.png"},
               {"file_path": "b.png", "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})");
  EXPECT_THAT(lost(), ElementsAre("extrinsics of cam0: transform_matrix"));
  EXPECT_THAT(
      numbers_of(
          "transforms.json",
          R"({"w": 640, "h": 480, "fl_x": 606.5, "fl_y": 608.75, "cx": 317.5, "cy": 255.25, "k1": 0.1, )"
          R"("k2": -0.2, "k3": 0.03, "k4": 0.04, "camera_model": "OPENCV_FISHEYE"})"),
      ElementsAre(606.5, 608.75, 317.0, 254.75, 0.1, -0.2, 0.03, 0.04, 640, 480));
  EXPECT_EQ(file_.rig.cameras[0].model.distortion_name(), "equidistant");
}

TEST_F(ForeignCameraFile, OpenImuCameraCalibrator) {
  const std::string head =
      R"({"final_reproj_error": 0.3, "fps": 59.9, "image_height": 1014, "image_width": 1352,)";
  EXPECT_THAT(
      numbers_of("gopro.json", head + R"("intrinsic_type": "FISHEYE", "intrinsics": {"aspect_ratio": 1.25,
    "focal_length": 400.0, "principal_pt_x": 681.25, "principal_pt_y": 508.5, "radial_distortion_1": 0.1,
    "radial_distortion_2": 0.02, "radial_distortion_3": -0.003, "radial_distortion_4": 0.0004, "skew": 0.0},
    "nr_calib_images": 89, "stabelized": false})"),
      ElementsAre(400, 500, 681.25, 508.5, 0.1, 0.02, -0.003, 0.0004, 1352, 1014));
  EXPECT_EQ(file_.format, CameraFormat::kOpenImuCameraCalibrator);
  EXPECT_THAT(
      numbers_of("gopro.json", head + R"("intrinsic_type": "PINHOLE_RADIAL_TANGENTIAL", "intrinsics": {
    "aspect_ratio": 1.25, "focal_length": 400.0, "principal_pt_x": 681.25, "principal_pt_y": 508.5,
    "radial_distortion_1": 0.1, "radial_distortion_2": 0.02, "radial_distortion_3": 0.03,
    "tangential_distortion_1": 0.004, "tangential_distortion_2": -0.005}})"),
      ElementsAre(400, 500, 681.25, 508.5, 0.1, 0.02, 0.004, -0.005, 0.03, 1352, 1014));
  EXPECT_THAT(warnings_, IsEmpty());
}

}  // namespace
}  // namespace apriltrack
