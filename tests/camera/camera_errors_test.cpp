// Every way in which a camera file can be wrong, and what the user is told.

#include <gmock/gmock.h>

#include <fstream>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera.h"
#include "support/error_message.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

struct Wrong {
  std::string name;
  std::string file;
  std::string text;
  std::vector<std::string> expected;  ///< Parts of the message.
};

void PrintTo(const Wrong& wrong, std::ostream* out) {
  *out << wrong.name;
}

/// One good Kalibr camera in which one line is another.
std::string kalibr(int line, const std::string& replacement) {
  std::vector<std::string> lines = {"cam0:",
                                    "  camera_model: pinhole",
                                    "  intrinsics: [520.6, 519.4, 322.4, 237.3]",
                                    "  distortion_model: radtan",
                                    "  distortion_coeffs: [-0.28, 0.09, 0.0005, -0.0003]",
                                    "  resolution: [640, 480]"};
  const auto index = static_cast<std::size_t>(line - 1);
  if (index < lines.size()) {
    lines[index] = replacement;
  } else {
    lines.push_back(replacement);
  }
  std::string text;
  for (const auto& l : lines) text += l.empty() ? "" : l + "\n";
  return text;
}

std::string stereo(const std::string& T_cn_cnm1) {
  return kalibr(7,
                "cam1:\n  camera_model: pinhole\n  intrinsics: [5, 5, 3, 2]\n  distortion_model: none\n"
                "  resolution: [6, 4]\n  T_cn_cnm1: " +
                    T_cn_cnm1);
}

std::string matrix_file(const std::string& matrix, const std::string& rest) {
  return "camera_matrix: " + matrix + "\n" + rest;
}

constexpr const char* kGoodMatrix = "[400, 0, 300, 0, 410, 200, 0, 0, 1]";

