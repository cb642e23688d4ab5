#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace apriltrack::test {

struct DecodedFrame {
  double time_s = 0.0;
  cv::Mat luma;  ///< 8 bits, limited to 16 ... 235.
  cv::Mat bgr;   ///< By the equations of ITU-R BT.601, the nearest chroma sample for each pixel.
};

struct DecodedVideo {
  std::string codec;
  std::string pixel_format;
  double duration_s = 0.0;
  std::vector<DecodedFrame> frames;
};

/// Decodes all frames with FFmpeg; throws std::runtime_error.
DecodedVideo decode_video(const std::filesystem::path& path);

/// Names of an MP4 file's outermost boxes (ISO/IEC 14496-12, section 4.2), in their order.
std::vector<std::string> box_names(const std::filesystem::path& path);

}  // namespace apriltrack::test
