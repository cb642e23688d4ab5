#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/report/colour.h"
#include "apriltrack/report/svg_picture.h"

namespace apriltrack {

/// Rings and crosses leave what lies below them in sight.
enum class ChartMark { kLine, kPoints, kLineAndPoints, kRings, kCrosses };

/// One thing shown in a chart. An x or y of NaN is a gap.
struct ChartSeries {
  std::string
      name;  ///< In the legend, with "(none)" when there is nothing to draw; empty: not in the legend.
  Colour colour = {};  ///< Not of shaded points.
  ChartMark mark = ChartMark::kLine;
  std::vector<double> x = {};
  std::vector<double> y = {};
  /// Empty, or a number in [0, 1] for each point, which gives the point its colour: pale yellow for 0 to dark
  /// violet for 1 (the map viridis turned about, since on white paper dark reads as more: Schloss et al.
  /// 2019). Points are drawn in the order of their shades. A shaded series is drawn as points, also where its
  /// mark is kLine.
  std::vector<double> shade = {};
  /// Empty, or a half width >= 0 for each point: y plus and minus it is a translucent band behind the
  /// lines, with the same gaps. NaN: none there. Bands do not stretch the axis; they are cut off where it
  /// ends.
  std::vector<double> half_width = {};
  /// Of points, in (0, 1]: below 1 they are the darker the more of them lie on each other.
  double opacity = 1.0;
};

struct ChartAxis {
  std::string label;
  bool is_logarithmic = false;
  std::optional<double> low = std::nullopt;  ///< Where the axis ends; otherwise chosen to hold all numbers.
  std::optional<double> high = std::nullopt;
  bool has_equal_scale = false;  ///< On either axis: one unit is as long on both. Linear axes only.
};

/// A thin dashed line across the chart, with its name, such as "5 px".
struct ChartLevel {
  double y = 0.0;
  std::string name;
};

struct Chart {
  std::string title;
  ChartAxis x, y;
  std::vector<ChartSeries> series;  ///< Later ones are drawn over earlier ones.
  std::vector<ChartLevel> levels;
  std::string shade_label;  ///< What shades mean; above the bar of colours.
  /// Of the picture and of its plot, in pixels: a chart of equal scales may be better off nearly square.
  int width = 1200;
  int plot_height = 372;
};

/// Writes a PNG file: by default 1200 pixels wide and 560 high, or higher where the legend takes several
/// rows. Points beyond an axis, infinite ones and those <= 0 on a logarithmic axis too, are drawn at its
/// edge; lines are cut off there. Letters beyond ASCII appear as '?'.
///
/// Requires as many x as y, and as many shades or none; shades in [0, 1]; finite ends of axes with low <
/// high, and > 0 on logarithmic ones; finite levels; a width of 400 to 4000 and a plot's height of 100 to
/// 4000. Throws Error(kIo).
void write_chart(const std::filesystem::path& path, const Chart& chart);

/// The same picture as the bytes of a PNG file, for HtmlPage::png.
std::string chart_png(const Chart& chart);

/// The same chart as a drawing for a page: in the page's colours, its letters can be searched, 1010 units
/// wide whatever `width` says. It stays small however many numbers there are: what lies closer together than
/// can be seen is drawn once.
///
/// Requires besides that there are no shades, and that colours are of the palette in colour.h, without
/// yellow.
SvgPicture chart_svg(const Chart& chart);

}  // namespace apriltrack
