#pragma once

#include <opencv2/core.hpp>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// A copy of an 8-bit single-channel image. Requires CV_8UC1.
GrayImage copy_of(const cv::Mat& gray);
/// The same of a picture as video decoders hand it out: grey as it is, colour (BGR, BGRA) by Rec. 601
/// weights, 16 bits scaled down. Empty when it is of no such kind.
GrayImage gray_of(const cv::Mat& picture);

}  // namespace apriltrack
