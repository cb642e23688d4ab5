// The 3-D view of pages, in a browser: what it draws is photographed, and the detector must read the tags in
// the photograph, each with its corners where a pinhole camera sees them. Needs Chromium.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "apriltrack/detect/detector.h"
#include "apriltrack/source/image_file.h"
#include "program.h"
#include "support/judges.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

using testing::HasSubstr;

constexpr double kHalfField_rad = 20.0 / 180.0 * std::numbers::pi;  // of the view, upwards

/// Runs a browser without a window on a page; tells what it prints.
class BrowserTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
      if (program_judge(name, name).is_there) browser_ = name;
    APRILTRACK_NEED_JUDGE(Judge{"chromium", "chromium", !browser_.empty()});
  }

  std::string browse(const std::string& page, const std::string& options) const {
    const std::string command = fmt::format(
        "timeout 120 {} --headless --no-sandbox --hide-scrollbars --user-data-dir='{}' "
        "--window-size=1000,900 {} "
        "'file://{}' > '{}' 2> /dev/null",
        browser_, path("profile"), options, path(page), path("printed"));
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return read_text(path("printed"));
  }

  /// Has the page tell what a script answers there, behind "asked: ".
  void ask(const std::string& page, const std::string& script) const {
    std::string text = read_text(path(page));
    text.insert(text.rfind("</body>"), "<script>document.body.append(`asked: ${" + script + "}`)</script>");
    write_text(path(page), text);
  }

  /// WebGL drawn by the processor, wherever the test runs.
  static constexpr const char* kSoftware =
      "--use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader";

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string browser_;
  const fs::path folder_ = temporary_folder();
};

/// A print on a wall that is looked at along +y, z up; turned about its middle, clockwise as it is looked at.
struct Print {
  const char* family;
  int id;
  double size_m;
  Eigen::Vector3d place;
  double turned_deg;

  Eigen::Matrix3d rotation() const {
    Eigen::Matrix3d upright;  // columns: the print's right, down and into the wall
    upright << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    return upright * Eigen::AngleAxisd(turned_deg / 180.0 * std::numbers::pi, Eigen::Vector3d::UnitZ())
                         .toRotationMatrix();
  }
  /// In corner order: bottom left, bottom right, top right, top left of the upright print.
  std::array<Eigen::Vector3d, 4> corners() const {
    std::array<Eigen::Vector3d, 4> all;
    const Eigen::Vector2d kUnit[] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
    for (std::size_t i = 0; i < 4; ++i)
      all[i] = place + rotation() * (0.5 * size_m * Eigen::Vector3d(kUnit[i].x(), kUnit[i].y(), 0.0));
    return all;
  }
};

/// Far from the origin, where numbers of a graphics card would not tell millimetres apart.
const Eigen::Vector3d kFarOrigin(5000.0, -3000.0, 20.0);
const Print kPrints[] = {{"tag36h11", 3, 0.30, kFarOrigin + Eigen::Vector3d(-0.45, 2.0, 1.30), 20.0},
                         {"tag36h11", 301, 0.22, kFarOrigin + Eigen::Vector3d(0.40, 2.2, 1.55), -20.0},
                         {"tag25h9", 17, 0.25, kFarOrigin + Eigen::Vector3d(0.35, 1.9, 0.95), 0.0}};

std::string map_of_prints() {
  std::string text = "apriltrack_map: 1\nframe: world\ndefault_family: tag36h11\ntags:\n";
  for (const Print& print : kPrints) {
    const Eigen::Quaterniond q(print.rotation());
    text += fmt::format(
        "  - id: {}\n    family: {}\n    size: {}\n    pose:\n      position: {{x: {}, y: {}, z: {}}}\n"
        "      orientation: {{x: {:.17g}, y: {:.17g}, z: {:.17g}, w: {:.17g}}}\n",
        print.id, print.family, print.size_m, print.place.x(), print.place.y(), print.place.z(), q.x(), q.y(),
        q.z(), q.w());
  }
  return text;
}

/// Right and down in the picture over the distance ahead, of a camera that looks from one point to another
/// with z up.
Eigen::Vector2d seen_from(const Eigen::Vector3d& from, const Eigen::Vector3d& target,
                          const Eigen::Vector3d& point) {
  const Eigen::Vector3d ahead = (target - from).normalized();
  const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ()).normalized(), down = ahead.cross(right);
  const Eigen::Vector3d to_point = point - from;
  return Eigen::Vector2d(right.dot(to_point), down.dot(to_point)) / ahead.dot(to_point);
}

using SceneView3d = BrowserTest;

