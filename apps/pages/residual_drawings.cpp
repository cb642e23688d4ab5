#include "residual_drawings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "apriltrack/report/map_elevation.h"

namespace apriltrack::app {
namespace {

constexpr double kPaperWidth = 620.0;
constexpr int kColumns = 16;
constexpr int kLeastCorners = 6;  // in a cell

/// Corners in a piece of the image.
struct Cell {
  Eigen::Vector2d place_px = Eigen::Vector2d::Zero();     ///< Sum.
  Eigen::Vector2d residual_px = Eigen::Vector2d::Zero();  ///< Sum, of how far the corners were seen aside.
  int count = 0;

  Eigen::Vector2d mean_place() const { return place_px / count; }
  Eigen::Vector2d mean_residual() const { return residual_px / count; }
};

struct ImageCells {
  double width_px = 0.0, height_px = 0.0;
  std::vector<Cell> cells;  ///< Those with enough corners.
};

Eigen::Vector2d resolution_of(const MapEvidence& evidence, const Camera& camera, int number) {
  Eigen::Vector2d size(camera.width, camera.height);
  for (const MappedView& view : evidence.views) {
    if (view.camera != number || camera.width > 0) continue;
    for (const Eigen::Vector2d& corner : view.corners_px)
      size = size.cwiseMax(corner + Eigen::Vector2d(20.0, 20.0));
  }
  return size;
}

ImageCells cells_of(const MapEvidence& evidence, const Camera& camera, int number) {
  const Eigen::Vector2d size = resolution_of(evidence, camera, number);
  const double cell_px = size.x() / kColumns;
  std::map<std::pair<int, int>, Cell> all;
  for (const MappedView& view : evidence.views) {
    if (view.camera != number) continue;
    for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
      const Eigen::Vector2d& corner = view.corners_px[i];
      Cell& cell = all[{static_cast<int>(std::floor(corner.y() / cell_px)),
                        static_cast<int>(std::floor(corner.x() / cell_px))}];
      cell.place_px += corner;
      cell.residual_px -= view.residuals_px[i];
      ++cell.count;
    }
  }
  ImageCells result{size.x(), size.y(), {}};
  for (const auto& [place, cell] : all) {
    if (cell.count >= kLeastCorners) result.cells.push_back(cell);
  }
  return result;
}

/// By how much arrows are drawn too long: nearly all of them fit their cells.
double exaggeration_of(const std::vector<ImageCells>& images) {
  std::vector<double> lengths;
  for (const ImageCells& image : images) {
    for (const Cell& cell : image.cells)
      lengths.push_back(cell.mean_residual().norm() / (image.width_px / kColumns));
  }
  if (lengths.empty()) return 1.0;
  const auto at =
      lengths.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(lengths.size() - 1));
  std::ranges::nth_element(lengths, at);
  return *at > 1e-9 ? std::max(1.0, round_number_below(0.95 / *at)) : 1.0;
}

double root_mean_square(const std::vector<ImageCells>& images) {
  double squares = 0.0, count = 0.0;
  for (const ImageCells& image : images) {
    for (const Cell& cell : image.cells) {
      squares += cell.mean_residual().squaredNorm();
      count += 1.0;
    }
  }
  return std::sqrt(squares / std::max(1.0, count));
}

/// What residuals without a pattern would leave of the means.
double expected_by_chance(const MapEvidence& evidence, const std::vector<ImageCells>& images) {
  double squares = 0.0, corners = 0.0, shares = 0.0, cells = 0.0;
  for (const MappedView& view : evidence.views) {
    for (const Eigen::Vector2d& residual : view.residuals_px) squares += residual.squaredNorm();
    corners += kNumCorners;
  }
  for (const ImageCells& image : images) {
    for (const Cell& cell : image.cells) shares += 1.0 / cell.count;
    cells += static_cast<double>(image.cells.size());
  }
  return std::sqrt(squares / std::max(1.0, corners) * shares / std::max(1.0, cells));
}

SvgPicture draw_image(const ImageCells& image, double factor, const std::string& name) {
  const double scale = kPaperWidth / image.width_px;
  SvgPicture picture(kPaperWidth, scale * image.height_px);
  picture.rectangle({0.5, 0.5}, {picture.width() - 1.0, picture.height() - 1.0},
                    {.stroke = SvgInk::kRule, .fill = SvgInk::kTint, .fill_opacity = 0.5});
  const double cell = kPaperWidth / kColumns;
  for (int i = 1; i < kColumns; ++i) {
    const SvgStyle style{.stroke = SvgInk::kRule, .width = 0.5};
    picture.line({i * cell, 0.0}, {i * cell, picture.height()}, style);
    if (i * cell < picture.height()) picture.line({0.0, i * cell}, {picture.width(), i * cell}, style);
  }
  for (const Cell& one : image.cells) {
    const Eigen::Vector2d from = scale * one.mean_place();
    const Eigen::Vector2d mean_px = one.mean_residual();
    picture.arrow(
        from, from + factor * scale * mean_px,
        {.stroke = SvgInk::kAccent,
         .width = 1.5,
         .tooltip = fmt::format("{} corners: {:+.3f}, {:+.3f} px", one.count, mean_px.x(), mean_px.y())});
    picture.circle(from, 1.6, {.stroke = SvgInk::kNone, .fill = SvgInk::kAccent});
  }
  picture.text({12.0, 20.0}, name, {.size = 13.0, .is_bold = true, .has_halo = true});
  return picture;
}