std::vector<Wrong> wrong_files() {
  const std::string y = "c.yaml";
  return {
      // Kalibr: values
      {"focal_zero",
       y,
       kalibr(3, "  intrinsics: [0, 519.4, 322.4, 237.3]"),
       {"c.yaml:3: cam0.intrinsics: fx must be > 0 pixels (is 0)"}},
      {"focal_negative",
       y,
       kalibr(3, "  intrinsics: [520, -5, 322.4, 237.3]"),
       {"c.yaml:3", "fy must be > 0", "-5"}},
      {"intrinsics_nan",
       y,
       kalibr(3, "  intrinsics: [520, 520, .nan, 237.3]"),
       {"c.yaml:3: cam0.intrinsics[2]: must be a finite number (is '.nan')"}},
      {"intrinsics_text",
       y,
       kalibr(3, "  intrinsics: [520, 520, 1O0, 237.3]"),
       {"c.yaml:3", "must be a number", "1O0"}},
      {"intrinsics_five",
       y,
       kalibr(3, "  intrinsics: [1, 520, 520, 300, 200]"),
       {"c.yaml:3", "must be [fx, fy, cx, cy], 4 numbers (there are 5)"}},
      {"intrinsics_missing", y, kalibr(3, ""), {"c.yaml:1: cam0: 'intrinsics' is missing"}},
      {"resolution_missing", y, kalibr(6, ""), {"c.yaml:1: cam0: 'resolution' is missing"}},
      {"resolution_zero",
       y,
       kalibr(6, "  resolution: [640, 0]"),
       {"c.yaml:6", "height must lie in [1, 100000]", "is 0"}},
      {"resolution_fraction",
       y,
       kalibr(6, "  resolution: [640.5, 480]"),
       {"c.yaml:6", "whole number", "640.5"}},
      {"resolution_three", y, kalibr(6, "  resolution: [640, 480, 3]"), {"c.yaml:6", "list of 2 numbers"}},
      {"resolution_octal", y, kalibr(6, "  resolution: [0640, 480]"), {"c.yaml:6", "leading zeros", "0640"}},
      {"coefficients_three",
       y,
       kalibr(5, "  distortion_coeffs: [1, 2, 3]"),
       {"c.yaml:5", "radtan takes 4, 5 or 8 coefficients", "there are 3"}},
      {"coefficients_missing",
       y,
       kalibr(5, ""),
       {"c.yaml:4: cam0.distortion_model: the distortion coefficients are missing"}},
      {"equidistant_five",
       y,
       "cam0: {camera_model: pinhole, intrinsics: [5, 5, 3, 2], distortion_model: equidistant, "
       "distortion_coeffs: [0, 0, 0, 0, 0], resolution: [6, 4]}\n",
       {"equidistant takes 4 coefficients, k1 k2 k3 k4 (there are 5)"}},
      {"none_with_coefficients",
       y,
       kalibr(4, "  distortion_model: none"),
       {"c.yaml:5: cam0.distortion_coeffs: must be empty for a lens without distortion"}},
      {"fov",
       y,
       kalibr(4, "  distortion_model: fov"),
       {"c.yaml:4: cam0.distortion_model: 'fov' is not supported", "none, radtan", "equidistant"}},
      {"omni",
       y,
       kalibr(2, "  camera_model: omni"),
       {"c.yaml:2: cam0.camera_model: 'omni' is not supported", "pinhole-equi"}},
      {"eucm", y, kalibr(2, "  camera_model: eucm"), {"'eucm' is not supported"}},
      {"ds", y, kalibr(2, "  camera_model: ds"), {"'ds' is not supported"}},
      {"unknown_key",
       y,
       kalibr(7, "  exposure: 0.01"),
       {"c.yaml:7: cam0.exposure: unknown key", "exposure_time", "x_..."}},
      {"duplicate_key",
       y,
       kalibr(7, "  intrinsics: [1, 1, 1, 1]"),
       {"c.yaml:7: cam0.intrinsics: this key stands twice", "line 3"}},
      {"exposure_in_ms",
       y,
       kalibr(7, "  exposure_time: 16"),
       {"c.yaml:7", "exposure_time: must lie in [1e-07, 1] seconds (is 16)"}},
      {"exposure_zero",
       y,
       kalibr(7, "  exposure_time: 0"),
       {"c.yaml:7", "must lie in [1e-07, 1] seconds (is 0)"}},
      {"exposure_twice_converted",
       y,
       kalibr(7, "  exposure_time: 1e-9"),
       {"c.yaml:7", "exposure_time: must lie in [1e-07, 1] seconds (is 1e-09)"}},
      {"line_delay_in_us",
       y,
       kalibr(7, "  line_delay: 30"),
       {"c.yaml:7", "line_delay: must lie in [-0.001, 0.001]"}},
      {"stray_top_key", y, kalibr(7, "rig: 1"), {"c.yaml:7: rig: expected 'cam1' here", "x_..."}},
      {"label_twice",
       y,
       kalibr(7,
              "cam1: {label: cam0, camera_model: pinhole, intrinsics: [5, 5, 3, 2], distortion_model: "
              "none, resolution: [6, 4]}"),
       {"c.yaml:7: cam1.label: two cameras are called 'cam0'"}},
      {"label_with_comma",
       y,
       kalibr(7, "  label: \"a,b\""),
       {"c.yaml:7: cam0.label: must not hold any of ,"}},
      {"camera_left_out", y, kalibr(7, "cam2: {}"), {"c.yaml:7: cam2: expected 'cam1' here"}},
      // Kalibr: response
      {"response_auto",
       y,
       kalibr(7, "  response: auto"),
       {"c.yaml:7: cam0.response: 'auto'", "`apriltrack calibrate` estimates", "srgb, linear, gamma:G"}},
      {"response_unknown",
       y,
       kalibr(7, "  response: sRGB"),
       {"c.yaml:7", "'sRGB' is unknown", "there is no file"}},
      {"response_gamma_wild", y, kalibr(7, "  response: gamma:22"), {"c.yaml:7", "[0.2, 5] (is '22')"}},
      {"response_gamma_text", y, kalibr(7, "  response: gamma:x"), {"c.yaml:7", "[0.2, 5] (is 'x')"}},
      // Kalibr: extrinsics
      {"first_has_extrinsics",
       y,
       kalibr(7, "  T_cn_cnm1: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"),
       {"c.yaml:7: cam0.T_cn_cnm1: the first camera has none before it"}},
      {"transposed",
       y,
       stereo("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0.1, 0, 0, 1]]"),
       {"c.yaml:12: cam1.T_cn_cnm1", "last row must be 0 0 0 1", "transposed"}},
      {"scaled",
       y,
       stereo("[[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]"),
       {"c.yaml:12", "must be a rotation", "allowed is 0.001"}},
      {"reflection",
       y,
       stereo("[[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"),
       {"c.yaml:12", "reflection"}},
      {"three_rows", y, stereo("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]"), {"c.yaml:12", "4x4", "3 rows"}},
      // OpenCV, ROS, JSON
      {"skew",
       y,
       matrix_file("[400, 2.5, 300, 0, 410, 200, 0, 0, 1]",
                   "dist_coeffs: [0, 0, 0, 0]\nimage_width: 640\nimage_height: 481\n"),
       // 2.5 (480 - 200) / 410
       {"c.yaml:1: camera_matrix: a skew of 2.5 pixels moves points of the picture by up to 1.71 px",
        "--fisheye-fix-skew"}},
      {"transposed_matrix",
       y,
       matrix_file("[400, 0, 0, 0, 410, 0, 300, 200, 1]", "dist_coeffs: [0, 0, 0, 0]\n"),
       {"c.yaml:1", "row by row"}},
      {"matrix_of_eight",
       y,
       matrix_file("[400, 0, 300, 0, 410, 200, 0, 0]", "dist_coeffs: [0, 0, 0, 0]\n"),
       {"c.yaml:1", "9 numbers (there are 8)"}},
      {"uncalibrated_ros",
       y,
       matrix_file("[0, 0, 0, 0, 0, 0, 0, 0, 1]", "dist_coeffs: [0, 0, 0, 0]\n"),
       {"c.yaml:1", "fx must be > 0"}},
      {"rows_and_data",
       y,
       matrix_file("{rows: 2, cols: 3, data: [400, 0, 300, 0, 410, 200, 0, 0, 1]}", "D: [0, 0, 0, 0]\n"),
       {"c.yaml:1", "rows x cols is 6, but data has 9 numbers"}},
      {"no_coefficients",
       y,
       matrix_file(kGoodMatrix, "image_width: 640\n"),
       {"c.yaml:1", "coefficients are missing", "zeros"}},
      {"thin_prism",
       y,
       matrix_file(kGoodMatrix, "D: [0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0]\n"),
       {"c.yaml:2: D", "12 coefficients", "not zero", "thin prism"}},
      {"tilted",
       y,
       matrix_file(kGoodMatrix, "D: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.1]\n"),
       {"c.yaml:2: D", "14 coefficients"}},
      {"six_coefficients",
       y,
       matrix_file(kGoodMatrix, "D: [0, 0, 0, 0, 0, 0]\n"),
       {"c.yaml:2: D", "there are 6"}},
      {"two_names",
       y,
       matrix_file(kGoodMatrix, "D: [0, 0, 0, 0]\ndist_coeffs: [0, 0, 0, 0]\n"),
       {"says the same as", "keep one"}},
      {"ros_model",
       y,
       matrix_file(kGoodMatrix, "distortion_model: thin_prism\nD: [0, 0, 0, 0]\n"),
       {"c.yaml:2: distortion_model: 'thin_prism' is not supported"}},
      {"width_only",
       y,
       matrix_file(kGoodMatrix, "D: [0, 0, 0, 0]\nimage_width: 640\n"),
       {"c.yaml:3", "height is missing"}},
      {"json_syntax",
       "c.json",
       "{\n  \"camera_matrix\": [1, 2,\n  ]\n}\n",
       {"c.json:3: is no valid JSON", "line 3"}},
      {"json_skew",
       "c.json",
       "{\n\"camera_matrix\": [400, 3, 300, 0, 410, 200, 0, 0, 1], \"distortion_coefficients\": [0, 0, 0, "
       "0]}",
       {"c.json:2: camera_matrix: a skew of 3 pixels"}},
      {"json_tail",
       "c.json",
       "{\"camera_matrix\": [400, 0, 300, 0, 410, 200, 0, 0, "
       "1],\n\"distortion_coefficients\":[0,0,0,0,0,0,0,0,0,0,0,0,0,0.5]}",
       {"c.json:2: distortion_coefficients", "14 coefficients"}},
      {"splined",
       "c.json",
       "{\"cameraIntrinsics\": {\"data\": [400, 0, 300, 0, 410, 200, 0, 0, 1]},\n\"lensmodel\": "
       "\"LENSMODEL_SPLINED\"}",
       {"c.json:2: lensmodel: 'LENSMODEL_SPLINED' is not supported"}},
      // no camera file
      {"empty", y, "", {"c.yaml: is empty"}},
      {"tag_map",
       y,
       "apriltrack_map: 1\ntags: []\n",
       {"c.yaml:1", "'cam0' (Kalibr", "'camera_matrix' or 'K'", "ROS", "'cameraIntrinsics'", "EuRoC",
        "apriltrack_map, tags"}},
      {"list", y, "- 1\n- 2\n", {"c.yaml:1: is no camera file"}},
      {"no_yaml", y, "cam0: [1, 2\n", {"c.yaml:", "is no valid YAML"}},
      {"tab", y, "cam0:\n\tcamera_model: pinhole\n", {"c.yaml:2", "a tab indents this line"}},
      {"cam0_is_list", y, "cam0: [1]\n", {"c.yaml:1: cam0: must be a mapping"}},
  };
}

