// Files that go out are read, and points projected, by the programs whose formats they are; files that those
// programs write come in.

#include <gmock/gmock.h>

#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/io/numbers.h"
#include "format_cameras.h"
#include "outside_judge.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// OpenCV -------------------------------------------------------------------------------------------------

std::vector<Eigen::Vector2d> opencv_projects(const std::vector<Eigen::Vector3d>& points,
                                             const cv::Mat& matrix, const cv::Mat& coefficients,
                                             bool fisheye) {
  std::vector<cv::Point3d> in;
  for (const Eigen::Vector3d& point : points) in.emplace_back(point.x(), point.y(), point.z());
  std::vector<cv::Point2d> out;
  if (fisheye)
    cv::fisheye::projectPoints(in, out, cv::Vec3d(), cv::Vec3d(), matrix, coefficients);
  else
    cv::projectPoints(in, cv::Vec3d(), cv::Vec3d(), matrix, coefficients, out);
  std::vector<Eigen::Vector2d> pixels;
  for (const cv::Point2d& pixel : out) pixels.emplace_back(pixel.x, pixel.y);
  return pixels;
}

TEST(OpenCvJudges, FilesThatItReads) {
  for (const Camera& camera : test::format_cameras()) {
    const fs::path path = test::temporary_folder() / "camera.yml";
    write_cameras_as(path, {{camera}}, CameraFormat::kOpenCv);
    const cv::FileStorage file(path.string(), cv::FileStorage::READ);
    ASSERT_TRUE(file.isOpened());
    EXPECT_EQ(static_cast<int>(file["image_width"]), camera.width);
    EXPECT_EQ(static_cast<int>(file["image_height"]), camera.height);
    EXPECT_EQ(!file["fisheye_model"].empty(), test::is_fisheye(camera));
    const auto points = test::points_over(camera);
    test::expect_near(opencv_projects(points, file["camera_matrix"].mat(),
                                      file["distortion_coefficients"].mat(), test::is_fisheye(camera)),
                      test::projected(camera, points));
  }
}

TEST(OpenCvJudges, FilesThatItWrites) {
  const cv::Mat matrix =
      (cv::Mat_<double>(3, 3) << 1234.5 / 7, 0, 321.1 / 3, 0, 1111.1 / 7, 239.3 / 3, 0, 0, 1);
  const cv::Mat four = (cv::Mat_<double>(1, 4) << -0.1 / 3, 0.01 / 7, 0.001 / 3, -0.002 / 7);
  const cv::Mat eight =
      (cv::Mat_<double>(1, 8) << 0.1 / 3, 0.01 / 7, 0.001 / 3, -0.002 / 7, 0.01 / 3, 0.2 / 3, 0.01, 0.001);
  const cv::Mat fourteen = (cv::Mat_<double>(14, 1) << 0.1 / 3, 0.01 / 7, 0.001 / 3, -0.002 / 7, 0.01 / 3,
                            0.2 / 3, 0.01, 0.001, 0, 0, 0, 0, 0, 0);
  for (const char* name : {"camera.yml", "camera.json", "camera.xml"}) {
    for (const cv::Mat& coefficients : {four, eight, fourteen}) {
      for (const bool fisheye : {false, true}) {
        if (fisheye && coefficients.total() != 4) continue;
        const fs::path path = test::temporary_folder() / name;
        {
          cv::FileStorage file(path.string(), cv::FileStorage::WRITE);
          file << "image_width" << 213 << "image_height" << 160 << "fisheye_model"
               << static_cast<int>(fisheye) << "camera_matrix" << matrix << "distortion_coefficients"
               << coefficients;
        }
        const CameraFile read = read_camera_file(path);
        EXPECT_EQ(read.format, CameraFormat::kOpenCv);
        const Camera& camera = read.rig.cameras.front();
        EXPECT_EQ(camera.width, 213);
        const auto points = test::points_over(camera);
        test::expect_near(test::projected(camera, points),
                          opencv_projects(points, matrix, coefficients, fisheye));
      }
    }
  }
}

