#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "apriltrack/image/image.h"
#include "apriltrack/report/colour.h"
#include "lettering.h"

namespace apriltrack {

/// OpenCV's order.
inline cv::Scalar bgr_of(const Colour& colour) {
  return {static_cast<double>(colour.blue), static_cast<double>(colour.green),
          static_cast<double>(colour.red)};
}

// What every picture of the module is drawn with, besides the colours of its subject.
inline const cv::Scalar kInk(40, 34, 30);
inline const cv::Scalar kPaleInk(117, 106, 98);
inline const cv::Scalar kGrid(228, 224, 220);
inline const cv::Scalar kFaintGrid(244, 242, 240);

/// A drawing surface measured in points, (0, 0) at its upper left corner; drawn at twice the size and scaled
/// down, for smooth lines and letters.
class Canvas {
 public:
  using Align = apriltrack::Align;

  Canvas(int width, int height);

  void line(cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, double width = 1.0);
  void box(cv::Rect2d area, const cv::Scalar& colour);
  void frame(cv::Rect2d area, const cv::Scalar& colour);
  void disc(cv::Point2d centre, double radius, const cv::Scalar& colour, double opacity = 1.0);
  /// What `draw` draws, all of it together: parts of it that lie on each other are not darker.
  void translucent(double opacity, const std::function<void()>& draw);
  /// radius: of the middle of its line.
  void ring(cv::Point2d centre, double radius, const cv::Scalar& colour, double width);
  /// at: left, middle or right end of the letters' base line. halo: points painted white round the letters.
  /// Returns where the letters end.
  double text(const std::string& words, cv::Point2d at, double height, const cv::Scalar& colour,
              Align align = Align::kLeft, double halo = 0.0);
  /// Scales the picture into `area`.
  void picture(const GrayView& image, cv::Rect2d area);

  static double width_of(const std::string& words, double height);
  /// Cut short, with "..." at its end, where it is wider than max_width.
  static std::string fitted(const std::string& words, double height, double max_width);

  /// The bytes of a PNG file.
  std::string png() const;
  /// Throws Error(kIo).
  void write_png(const std::filesystem::path& path) const;

 private:
  cv::Mat pixels_;
};

}  // namespace apriltrack