class WrongCameraFile : public ::testing::TestWithParam<Wrong> {};

INSTANTIATE_TEST_SUITE_P(Files, WrongCameraFile, ::testing::ValuesIn(wrong_files()),
                         [](const auto& file) { return file.param.name; });

TEST_P(WrongCameraFile, IsRefusedWithThePlaceAndTheCause) {
  const auto path = test::temporary_folder() / GetParam().file;
  std::ofstream(path) << GetParam().text;
  const std::string message = test::message_of([&] { read_cameras(path); });
  for (const std::string& part : GetParam().expected) EXPECT_THAT(message, HasSubstr(part));
}

TEST(CameraErrors, TheFileThatTheRowsAboveSpoilIsGood) {
  const auto path = test::temporary_folder() / "c.yaml";
  std::ofstream(path) << kalibr(7, "  exposure_time: 0.01");
  EXPECT_NO_THROW(read_cameras(path));
  std::ofstream(path) << stereo("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]");
  EXPECT_NO_THROW(read_cameras(path));
  std::ofstream(path) << matrix_file(kGoodMatrix, "D: [0, 0, 0, 0]\n");
  EXPECT_NO_THROW(read_cameras(path));
}

TEST(CameraErrors, MissingFileIsAnIoError) {
  const auto read = [] { read_cameras(test::temporary_folder() / "nowhere.yaml"); };
  EXPECT_THAT(message_of(read, ErrorKind::kIo), HasSubstr("nowhere.yaml"));
}

