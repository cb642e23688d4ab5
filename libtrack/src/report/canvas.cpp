#include "canvas.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/image/opencv_bridge.h"
#include "apriltrack/io/atomic_file.h"

namespace apriltrack {
namespace {

constexpr double kScale = 2.0;    // drawn pixels per point
constexpr int kFractionBits = 4;  // OpenCV draws lines and circles at 1/16 pixel
constexpr double kHairline_pt = 1.0;

cv::Point scaled(cv::Point2d p) {
  return {cvRound(kScale * p.x), cvRound(kScale * p.y)};
}

cv::Rect scaled(cv::Rect2d r) {
  return {scaled(r.tl()), scaled(r.br())};
}

/// Drawn pixels have their centres at whole numbers, hence the half.
cv::Point finely_scaled(cv::Point2d p) {
  constexpr double kUnits = 1 << kFractionBits;
  return {cvRound(kUnits * (kScale * p.x - 0.5)), cvRound(kUnits * (kScale * p.y - 0.5))};
}

}  // namespace

Canvas::Canvas(int width, int height)
    : pixels_(cvRound(kScale * height), cvRound(kScale * width), CV_8UC3, cv::Scalar(255, 255, 255)) {}

void Canvas::line(cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, double width) {
  cv::line(pixels_, finely_scaled(a), finely_scaled(b), colour, std::max(1, cvRound(kScale * width)),
           cv::LINE_AA, kFractionBits);
}

void Canvas::box(cv::Rect2d area, const cv::Scalar& colour) {
  cv::rectangle(pixels_, scaled(area), colour, cv::FILLED);
}

void Canvas::frame(cv::Rect2d area, const cv::Scalar& colour) {
  box({area.x, area.y, area.width, kHairline_pt}, colour);
  box({area.x, area.br().y - kHairline_pt, area.width, kHairline_pt}, colour);
  box({area.x, area.y, kHairline_pt, area.height}, colour);
  box({area.br().x - kHairline_pt, area.y, kHairline_pt, area.height}, colour);
}

void Canvas::disc(cv::Point2d centre, double radius, const cv::Scalar& colour, double opacity) {
  const double reach = radius + 2.0;  // smooth edges lie outside
  const cv::Rect around = scaled(cv::Rect2d(centre.x - reach, centre.y - reach, 2.0 * reach, 2.0 * reach)) &
                          cv::Rect(0, 0, pixels_.cols, pixels_.rows);
  if (around.empty()) return;
  const cv::Mat below = opacity < 1.0 ? pixels_(around).clone() : cv::Mat();
  cv::circle(pixels_, finely_scaled(centre), cvRound(radius * kScale * (1 << kFractionBits)), colour,
             cv::FILLED, cv::LINE_AA, kFractionBits);
  if (opacity < 1.0) cv::addWeighted(pixels_(around), opacity, below, 1.0 - opacity, 0.0, pixels_(around));
}

void Canvas::translucent(double opacity, const std::function<void()>& draw) {
  const cv::Mat below = pixels_.clone();
  draw();
  cv::addWeighted(pixels_, opacity, below, 1.0 - opacity, 0.0, pixels_);
}

void Canvas::ring(cv::Point2d centre, double radius, const cv::Scalar& colour, double width) {
  cv::circle(pixels_, finely_scaled(centre), cvRound(radius * kScale * (1 << kFractionBits)), colour,
             cvRound(kScale * width), cv::LINE_AA, kFractionBits);
}

double Canvas::text(const std::string& words, cv::Point2d at, double height, const cv::Scalar& colour,
                    Align align, double halo) {
  return draw_text(pixels_, words, kScale * at, kScale * height, colour, align, cvRound(kScale * halo)) /
         kScale;
}

double Canvas::width_of(const std::string& words, double height) {
  return text_width(words, kScale * height) / kScale;
}

std::string Canvas::fitted(const std::string& words, double height, double max_width) {
  return shortened(words, kScale * height, kScale * max_width);
}

void Canvas::picture(const GrayView& image, cv::Rect2d area) {
  const cv::Rect target = scaled(area);
  cv::Mat colour;
  cv::cvtColor(mat_of(image), colour, cv::COLOR_GRAY2BGR);
  const bool shrinks = target.width < colour.cols;
  cv::resize(colour, pixels_(target), target.size(), 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
}

std::string Canvas::png() const {
  cv::Mat shown;
  cv::resize(pixels_, shown, {}, 1.0 / kScale, 1.0 / kScale, cv::INTER_AREA);
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", shown, bytes)) throw io_error("picture", "cannot be encoded as PNG");
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void Canvas::write_png(const std::filesystem::path& path) const {
  write_file_atomically(path, png());
}

}  // namespace apriltrack
