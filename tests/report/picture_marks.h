#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "apriltrack/report/chart.h"
#include "apriltrack/report/colour.h"

namespace apriltrack::test {

/// A PNG file as OpenCV reads it, blue first.
cv::Mat read_picture(const std::filesystem::path& path);

/// 255 where the picture is of the colour, give or take `tolerance` in each channel.
cv::Mat mask_of(const cv::Mat& picture, const Colour& colour, int tolerance = 24);

/// Middle of all pixels of that colour, the centre of the top-left pixel at (0, 0); requires at least one.
cv::Point2d middle_of(const cv::Mat& picture, const Colour& colour);

bool shows(const cv::Mat& picture, const Colour& colour);

/// Written and read again.
cv::Mat drawn(const Chart& chart);

}  // namespace apriltrack::test
