#include "apriltrack/report/print_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"

namespace apriltrack {
namespace {

constexpr double kPageWidth_mm = 210.0;
constexpr double kPageHeight_mm = 297.0;
constexpr double kMargin_mm = 5.0;  // what printers cannot reach, for most of them
constexpr double kFoot_mm = 45.0;   // caption and ruler
constexpr double kRuler_mm = 100.0;

/// Ten digits: far below what a printer can do, and 0.1 + 0.2 looks like 0.3.
std::string mm(double value) {
  return fmt::format("{:.10g}", value);
}

double cell_mm(const PrintPage& page) {
  return 1e3 * page.size_m / page.width_at_border;
}

/// All cells, the white ones that the family prints round the tag included, must fit between the margins.
void check_fit(const PrintPage& page) {
  const double room_mm =
      std::min(kPageWidth_mm - 2.0 * kMargin_mm, kPageHeight_mm - 2.0 * kMargin_mm - kFoot_mm);
  const double needed_mm = cell_mm(page) * page.cells.width();
  if (needed_mm <= room_mm * (1.0 + 1e-12)) return;
  throw invalid_input(
      fmt::format("{}/{}", page.family, page.id),
      fmt::format("size {:g} mm makes a print {:.1f} mm wide, and an A4 page has room for {:g} mm: "
                  "print it elsewhere, or use tags of at most {:.0f} mm",
                  1e3 * page.size_m, needed_mm, room_mm,
                  std::floor(room_mm / page.cells.width() * page.width_at_border)));
}

/// Neighbouring black cells of a row become one rectangle, so that no viewer draws hairlines between them.
std::string black_cells(const Image<float>& cells, double left_mm, double top_mm, double cell) {
  std::string svg;
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      int end = x;
      while (end < cells.width() && cells(end, y) < 0.5f) ++end;  // false for NaN: paper
      if (end == x) continue;
      svg += fmt::format("    <rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", mm(left_mm + x * cell),
                         mm(top_mm + y * cell), mm((end - x) * cell), mm(cell));
      x = end - 1;
    }
  }
  return svg;
}

std::string text(double y_mm, double height_mm, const std::string& words) {
  return fmt::format("  <text x=\"{}\" y=\"{}\" font-size=\"{}\">{}</text>\n", mm(0.5 * kPageWidth_mm),
                     mm(y_mm), mm(height_mm), words);
}

std::string ruler(double y_mm) {
  const double left = 0.5 * (kPageWidth_mm - kRuler_mm);
  std::string path = fmt::format("M {} {} h {}", mm(left), mm(y_mm), mm(kRuler_mm));
  for (int i = 0; i <= 10; ++i) {
    path +=
        fmt::format(" M {} {} v {}", mm(left + 0.1 * kRuler_mm * i), mm(y_mm), i % 5 == 0 ? "-4" : "-2.5");
  }
  return fmt::format("  <path id=\"ruler\" d=\"{}\" fill=\"none\" stroke=\"black\" stroke-width=\"0.2\"/>\n",
                     path);
}

std::string what_to_measure(const PrintPage& page) {
  return page.has_reversed_border ? "the white square's outer edge, where it meets the black ring"
                                  : "the outer edge of the black border";
}

std::string foot(const PrintPage& page) {
  const double top_mm = kPageHeight_mm - kMargin_mm - kFoot_mm;
  return text(top_mm + 8.0, 7.0, fmt::format("{}  id {}  {:g} mm", page.family, page.id, 1e3 * page.size_m)) +
         text(top_mm + 16.0, 4.0, "Print at 100 % (no scaling, no fit to page).") +
         text(top_mm + 22.0, 4.0,
              fmt::format("Then measure {}: it must be {:g} mm,", what_to_measure(page), 1e3 * page.size_m)) +
         text(top_mm + 28.0, 4.0, "or the size to give is what you measured.") + ruler(top_mm + 38.0) +
         text(top_mm + 43.0, 3.5, "100 mm");
}

}  // namespace

std::string print_page_svg(const PrintPage& page) {
  APRILTRACK_CHECK(!page.cells.is_empty() && page.cells.width() == page.cells.height(),
                   "a tag has as many rows of cells as columns");
  APRILTRACK_CHECK(page.size_m > 0.0 && page.width_at_border > 0, "a tag has a size");
  check_fit(page);
  const double cell = cell_mm(page);
  const double print_mm = cell * page.cells.width();
  const double left_mm = 0.5 * (kPageWidth_mm - print_mm);
  const double top_mm = 0.5 * (kPageHeight_mm - kFoot_mm - print_mm);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{0}mm\" height=\"{1}mm\" "
      "viewBox=\"0 0 {0} {1}\">\n"
      "  <rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      mm(kPageWidth_mm), mm(kPageHeight_mm));
  svg += "  <g id=\"tag\" fill=\"black\" shape-rendering=\"crispEdges\">\n";
  svg += black_cells(page.cells, left_mm, top_mm, cell);
  svg += "  </g>\n  <g font-family=\"sans-serif\" text-anchor=\"middle\">\n";
  svg += foot(page);
  return svg + "  </g>\n</svg>\n";
}

void write_print_page(const std::filesystem::path& path, const PrintPage& page) {
  write_file_atomically(path, print_page_svg(page));
}

}  // namespace apriltrack
