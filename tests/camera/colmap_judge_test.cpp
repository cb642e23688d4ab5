// COLMAP reads and writes camera lists, and its bundle adjuster judges where points are seen.

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/io/numbers.h"
#include "format_cameras.h"
#include "outside_judge.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A model of two pictures of one camera, whose pixels are ours; COLMAP's bundle adjuster, which is let
/// adjust nothing but points, tells first how far its own projection is off them, RMS.
class ColmapPictures {
 public:
  ColmapPictures(const Camera& camera, const std::string& cameras_txt)
      : folder_(test::temporary_folder() / "colmap") {
    fs::create_directories(folder_ / "out");
    std::ofstream(folder_ / "cameras.txt") << cameras_txt;
    write_pictures(camera);
  }

  std::string adjust() const {
    return test::output_of(
               "QT_QPA_PLATFORM=offscreen colmap bundle_adjuster --input_path " + folder_.string() +
               " --output_path " + (folder_ / "out").string() +
               " --BundleAdjustment.refine_focal_length 0 --BundleAdjustment.refine_extra_params 0"
               " --BundleAdjustment.refine_extrinsics 0 --BundleAdjustment.max_num_iterations 0 2>&1")
        .value_or("");
  }
  std::size_t num_points() const { return num_points_; }
  const fs::path& folder() const { return folder_; }

 private:
  void write_pictures(const Camera& camera) {
    const Eigen::Vector3d shift(0.02, -0.01, 0.005);  // of the second picture
    std::ofstream points(folder_ / "points3D.txt");
    std::string rows[2];
    const auto in_row = [&](const Eigen::Vector2d& pixel) {
      return format_exact(pixel.x() + 0.5) + " " + format_exact(pixel.y() + 0.5) + " " +
             std::to_string(num_points_) + " ";
    };
    for (const Eigen::Vector3d& p : test::points_over(camera)) {
      const auto second = camera.model.project(p + shift);
      if (!second) continue;
      ++num_points_;
      points << num_points_ << ' ' << format_exact(p.x()) << ' ' << format_exact(p.y()) << ' '
             << format_exact(p.z()) << " 1 1 1 0 1 " << num_points_ - 1 << " 2 " << num_points_ - 1 << '\n';
      rows[0] += in_row(*camera.model.project(p));
      rows[1] += in_row(*second);
    }
    std::ofstream(folder_ / "images.txt") << "1 1 0 0 0 0 0 0 1 a.png\n"
                                          << rows[0] << "\n2 1 0 0 0 0.02 -0.01 0.005 1 b.png\n"
                                          << rows[1] << '\n';
  }

  fs::path folder_;
  std::size_t num_points_ = 0;
};

/// The number after "Initial cost : ".
double initial_cost_px(const std::string& report) {
  const std::size_t at = report.find("Initial cost : ");
  if (at == std::string::npos) return HUGE_VAL;
  std::istringstream words(report.substr(at + 15));
  std::string number;
  words >> number;
  return parse_double(number).value_or(HUGE_VAL);
}

void expect_that_colmap_agrees(const ColmapPictures& model) {
  const std::string report = model.adjust();
  EXPECT_GE(model.num_points(), 1000U);
  EXPECT_THAT(report, HasSubstr("Residuals : " + std::to_string(4 * model.num_points())))
      << "no picture was left out";
  EXPECT_LE(initial_cost_px(report), test::kMaxJudgedError_px) << report;
}

test::Judge colmap() {
  return test::program_judge("colmap", "colmap");
}

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(ColmapJudges, FilesThatItReadsAndWrites) {
  APRILTRACK_NEED_JUDGE(colmap());
  for (const Camera& camera : test::format_cameras()) {
    const fs::path path = test::temporary_folder() / "cameras.txt";
    write_cameras_as(path, {{camera}}, CameraFormat::kColmap);
    const ColmapPictures model(camera, text_of(path));
    expect_that_colmap_agrees(model);

    const std::string out = (model.folder() / "out").string();
    ASSERT_TRUE(
        test::output_of("QT_QPA_PLATFORM=offscreen colmap model_converter --output_type TXT --input_path " +
                        out + " --output_path " + out));
    const Camera read = read_camera_file(model.folder() / "out" / "cameras.txt").rig.cameras.front();
    const auto points = test::points_over(camera);
    test::expect_near(test::projected(read, points), test::projected(camera, points));
  }
}

TEST(ColmapJudges, ModelsThatAreOnlyRead) {
  APRILTRACK_NEED_JUDGE(colmap());
  for (const std::string line :
       {"SIMPLE_PINHOLE 640 480 600.5 320.25 241.75", "SIMPLE_RADIAL 640 480 600.5 320.25 241.75 -0.1",
        "RADIAL 640 480 600.5 320.25 241.75 -0.1 0.07",
        "SIMPLE_RADIAL_FISHEYE 640 480 400.5 320.25 241.75 -0.03",
        "RADIAL_FISHEYE 640 480 400.5 320.25 241.75 -0.03 0.01"}) {
    const fs::path path = test::temporary_folder() / "cameras.txt";
    std::ofstream(path) << "1 " << line << '\n';
    SCOPED_TRACE(line);
    expect_that_colmap_agrees(ColmapPictures(read_camera_file(path).rig.cameras.front(), text_of(path)));
  }
}

}  // namespace
}  // namespace apriltrack
