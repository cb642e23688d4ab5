#include "gray_pixels.h"

#include <opencv2/imgproc.hpp>

#include "apriltrack/image/opencv_bridge.h"

namespace apriltrack {

GrayImage copy_of(const cv::Mat& gray) {
  GrayImage image(gray.cols, gray.rows);
  cv::Mat target = mat_of(image.view());
  gray.copyTo(target);
  return image;
}

GrayImage gray_of(const cv::Mat& picture) {
  if (picture.empty()) return {};
  cv::Mat bytes = picture;
  if (picture.depth() == CV_16U) picture.convertTo(bytes, CV_8U, 1.0 / 256.0);
  cv::Mat gray;
  switch (bytes.type()) {
    case CV_8UC1:
      return copy_of(bytes);
    case CV_8UC3:
      cv::cvtColor(bytes, gray, cv::COLOR_BGR2GRAY);
      return copy_of(gray);
    case CV_8UC4:
      cv::cvtColor(bytes, gray, cv::COLOR_BGRA2GRAY);
      return copy_of(gray);
    default:
      return {};
  }
}

}  // namespace apriltrack
