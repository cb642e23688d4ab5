#include "apriltrack/source/jpeg_picture.h"

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/image/opencv_bridge.h"

namespace apriltrack {

std::string jpeg_picture(const GrayView& image, int quality) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".jpg", mat_of(image), bytes, {cv::IMWRITE_JPEG_QUALITY, quality}))
    throw io_error("picture", "cannot be encoded as JPEG");
  return {bytes.begin(), bytes.end()};
}

}  // namespace apriltrack