TEST(OpenCvJudges, FitsOfFourteenTermsAreOffByWhatTheySay) {
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << 606.9, 0, 317.1, 0, 608.7, 255.8, 0, 0, 1);
  const cv::Mat coefficients = (cv::Mat_<double>(1, 14) << 5.1, -30.2, 0.0004, -0.0007, 60.1, 4.9, -29.5,
                                58.9, 0.001, -0.002, 0.0005, 0.0001, 0.002, -0.003);
  const fs::path path = test::temporary_folder() / "camera.yml";
  {
    cv::FileStorage file(path.string(), cv::FileStorage::WRITE);
    file << "image_width" << 640 << "image_height" << 480 << "camera_matrix" << matrix
         << "distortion_coefficients" << coefficients;
  }
  const CameraFile read = read_camera_file(path, silent_log(), BeyondOurLenses::kFit);
  ASSERT_EQ(read.lost.size(), 1U);
  EXPECT_EQ(read.lost[0].kind, LossKind::kLensTerms);
  const Camera& camera = read.rig.cameras.front();
  const auto points = test::points_over(camera);
  const auto expected = opencv_projects(points, matrix, coefficients, false);
  const auto pixels = test::projected(camera, points);
  double largest_px = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    largest_px = std::max(largest_px, (pixels[i] - expected[i]).norm());
  ASSERT_EQ(read.lost[0].numbers.size(), 3U);
  const double told_px = read.lost[0].numbers[1];
  EXPECT_NEAR(largest_px, told_px, 0.05 * told_px) << "the points are others";
  EXPECT_LE(largest_px, 0.5);
  // Without the further terms alone, the camera would be off by this:
  const auto eight = opencv_projects(points, matrix, coefficients.colRange(0, 8), false);
  double without_fit_px = 0.0;
  for (std::size_t i = 0; i < eight.size(); ++i)
    without_fit_px = std::max(without_fit_px, (eight[i] - expected[i]).norm());
  EXPECT_GT(without_fit_px, 4.0 * largest_px);  // 1.10 and 0.22 px
}

TEST(OpenCvJudges, ALensThatNoneOfOursIsNearIsNotFitted) {
  const fs::path path = test::temporary_folder() / "camera.yml";
  std::ofstream(path)
      << "%YAML:1.0\nimage_width: 640\nimage_height: 480\nK: [400, 0, 320, 0, 400, 240, 0, 0, 1]\n"
         "D: [0.1, 0, 0, 0, 0, 0, 0, 0, 0.2, -0.3, 0, 0.2]\n";
  try {
    read_camera_file(path, silent_log(), BeyondOurLenses::kFit);
    FAIL() << "was fitted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("camera.yml:5: D: has 12 coefficients"));
    EXPECT_THAT(error.what(), HasSubstr("more than 0.5 px: calibrate without these terms"));
  }
}

// mrcal --------------------------------------------------------------------------------------------------

struct MrcalAnswer {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> place;
  std::vector<std::string> size;
};

MrcalAnswer mrcal_projects(const fs::path& model, const std::vector<Eigen::Vector3d>& points) {
  const fs::path list = model.parent_path() / "points.txt";
  {
    std::ofstream out(list);
    for (const Eigen::Vector3d& p : points)
      out << format_exact(p.x()) << ' ' << format_exact(p.y()) << ' ' << format_exact(p.z()) << '\n';
  }
  const auto output = test::output_of(test::script("judge_mrcal.py", "mrcal") + "project " + model.string() +
                                      " < " + list.string());
  EXPECT_TRUE(output);
  if (!output) return {};
  MrcalAnswer answer{{}, test::numbers_of(test::line_of(*output, "place")), test::line_of(*output, "size")};
  std::istringstream words(*output);
  std::string u, v;
  for (std::size_t i = 0; i < points.size() && words >> u >> v; ++i)
    answer.pixels.emplace_back(parse_double(u).value(), parse_double(v).value());
  return answer;
}