TEST_F(SceneView3d, ShowsThePrintsThatTheDetectorReadsWhereAPinholeCameraSeesThem) {
  write_text(path("map.yaml"), map_of_prints());
  run_for_json({"map", "show", path("map.yaml"), "--report", path("map.html")});
  const Eigen::Vector3d from = kFarOrigin + Eigen::Vector3d(0.3, 0.1, 1.6),
                        target = kFarOrigin + Eigen::Vector3d(-0.05, 2.0, 1.25);
  browse(fmt::format("map.html#full&bare&view={},{},{},{},{},{}", from.x(), from.y(), from.z(), target.x(),
                     target.y(), target.z()),
         fmt::format("{} --screenshot='{}'", kSoftware, path("view.png")));
  Detector detector({.families = {"tag36h11", "tag25h9"}});
  const GrayImage photograph = read_image(path("view.png"));
  const std::vector<Detection> found = detector.detect(photograph.view());
  ASSERT_EQ(found.size(), std::size(kPrints));

  // Where the picture lies on the page, and how large it is, are the page's affair: three numbers are fitted.
  Eigen::MatrixXd A(24, 3);
  Eigen::VectorXd b(24);
  Eigen::Index row = 0;
  for (const Print& print : kPrints) {
    const auto own = std::ranges::find_if(found, [&](const Detection& one) {
      return one.tag == TagKey{print.family, print.id};
    });
    ASSERT_NE(own, found.end()) << print.family << " " << print.id;
    const auto corners = print.corners();
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d seen = seen_from(from, target, corners[i]);
      for (const Eigen::Index axis : {0, 1}) {
        A.row(row) << seen[axis], axis == 0, axis == 1;
        b[row++] = own->corners_px[i][axis];
      }
    }
  }
  const Eigen::Vector3d fitted = A.colPivHouseholderQr().solve(b);
  const Eigen::VectorXd off_px = A * fitted - b;  // edges are not smoothed in software: steps of a pixel
  EXPECT_LT(off_px.lpNorm<Eigen::Infinity>(), 1.3);
  EXPECT_LT(std::sqrt(off_px.squaredNorm() / 24.0), 0.5);
  const double height_px = 2.0 * fitted[0] * std::tan(kHalfField_rad);
  EXPECT_GT(height_px, 600.0);
  EXPECT_LT(height_px, 900.0) << "the window's height";
}

TEST_F(SceneView3d, NamesWhatItDraws) {
  write_text(path("map.yaml"), map_of_prints());
  run_for_json({"map", "show", path("map.yaml"), "--report", path("map.html")});
  const std::string page = browse("map.html#measure", fmt::format("{} --dump-dom", kSoftware));
  EXPECT_THAT(page, HasSubstr("data-state=\"drawn\""));
  EXPECT_THAT(page, HasSubstr(">3 tags of the map<"));
  EXPECT_THAT(page, HasSubstr(" frames a second, 3 tags, "));
}

TEST_F(SceneView3d, SaysSoWhereThereIsNoWebGl) {
  write_text(path("map.yaml"), map_of_prints());
  run_for_json({"map", "show", path("map.yaml"), "--report", path("map.html")});
  const std::string page = browse("map.html", "--disable-3d-apis --dump-dom");
  EXPECT_THAT(page, HasSubstr("data-state=\"not drawn\""));
  EXPECT_THAT(page, HasSubstr("The 3-D view cannot be drawn here"));
  EXPECT_THAT(page, HasSubstr(">From above<"));
  ask("map.html", "getComputedStyle(document.querySelector('figure.scene figcaption')).display");
  EXPECT_THAT(browse("map.html", "--disable-3d-apis --dump-dom"), HasSubstr("asked: none"))
      << "nothing can be dragged";
  EXPECT_THAT(browse("map.html", fmt::format("{} --dump-dom", kSoftware)), HasSubstr("asked: block"));
}

TEST_F(SceneView3d, CaptionsOfWideTablesStayWithinTheirBoxes) {
  write_text(path("map.yaml"), map_of_prints());
  run_for_json({"map", "show", path("map.yaml"), "--report", path("map.html")});
  ask("map.html",
      "[...document.querySelectorAll('.wide caption')].map((one) => [one, one.closest('.wide')].map("
      "(part) => Math.round(part.getBoundingClientRect().right)).join(' of ')).join()");
  const std::string page = browse("map.html", "--window-size=500,900 --dump-dom");
  const std::size_t at = page.rfind("asked: ");  // behind the script itself
  ASSERT_NE(at, std::string::npos);
  int caption_px = 0, box_px = 0;
  ASSERT_EQ(std::sscanf(page.c_str() + at, "asked: %d of %d", &caption_px, &box_px), 2)
      << page.substr(at, 80);
  EXPECT_LE(caption_px, box_px + 1);
  EXPECT_LE(box_px, 500);
}

TEST(MapShowPage, IsToldOfAndHasAllTags) {
  const fs::path folder = temporary_folder();
  write_text(folder / "map.yaml", map_of_prints());
  const ProgramRun run = run_program({"map", "show", folder / "map.yaml", "--report", folder / "map.html"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("report: " + (folder / "map.html").string()));
  const std::string page = read_text(folder / "map.html");
  for (const char* words :
       {">tag36h11/3<", ">tag36h11/301<", ">tag25h9/17<", ">From above<", ">From the front<"})
    EXPECT_THAT(page, HasSubstr(words));
}

TEST(MapShowPage, IsNotWrittenOverTheMapOrWhereNoFolderIs) {
  const fs::path folder = temporary_folder();
  write_text(folder / "map.yaml", map_of_prints());
  const auto show = [&](const fs::path& page) {
    return run_program({"map", "show", folder / "map.yaml", "--report", page});
  };
  EXPECT_EQ(show(folder / "map.yaml").status, 2);
  EXPECT_EQ(read_text(folder / "map.yaml"), map_of_prints());
  EXPECT_THAT(show(folder / "nowhere" / "map.html"), EndsWith(3, "nowhere"));
}

}  // namespace
}  // namespace apriltrack::test
