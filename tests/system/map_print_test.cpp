// `map print`: what comes out of the printer is what the detector finds, as large as the page says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <sstream>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

constexpr int kPixelsPerMm = 2;
constexpr int kWidth_px = 210 * kPixelsPerMm;
constexpr int kHeight_px = 297 * kPixelsPerMm;

/// The tag of a page as a scanner sees it, as a PGM file: black where the middle of a pixel is in a
/// rectangle.
std::string scan(const std::string& svg) {
  static const std::regex kRect(R"re(<rect x="([^"]*)" y="([^"]*)" width="([^"]*)" height="([^"]*)"/>)re");
  std::string pixels(static_cast<std::size_t>(kWidth_px) * kHeight_px, '\xff');
  const auto edge_px = [](const std::string& mm) {
    return static_cast<int>(std::lround(std::stod(mm) * kPixelsPerMm));
  };
  for (auto it = std::sregex_iterator(svg.begin(), svg.end(), kRect); it != std::sregex_iterator(); ++it) {
    const int left = edge_px((*it)[1]);
    const int top = edge_px((*it)[2]);
    for (int y = top; y < top + edge_px((*it)[4]); ++y) {
      std::fill_n(pixels.begin() + y * kWidth_px + left, edge_px((*it)[3]), '\0');
    }
  }
  return "P5\n" + std::to_string(kWidth_px) + " " + std::to_string(kHeight_px) + "\n255\n" + pixels;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

TEST(MapPrint, DetectorFindsEachPageOfTheWallWithItsCornersInPlace) {
  const fs::path folder = temporary_folder();
  const auto map = source_path("maps/wall_3x4.yaml").string();
  const std::string pages = (folder / "pages").string();
  ASSERT_EQ(run_program({"map", "print", map, "--output", pages}).status, 0);
  for (int id = 0; id < 12; ++id) {
    const std::string name = "tag36h11_000" + std::string(id < 10 ? "0" : "") + std::to_string(id) + ".svg";
    write_text(folder / "scans" / (std::to_string(id + 1) + ".pgm"), scan(read_text(fs::path(pages) / name)));
  }
  const std::string csv = (folder / "found.csv").string();
  const ProgramRun run =
      run_program({"detect", (folder / "scans").string(), "--rate", "1", "--output", csv, "--threads", "1"});
  ASSERT_EQ(run.status, 0) << run.err;
  std::istringstream lines(read_text(csv));
  std::string line;
  std::getline(lines, line);  // the header
  int found = 0;
  while (std::getline(lines, line)) {
    const auto fields = fields_of(line);
    ASSERT_GE(fields.size(), 12u) << line;
    EXPECT_EQ(fields[2], "tag36h11");
    EXPECT_EQ(fields[3], std::to_string(found));
    // 160 mm about (105, 126) mm: 25 to 185 and 46 to 206; half a pixel less, as (0, 0) is a pixel's centre.
    const double expected_mm[8] = {25, 206, 185, 206, 185, 46, 25, 46};
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_NEAR(std::stod(fields[4 + i]), kPixelsPerMm * expected_mm[i] - 0.5, 0.2) << line;
    }
    ++found;
  }
  EXPECT_EQ(found, 12);
}

TEST(MapPrint, NothingIsWrittenWhenATagDoesNotFit) {
  const fs::path folder = temporary_folder();
  std::string map = read_text(source_path("maps/wall_3x4.yaml"));
  const auto last = map.rfind("size: 0.16");
  ASSERT_NE(last, std::string::npos);
  map.replace(last, 10, "size: 0.20");
  write_text(folder / "map.yaml", map);
  const auto run =
      run_program({"map", "print", (folder / "map.yaml").string(), "--output", (folder / "pages").string()});
  EXPECT_THAT(run, EndsWith(2, "tag36h11/11: "));
  EXPECT_THAT(run, EndsWith(2, "at most 160 mm"));
  EXPECT_FALSE(fs::exists(folder / "pages"));
}

TEST(MapPrint, AFileInPlaceOfTheFolderIsAnOutputError) {
  const fs::path folder = temporary_folder();
  write_text(folder / "pages", "in the way");
  const auto run = run_program(
      {"map", "print", source_path("maps/wall_3x4.yaml").string(), "--output", (folder / "pages").string()});
  EXPECT_THAT(run, EndsWith(3, "pages"));
  EXPECT_EQ(read_text(folder / "pages"), "in the way");
}

}  // namespace
}  // namespace apriltrack::test
