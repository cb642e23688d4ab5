#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace apriltrack {

enum class Align { kLeft, kCentre, kRight };

// Heights are those of a capital letter, in pixels.

double text_width(const std::string& words, double height);

/// Cut short, with "..." at its end, where it is wider than max_width.
std::string shortened(const std::string& words, double height, double max_width);

/// at: left, middle or right end of the letters' base line. halo: pixels round the letters that are painted
/// white before. Returns where the letters end.
double draw_text(cv::Mat& picture, const std::string& words, cv::Point2d at, double height,
                 const cv::Scalar& colour, Align align = Align::kLeft, int halo = 0);

}  // namespace apriltrack
