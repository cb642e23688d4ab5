#include "picture_marks.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "support/shared_data.h"

namespace apriltrack::test {

cv::Mat read_picture(const std::filesystem::path& path) {
  cv::Mat picture = cv::imread(path.string(), cv::IMREAD_COLOR);
  if (picture.empty()) throw std::runtime_error(path.string() + " is no picture");
  return picture;
}

cv::Mat mask_of(const cv::Mat& picture, const Colour& colour, int tolerance) {
  const cv::Scalar bgr(colour.blue, colour.green, colour.red);
  const cv::Scalar around = cv::Scalar::all(tolerance);
  cv::Mat mask;
  cv::inRange(picture, bgr - around, bgr + around, mask);
  return mask;
}

cv::Point2d middle_of(const cv::Mat& picture, const Colour& colour) {
  const cv::Moments moments = cv::moments(mask_of(picture, colour), true);
  if (moments.m00 == 0.0) throw std::runtime_error("no pixel of that colour");
  return {moments.m10 / moments.m00, moments.m01 / moments.m00};
}

bool shows(const cv::Mat& picture, const Colour& colour) {
  return cv::countNonZero(mask_of(picture, colour)) > 0;
}

cv::Mat drawn(const Chart& chart) {
  const auto file = temporary_folder() / "chart.png";
  write_chart(file, chart);
  return read_picture(file);
}

}  // namespace apriltrack::test
