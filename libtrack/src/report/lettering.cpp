#include "lettering.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace apriltrack {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr double kFontUnits = 21.0;  // height of a capital letter at font scale 1, in pixels

struct Pen {
  double font_scale;
  int thickness;
};

Pen pen_for(double height) {
  const double font_scale = height / kFontUnits;
  return {font_scale, std::max(1, cvRound(font_scale * 1.2))};
}

}  // namespace

double text_width(const std::string& words, double height) {
  const Pen pen = pen_for(height);
  int baseline = 0;
  return cv::getTextSize(words, kFont, pen.font_scale, pen.thickness, &baseline).width;
}

std::string shortened(const std::string& words, double height, double max_width) {
  if (text_width(words, height) <= max_width) return words;
  std::string kept = words;
  while (!kept.empty() && text_width(kept + "...", height) > max_width) kept.pop_back();
  while (!kept.empty() && kept.back() == ' ') kept.pop_back();
  return kept + "...";
}

double draw_text(cv::Mat& picture, const std::string& words, cv::Point2d at, double height,
                 const cv::Scalar& colour, Align align, int halo) {
  const Pen pen = pen_for(height);
  const double width = text_width(words, height);
  const double shift = align == Align::kCentre ? 0.5 * width : align == Align::kRight ? width : 0.0;
  const cv::Point start(cvRound(at.x - shift), cvRound(at.y));
  if (halo > 0)
    cv::putText(picture, words, start, kFont, pen.font_scale, {255, 255, 255}, pen.thickness + 2 * halo,
                cv::LINE_AA);
  cv::putText(picture, words, start, kFont, pen.font_scale, colour, pen.thickness, cv::LINE_AA);
  return start.x + width;
}

}  // namespace apriltrack