constexpr double kBin = 0.25, kEnd = 5.0;

std::vector<double> bins_of(const MapEvidence& evidence, double& beyond_three) {
  std::vector<double> bins(static_cast<std::size_t>(2.0 * kEnd / kBin), 0.0);
  beyond_three = 0.0;
  double count = 0.0;
  for (const MappedView& view : evidence.views) {
    for (Eigen::Index i = 0; i < 8; ++i) {
      const double value = std::clamp(view.whitened[i], -kEnd + 1e-9, kEnd - 1e-9);
      bins[static_cast<std::size_t>((value + kEnd) / kBin)] += 1.0;
      if (std::abs(value) > 3.0) beyond_three += 1.0;
      count += 1.0;
    }
  }
  for (double& bin : bins) bin /= std::max(1.0, count) * kBin;  // a density
  beyond_three /= std::max(1.0, count);
  return bins;
}

double normal_density(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
}

}  // namespace

MapDrawing draw_residual_maps(const MapEvidence& evidence, const CameraRig& rig) {
  MapDrawing drawing;
  std::vector<ImageCells> images;
  std::vector<std::string> names;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    ImageCells image = cells_of(evidence, rig.cameras[camera], static_cast<int>(camera));
    if (image.cells.empty()) continue;
    images.push_back(std::move(image));
    names.push_back(rig.cameras[camera].name);
  }
  if (images.empty()) return drawing;
  const double factor = exaggeration_of(images);
  for (std::size_t i = 0; i < images.size(); ++i)
    drawing.pictures.push_back(draw_image(images[i], factor, names[i]));
  drawing.caption = fmt::format(
      "How far corners were seen beside where the map puts them, on the mean of each piece of the image, "
      "drawn {:g} times too long. {:.3f} px root mean square; residuals without a pattern would leave "
      "{:.3f}. Arrows that neighbours share, or that point to or from a centre, speak of the lens.",
      factor, root_mean_square(images), expected_by_chance(evidence, images));
  return drawing;
}

MapDrawing draw_residual_histogram(const MapEvidence& evidence) {
  constexpr double kHeight = 380.0, kLeft = 14.0, kBottom = 34.0, kTop = 34.0;
  double beyond_three = 0.0;
  const std::vector<double> bins = bins_of(evidence, beyond_three);
  const double top = 1.1 * std::max(*std::ranges::max_element(bins), normal_density(0.0));
  const auto at = [&](double x, double density) {
    return Eigen::Vector2d(kLeft + (x + kEnd) / (2.0 * kEnd) * (kPaperWidth - 2.0 * kLeft),
                           kHeight - kBottom - density / top * (kHeight - kBottom - kTop));
  };
  SvgPicture picture(kPaperWidth, kHeight);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double x = -kEnd + kBin * static_cast<double>(i);
    const Eigen::Vector2d low = at(x, bins[i]), high = at(x + kBin, 0.0);
    if (bins[i] > 0.0)
      picture.rectangle(low, (high - low) - Eigen::Vector2d(1.0, 0.0),
                        {.stroke = SvgInk::kNone, .fill = SvgInk::kAccent, .fill_opacity = 0.4});
  }
  std::vector<Eigen::Vector2d> curve;
  for (double x = -kEnd; x <= kEnd; x += 0.1) curve.push_back(at(x, normal_density(x)));
  picture.polyline(curve, {.stroke = SvgInk::kWarning, .width = 1.8});
  picture.line(at(-kEnd, 0.0), at(kEnd, 0.0), {.stroke = SvgInk::kPale});
  for (int x = -5; x <= 5; ++x) {
    const Eigen::Vector2d tick = at(x, 0.0);
    picture.line(tick, tick + Eigen::Vector2d(0.0, 5.0), {.stroke = SvgInk::kPale});
    picture.text(tick + Eigen::Vector2d(0.0, 20.0), fmt::format("{}", x),
                 {.ink = SvgInk::kPale, .anchor = SvgAnchor::kMiddle});
  }
  picture.text({12.0, 20.0}, "Residuals, in sigmas of the noise as measured",
               {.size = 13.0, .is_bold = true, .has_halo = true});
  return {{std::move(picture)},
          fmt::format("Bars: the residuals, eight for each view; line: the normal distribution. {:.2f} % lie "
                      "beyond 3 sigmas, where 0.27 % would; those beyond 5 stand at the ends.",
                      100.0 * beyond_three)};
}

}  // namespace apriltrack::app
