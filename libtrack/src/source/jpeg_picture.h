#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "image_values.h"

namespace apriltrack {

struct JpegPicture {
  cv::Mat pixels;      ///< CV_8UC1; empty where it cannot be decoded, and of four
                       ///< inks (CMYK).
  std::string damage;  ///< What is wrong with its data, in libjpeg's words; empty when nothing is.
};

/// The grey picture of a JPEG file. By libjpeg itself and not by cv::imdecode, which keeps to itself that
/// data are damaged, and lets libjpeg print its words to stderr, where nobody knows of which file they are.
JpegPicture decode_jpeg(std::string_view bytes, PictureTurn turn = PictureTurn::kUpright);

}  // namespace apriltrack
