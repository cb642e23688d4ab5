#pragma once

// Zero-copy views between our images and cv::Mat, for programs that use OpenCV. Header only: the library's
// core neither includes nor links OpenCV; link opencv_core in your own program.

#include <opencv2/core.hpp>

#include "apriltrack/base/check.h"
#include "apriltrack/image/image.h"

namespace apriltrack {

/// A view of `mat`'s pixels, which must outlive it. Requires CV_8UC1: convert colour with cv::cvtColor first.
inline GrayView view_of(const cv::Mat& mat) {
  APRILTRACK_CHECK(mat.type() == CV_8UC1, "view_of needs an 8-bit single-channel cv::Mat (CV_8UC1)");
  return {mat.ptr<std::uint8_t>(), mat.cols, mat.rows, static_cast<std::ptrdiff_t>(mat.step[0])};
}

/// A cv::Mat header over the view's pixels, without a copy; they must outlive it and must not be written
/// through it.
inline cv::Mat mat_of(const GrayView& view) {
  return {view.height(), view.width(), CV_8UC1, const_cast<std::uint8_t*>(view.data()),
          static_cast<std::size_t>(view.stride())};
}

/// A writable cv::Mat header over the view's pixels, without a copy.
inline cv::Mat mat_of(const ImageView<std::uint8_t>& view) {
  return {view.height(), view.width(), CV_8UC1, view.data(), static_cast<std::size_t>(view.stride())};
}

}  // namespace apriltrack
