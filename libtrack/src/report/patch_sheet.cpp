#include "apriltrack/report/patch_sheet.h"

#include <algorithm>
#include <cmath>

#include "apriltrack/base/check.h"
#include "canvas.h"

namespace apriltrack {
namespace {

// Layout in points, of which each is one pixel of the file.
constexpr int kSheetWidth = 1200;
constexpr int kSheetMargin = 60;
constexpr int kTitleSpace = 76;
constexpr int kGap = 24;
constexpr int kCaptionSpace = 46;  // below a patch
constexpr int kSmallestTile = 160;
constexpr int kLargestTile = 252;
constexpr double kCaptionHeight = 9.5;

struct Grid {
  int tile = 0;  ///< Edge of the square that a patch is fitted into.
  int num_columns = 0;
  int num_rows = 0;
  int width() const { return 2 * kSheetMargin + num_columns * (tile + kGap) - kGap; }
  int height() const {
    return kTitleSpace + num_rows * (tile + kCaptionSpace) + kSheetMargin - kCaptionSpace / 2;
  }
};

/// Few patches are shown large, many small, and none below its own size; rows are of one length, or nearly.
Grid grid_for(std::span<const LabelledPatch> patches) {
  int largest_patch = 0;
  for (const LabelledPatch& patch : patches)
    largest_patch = std::max({largest_patch, patch.cells.width(), patch.cells.height()});
  const int count = static_cast<int>(patches.size());
  const int room = kSheetWidth - 2 * kSheetMargin + kGap;
  const int most_columns = std::max(1, room / (std::max(kSmallestTile, largest_patch) + kGap));
  const int num_rows = (count + most_columns - 1) / most_columns;
  const int num_columns = (count + num_rows - 1) / num_rows;
  return {std::max(std::min(room / num_columns - kGap, kLargestTile), largest_patch), num_columns, num_rows};
}

/// Slanted stripes that run on from cell to cell.
void draw_hatch(Canvas& canvas, cv::Rect area, cv::Point origin) {
  const cv::Scalar paper(252, 251, 250);
  const cv::Scalar stripe(222, 218, 214);
  for (int y = area.y; y < area.br().y; ++y) {
    for (int x = area.x; x < area.br().x; ++x) {
      const bool is_stripe = (x - origin.x + y - origin.y) % 6 < 2;
      canvas.box(cv::Rect2d(x, y, 1.0, 1.0), is_stripe ? stripe : paper);
    }
  }
}

void draw_cells(Canvas& canvas, const Image<float>& cells, cv::Point origin, int scale) {
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      const cv::Rect area(origin.x + scale * x, origin.y + scale * y, scale, scale);
      const float grey = cells(x, y);
      if (std::isnan(grey)) {
        draw_hatch(canvas, area, origin);
      } else {
        canvas.box(area, cv::Scalar::all(std::round(std::clamp(grey, 0.0f, 255.0f))));
      }
    }
  }
}

void draw_patch(Canvas& canvas, const LabelledPatch& patch, cv::Point at, int tile) {
  const int scale = std::max(1, tile / std::max(patch.cells.width(), patch.cells.height()));
  const cv::Size size(scale * patch.cells.width(), scale * patch.cells.height());
  const cv::Point origin(at.x, at.y + tile - size.height);
  draw_cells(canvas, patch.cells, origin, scale);
  canvas.frame(cv::Rect2d(origin.x - 1.0, origin.y - 1.0, size.width + 2.0, size.height + 2.0), kGrid);
  canvas.text(Canvas::fitted(patch.caption, kCaptionHeight, tile + kGap - 8.0),
              {static_cast<double>(at.x), at.y + tile + 20.0}, kCaptionHeight, kInk);
}

}  // namespace

void write_patch_sheet(const std::filesystem::path& path, const std::string& title,
                       std::span<const LabelledPatch> patches) {
  APRILTRACK_CHECK(!patches.empty(), "a sheet shows at least one patch");
  for (const LabelledPatch& patch : patches)
    APRILTRACK_CHECK(!patch.cells.is_empty(), "a patch has at least one cell");
  const Grid grid = grid_for(patches);
  Canvas canvas(std::max(kSheetWidth, grid.width()), grid.height());
  canvas.text(Canvas::fitted(title, 16.0, kSheetWidth - 2.0 * kSheetMargin), {kSheetMargin, 42.0}, 16.0,
              kInk);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const int column = static_cast<int>(i) % grid.num_columns;
    const int row = static_cast<int>(i) / grid.num_columns;
    const cv::Point at(kSheetMargin + column * (grid.tile + kGap),
                       kTitleSpace + row * (grid.tile + kCaptionSpace));
    draw_patch(canvas, patches[i], at, grid.tile);
  }
  canvas.write_png(path);
}

}  // namespace apriltrack