TEST(CameraErrors, UnknownCameraNamesThoseThereAre) {
  CameraRig rig;
  for (const char* name : {"cam0", "cam1"}) {
    rig.cameras.push_back(Camera{.name = name, .model = CameraModel({500, 510, 320, 240}, NoDistortion())});
  }
  EXPECT_THAT(message_of([&] { rig.find("left"); }), AllOf(HasSubstr("'left'"), HasSubstr("cam0, cam1")));
  EXPECT_THAT(message_of([&] { rig.T_camera_rig(1); }),
              AllOf(HasSubstr("'cam1' has no T_cn_cnm1"), HasSubstr("'cam0'")));
}

TEST(CameraErrors, ResolutionAgainstTheImagesNamesBoth) {
  Camera camera{.model = CameraModel({500, 510, 320, 240}, NoDistortion())};
  camera.width = 752;
  camera.height = 480;
  EXPECT_NO_THROW(check_resolution(camera, 752, 480, "frame"));
  EXPECT_THAT(message_of([&] { check_resolution(camera, 480, 752, "frames/1.png"); }),
              AllOf(HasSubstr("frames/1.png: "), HasSubstr("480 x 752"), HasSubstr("752 x 480"),
                    HasSubstr("cam0"), HasSubstr("rotation tag")));
  EXPECT_THAT(message_of([&] { check_resolution(camera, 480, 640, "frames/1.png"); }),
              Not(HasSubstr("rotation tag")));
}

}  // namespace
}  // namespace apriltrack
