#include "canvas.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/image/opencv_bridge.h"
#include "apriltrack/io/atomic_file.h"

namespace apriltrack {
namespace {

constexpr double kScale = 2.0;  // drawn pixels per point
constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr double kFontUnits = 21.0;  // height of a capital letter at font scale 1, in pixels

cv::Point scaled(cv::Point2d p) {
  return {cvRound(kScale * p.x), cvRound(kScale * p.y)};
}

cv::Rect scaled(cv::Rect2d r) {
  return {scaled(r.tl()), scaled(r.br())};
}

}  // namespace

Canvas::Canvas(int width, int height)
    : pixels_(cvRound(kScale * height), cvRound(kScale * width), CV_8UC3, cv::Scalar(255, 255, 255)) {}

void Canvas::line(cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, double width) {
  cv::line(pixels_, scaled(a), scaled(b), colour, std::max(1, cvRound(kScale * width)), cv::LINE_AA);
}

void Canvas::box(cv::Rect2d area, const cv::Scalar& colour) {
  cv::rectangle(pixels_, scaled(area), colour, cv::FILLED);
}

double Canvas::text(const std::string& words, cv::Point2d at, double height, const cv::Scalar& colour,
                    Align align) {
  const double font_scale = kScale * height / kFontUnits;
  const int thickness = std::max(1, cvRound(font_scale * 0.9));
  int baseline = 0;
  const int width = cv::getTextSize(words, kFont, font_scale, thickness, &baseline).width;
  cv::Point start = scaled(at);
  if (align == Align::kCentre) start.x -= width / 2;
  if (align == Align::kRight) start.x -= width;
  cv::putText(pixels_, words, start, kFont, font_scale, colour, thickness, cv::LINE_AA);
  return (start.x + width) / kScale;
}

void Canvas::picture(const GrayView& image, cv::Rect2d area) {
  const cv::Rect target = scaled(area);
  cv::Mat colour;
  cv::cvtColor(mat_of(image), colour, cv::COLOR_GRAY2BGR);
  const bool shrinks = target.width < colour.cols;
  cv::resize(colour, pixels_(target), target.size(), 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
}

void Canvas::write_png(const std::filesystem::path& path) const {
  cv::Mat shown;
  cv::resize(pixels_, shown, {}, 1.0 / kScale, 1.0 / kScale, cv::INTER_AREA);
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", shown, bytes)) throw io_error(path.string(), "cannot be encoded as PNG");
  write_file_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace apriltrack
