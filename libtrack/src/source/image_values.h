#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "apriltrack/image/image.h"
#include "value_range.h"

namespace apriltrack {

/// A grey picture with the numbers that its file holds.
struct ImageValues {
  cv::Mat pixels;  ///< CV_8UC1, or CV_16UC1 where the file does not tell which of 16 bits count.

  bool is_deep() const { return pixels.depth() == CV_16U; }
};

/// Throws as read_image() does.
ImageValues read_values(const std::filesystem::path& path);
/// How a picture is given whose EXIF block says how it is to be turned: photographs upright, as OpenCV's
/// imread gives them to whoever calibrates by them; pictures of messages as the camera stored them, as
/// compressed_image_transport does, for so CameraInfo describes them.
enum class PictureTurn { kUpright, kAsStored };

/// The same of the bytes of such a file. where: what messages call it; may be empty.
ImageValues decode_image(std::string_view bytes, const std::string& where,
                         PictureTurn turn = PictureTurn::kUpright);

/// range: of deep pictures; numbers beyond it are black or white.
GrayImage gray_of(const ImageValues& values, const ValueRange& range);

}  // namespace apriltrack
