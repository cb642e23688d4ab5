#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// A drawing surface measured in points; drawn at twice the size and scaled down, for smooth lines and
/// letters.
class Canvas {
 public:
  Canvas(int width, int height);

  enum class Align { kLeft, kCentre, kRight };

  void line(cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, double width = 1.0);
  void box(cv::Rect2d area, const cv::Scalar& colour);
  /// at: left, middle or right end of the letters' base line. Returns where the letters end.
  double text(const std::string& words, cv::Point2d at, double height, const cv::Scalar& colour,
              Align align = Align::kLeft);
  /// Scales the picture into `area`.
  void picture(const GrayView& image, cv::Rect2d area);

  /// Throws Error(kIo).
  void write_png(const std::filesystem::path& path) const;

 private:
  cv::Mat pixels_;
};

}  // namespace apriltrack