TEST(MrcalJudges, FilesThatItReadsAndWrites) {
  APRILTRACK_NEED_JUDGE(test::python_judge("mrcal", "python3-mrcal"));
  for (const Camera& camera : test::format_cameras()) {
    if (test::is_fisheye(camera)) continue;
    const fs::path path = test::temporary_folder() / "camera.cameramodel";
    write_cameras_as(path, {{camera}}, CameraFormat::kMrcal);
    const auto points = test::points_over(camera);
    const MrcalAnswer answer = mrcal_projects(path, points);
    test::expect_near(answer.pixels, test::projected(camera, points));
    EXPECT_THAT(answer.size, ElementsAre("1283", "967"));

    const fs::path copy = path.parent_path() / "copy.cameramodel";
    ASSERT_TRUE(test::output_of(test::script("judge_mrcal.py", "mrcal") + "rewrite " + path.string() + " " +
                                copy.string()));
    const Camera read = read_camera_file(copy).rig.cameras.front();
    test::expect_near(test::projected(read, points), mrcal_projects(copy, points).pixels);
  }
}

TEST(MrcalJudges, ThePlaceOfASecondCameraIsThatOfTheReferenceInIt) {
  APRILTRACK_NEED_JUDGE(test::python_judge("mrcal", "python3-mrcal"));
  CameraRig rig{{test::format_cameras()[1], test::format_cameras()[1]}};
  rig.cameras[1].name = "cam1";
  // A quarter turn about z, then 1, 2, 3 m: the reference's x is the camera's y.
  const Eigen::Quaterniond quarter(std::sqrt(0.5), 0, 0, std::sqrt(0.5));
  rig.cameras[1].T_this_previous = Pose(quarter, {1, 2, 3});
  const fs::path path = test::temporary_folder() / "camera.cameramodel";
  write_cameras_as(path, rig, CameraFormat::kMrcal, "cam1");
  const auto place = mrcal_projects(path, {{0, 0, 1}, {0.1, 0, 1}}).place;
  ASSERT_EQ(place.size(), 6U);
  EXPECT_NEAR(place[2], std::acos(0.0), 1e-15);
  EXPECT_THAT(place, ElementsAre(0, 0, testing::_, 1, 2, 3));
}

// ROS ----------------------------------------------------------------------------------------------------

TEST(RosJudges, FilesThatItReads) {
  APRILTRACK_NEED_JUDGE(
      test::python_judge("camera_calibration_parsers", "python3-camera-calibration-parsers"));
  for (Camera camera : test::format_cameras()) {
    camera.name = "front_left";
    const fs::path path = test::temporary_folder() / "camera.yaml";
    write_cameras_as(path, {{camera}}, CameraFormat::kRosCameraInfo);
    const auto output =
        test::output_of(test::script("judge_ros.py", "camera_calibration_parsers") + path.string());
    ASSERT_TRUE(output);
    EXPECT_THAT(test::line_of(*output, "name"), ElementsAre("front_left"));
    EXPECT_THAT(test::line_of(*output, "size"), ElementsAre("1283", "967"));
    const std::vector<double> D = test::numbers_of(test::line_of(*output, "D"));
    const std::string model = test::is_fisheye(camera) ? "equidistant"
                              : D.size() == 8          ? "rational_polynomial"
                                                       : "plumb_bob";
    EXPECT_THAT(test::line_of(*output, "model"), ElementsAre(model));
    EXPECT_TRUE(test::is_fisheye(camera) ? D.size() == 4 : D.size() == 5 || D.size() == 8) << D.size();
    const std::vector<double> K = test::numbers_of(test::line_of(*output, "K"));
    const auto points = test::points_over(camera);
    test::expect_near(opencv_projects(points, cv::Mat(3, 3, CV_64F, const_cast<double*>(K.data())),
                                      cv::Mat(D, true), test::is_fisheye(camera)),
                      test::projected(camera, points));
  }
}

}  // namespace
}  // namespace apriltrack
