// Pages are read back as a printer sees them: every cell is judged by what covers its middle, lengths are
// millimetres.
#include "apriltrack/report/print_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/tags/tag_family.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

struct Box {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};

PrintPage page_of(std::string_view name, int id, double size_m) {
  const TagFamily& family = TagFamily::get(name);
  return {std::string(name),        id,     family.pattern(id).cells(),
          family.width_at_border(), size_m, family.has_reversed_border()};
}

/// The black rectangles of the tag: those with a position, in the order of the file.
std::vector<Box> black_boxes(const std::string& svg) {
  static const std::regex kRect(R"re(<rect x="([^"]*)" y="([^"]*)" width="([^"]*)" height="([^"]*)"/>)re");
  std::vector<Box> boxes;
  for (auto it = std::sregex_iterator(svg.begin(), svg.end(), kRect); it != std::sregex_iterator(); ++it) {
    boxes.push_back({std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3]), std::stod((*it)[4])});
  }
  return boxes;
}

Box bounds(const std::vector<Box>& boxes) {
  Box out{1e9, 1e9, 0, 0};
  double right = -1e9;
  double bottom = -1e9;
  for (const Box& box : boxes) {
    out.x = std::min(out.x, box.x);
    out.y = std::min(out.y, box.y);
    right = std::max(right, box.x + box.width);
    bottom = std::max(bottom, box.y + box.height);
  }
  out.width = right - out.x;
  out.height = bottom - out.y;
  return out;
}

bool is_black(const std::vector<Box>& boxes, double x, double y) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
    return x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height;
  });
}

TEST(PrintPage, BlackBorderOf36h11IsExactlyAsWideAsTold) {
  for (const double size_mm : {160.0, 100.0, 33.3}) {
    const std::string svg = print_page_svg(page_of("tag36h11", 7, 1e-3 * size_mm));
    const Box tag = bounds(black_boxes(svg));
    EXPECT_NEAR(tag.width, size_mm, 1e-6);
    EXPECT_NEAR(tag.height, size_mm, 1e-6);
    EXPECT_NEAR(tag.x + 0.5 * tag.width, 105.0, 1e-6) << "in the middle of the sheet";
    EXPECT_GE(tag.x, 5.0 + size_mm / 8.0 - 1e-6) << "a white cell beside it, and what the printer needs";
  }
}

TEST(PrintPage, EveryCellOfEveryFamilyIsPrinted) {
  int cells_checked = 0;
  for (const std::string_view name : TagFamily::names()) {
    SCOPED_TRACE(name);
    const PrintPage page = page_of(name, 3, 0.08);
    const auto boxes = black_boxes(print_page_svg(page));
    const TagPattern pattern = TagFamily::get(name).pattern(3);
    const double half_mm = 40.0;
    for (int y = 0; y < page.cells.height(); ++y) {
      for (int x = 0; x < page.cells.width(); ++x) {
        // The pattern's own (u, v), in half tag sizes about the tag's centre.
        const double u = -pattern.half_extent() + (x + 0.5) * pattern.cell_size();
        const double v = -pattern.half_extent() + (y + 0.5) * pattern.cell_size();
        EXPECT_EQ(is_black(boxes, 105.0 + u * half_mm, 126.0 + v * half_mm), pattern.brightness(u, v) < 0.5);
        ++cells_checked;
      }
    }
  }
  EXPECT_GT(cells_checked, 800);
}

TEST(PrintPage, UnprintedCellsAreWhitePaper) {
  PrintPage page{"made-up", 0, Image<float>(3, 3, 0.0f), 3, 0.09, false};
  page.cells(1, 1) = std::numeric_limits<float>::quiet_NaN();
  const auto boxes = black_boxes(print_page_svg(page));
  EXPECT_FALSE(is_black(boxes, 105.0, 126.0));
  EXPECT_TRUE(is_black(boxes, 75.0, 126.0));
}

TEST(PrintPage, PageIsA4InMillimetresAndTheRulerIs100) {
  const std::string svg = print_page_svg(page_of("tag25h9", 4, 0.1));
  EXPECT_NE(svg.find(R"(width="210mm" height="297mm" viewBox="0 0 210 297")"), std::string::npos);
  std::smatch ruler;
  ASSERT_TRUE(std::regex_search(svg, ruler, std::regex(R"re(id="ruler" d="M (\S+) (\S+) h (\S+) )re")));
  EXPECT_EQ(std::stod(ruler[1]), 55.0);
  EXPECT_EQ(std::stod(ruler[3]), 100.0);
  const Box tag = bounds(black_boxes(svg));
  EXPECT_GT(std::stod(ruler[2]), tag.y + tag.height + 10.0) << "below the tag";
  EXPECT_LT(std::stod(ruler[2]), 292.0);
  for (const char* words : {"tag25h9", "id 4", "100 mm", "100 %"}) {
    EXPECT_NE(svg.find(words), std::string::npos) << words;
  }
}

TEST(PrintPage, TooLargeATagSaysWhatFits) {
  EXPECT_NO_THROW(print_page_svg(page_of("tag36h11", 0, 0.160)));
  try {
    print_page_svg(page_of("tag36h11", 0, 0.161));
    FAIL() << "161 mm with a white cell on either side are 201 mm";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    EXPECT_NE(std::string(error.what()).find("tag36h11/0: "), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("161 mm"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("at most 160 mm"), std::string::npos) << error.what();
  }
}

TEST(PrintPage, FileIsThePage) {
  const PrintPage page = page_of("tag36h11", 1, 0.1);
  const auto file = test::temporary_folder() / "page.svg";
  write_print_page(file, page);
  EXPECT_EQ(read_file(file), print_page_svg(page));
}

}  // namespace
}  // namespace apriltrack
