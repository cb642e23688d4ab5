#include "ros_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/io/lower_case.h"

namespace apriltrack {
namespace {

/// How the bytes of an encoding become grey. Names: sensor_msgs/image_encodings.h of ROS 1 and
/// sensor_msgs/image_encodings.hpp of ROS 2.
struct RosEncoding {
  std::string_view name;
  int type = CV_8UC1;
  int to_gray = kAsItIs;  ///< A code of cv::cvtColor.

  static constexpr int kAsItIs = -1;
  static constexpr int kFirstPlane = -2;  ///< Luma, the chroma behind all of it.
};

// cv_bridge takes 8UC3 for BGR, too. A Bayer pattern is named by its first row in ROS, by the second and
// third pixel of its second row in OpenCV.
constexpr std::array kEncodings = {
    RosEncoding{"mono8"},
    RosEncoding{"8UC1"},
    RosEncoding{"mono16", CV_16UC1},
    RosEncoding{"16UC1", CV_16UC1},
    RosEncoding{"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
    RosEncoding{"8UC3", CV_8UC3, cv::COLOR_BGR2GRAY},
    RosEncoding{"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY},
    RosEncoding{"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY},
    RosEncoding{"8UC4", CV_8UC4, cv::COLOR_BGRA2GRAY},
    RosEncoding{"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY},
    RosEncoding{"bgr16", CV_16UC3, cv::COLOR_BGR2GRAY},
    RosEncoding{"rgb16", CV_16UC3, cv::COLOR_RGB2GRAY},
    RosEncoding{"bgra16", CV_16UC4, cv::COLOR_BGRA2GRAY},
    RosEncoding{"rgba16", CV_16UC4, cv::COLOR_RGBA2GRAY},
    RosEncoding{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY},
    RosEncoding{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY},
    RosEncoding{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY},
    RosEncoding{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY},
    RosEncoding{"bayer_rggb16", CV_16UC1, cv::COLOR_BayerBG2GRAY},
    RosEncoding{"bayer_bggr16", CV_16UC1, cv::COLOR_BayerRG2GRAY},
    RosEncoding{"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGR2GRAY},
    RosEncoding{"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGB2GRAY},
    RosEncoding{"yuv422", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    RosEncoding{"uyvy", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    RosEncoding{"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
    RosEncoding{"yuyv", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
    RosEncoding{"nv12", CV_8UC1, RosEncoding::kFirstPlane},
    RosEncoding{"nv21", CV_8UC1, RosEncoding::kFirstPlane},
    RosEncoding{"nv24", CV_8UC1, RosEncoding::kFirstPlane},
};

/// Beyond any camera, and what OpenCV's sides can hold.
constexpr std::uint64_t kMostPixels = 1 << 28;

const RosEncoding& encoding_of(const RosImage& image) {
  const auto found = std::ranges::find(kEncodings, image.encoding, &RosEncoding::name);
  if (found != kEncodings.end()) return *found;
  throw BadMessage(
      fmt::format("its encoding '{}' is not read; read are mono8, mono16, 8UC1, 16UC1, 8UC3, bgr, rgb, "
                  "bgra and rgba of 8 and 16 bits, bayer_* of 8 and 16 bits, yuv422, yuv422_yuy2, nv12, "
                  "nv21, nv24",
                  image.encoding));
}

/// Throws BadMessage unless the message holds all rows, which may be longer than their pixels.
void check_rows(const RosImage& image, const RosEncoding& encoding) {
  const std::uint64_t row_bytes = std::uint64_t{image.width} * CV_ELEM_SIZE(encoding.type);
  if (image.width == 0 || image.height == 0 || std::uint64_t{image.width} * image.height > kMostPixels)
    throw BadMessage(fmt::format("claims {} x {} pixels", image.width, image.height));
  if (image.step < row_bytes)
    throw BadMessage(fmt::format("step is {}, but {} pixels of {} take {} bytes a row", image.step,
                                 image.width, image.encoding, row_bytes));
  const std::uint64_t needed = std::uint64_t{image.step} * (image.height - 1) + row_bytes;
  if (image.data.size() < needed)
    throw BadMessage(fmt::format("has {} bytes of pixels, but {} rows of {} need {}", image.data.size(),
                                 image.height, image.step, needed));
}

/// The message's bytes themselves. OpenCV takes a mutable header over constant bytes; it does not write to
/// them.
cv::Mat view_of_rows(const RosImage& image, const RosEncoding& encoding) {
  return {static_cast<int>(image.height), static_cast<int>(image.width), encoding.type,
          const_cast<char*>(image.data.data()), image.step};
}

/// Numbers of two bytes in this machine's order, and where it can read them.
cv::Mat copy_of_deep_rows(const RosImage& image, const RosEncoding& encoding) {
  cv::Mat copy(static_cast<int>(image.height), static_cast<int>(image.width), encoding.type);
  const bool is_swapped = image.is_big_endian != (std::endian::native == std::endian::big);
  for (int y = 0; y < copy.rows; ++y) {
    auto* row = copy.ptr<std::uint16_t>(y);
    const std::size_t offset = static_cast<std::size_t>(y) * image.step;
    std::memcpy(row, image.data.data() + offset, static_cast<std::size_t>(copy.cols) * copy.elemSize());
    if (!is_swapped) continue;
    for (int x = 0; x < copy.cols * copy.channels(); ++x)
      row[x] = static_cast<std::uint16_t>(row[x] >> 8 | row[x] << 8);
  }
  return copy;
}

}  // namespace

ImageValues values_of(const RosImage& image) {
  const RosEncoding& encoding = encoding_of(image);
  check_rows(image, encoding);
  const bool is_deep = CV_MAT_DEPTH(encoding.type) == CV_16U;
  const cv::Mat rows = is_deep ? copy_of_deep_rows(image, encoding) : view_of_rows(image, encoding);
  if (encoding.to_gray < 0) return {rows};
  if ((image.width < 2 || image.height < 2) && encoding.type != CV_8UC3 && encoding.type != CV_8UC4)
    throw BadMessage(
        fmt::format("{} x {} pixels are too few for {}", image.width, image.height, image.encoding));
  cv::Mat gray;
  try {
    cv::cvtColor(rows, gray, encoding.to_gray);
  } catch (const cv::Exception& error) {
    throw BadMessage(fmt::format("cannot be turned grey: {}", error.err));
  }
  return {gray};
}

namespace {

/// What image_transport writes besides pictures that files could hold.
void refuse_other_formats(std::string_view format) {
  const std::string lower = lower_case(format);
  for (const char* other : {"compresseddepth", "theora", "h264", "h265", "hevc", "vp9", "av1", "rvl"}) {
    if (lower.find(other) == std::string::npos) continue;
    throw BadMessage(
        fmt::format("its format '{}' is not read; read are pictures that files hold: jpeg, png", format));
  }
}

/// "bayer_rggb8" of "bayer_rggb8; png compressed bayer_rggb8", as compressed_image_transport says of a mosaic
/// that it has left as it is; empty of any other.
std::string_view packed_mosaic(std::string_view format) {
  constexpr std::string_view kBefore = "compressed ";
  const std::size_t at = format.find(kBefore);
  if (at == std::string_view::npos) return {};
  const std::string_view encoding = format.substr(at + kBefore.size());
  return encoding.starts_with("bayer_") ? encoding.substr(0, encoding.find(' ')) : std::string_view();
}

ImageValues values_of_mosaic(const cv::Mat& pixels, std::string_view encoding) {
  const cv::Mat mosaic = pixels.isContinuous() ? pixels : pixels.clone();
  const std::size_t step = mosaic.step[0];
  return values_of(RosImage{
      .stamp = {},
      .height = static_cast<std::uint32_t>(mosaic.rows),
      .width = static_cast<std::uint32_t>(mosaic.cols),
      .encoding = encoding,
      .step = static_cast<std::uint32_t>(step),
      .data = {reinterpret_cast<const char*>(mosaic.data), step * static_cast<std::size_t>(mosaic.rows)}});
}

}  // namespace

ImageValues values_of(const RosCompressedImage& image) {
  refuse_other_formats(image.format);
  try {
    ImageValues values = decode_image(image.data, "", PictureTurn::kAsStored);
    const std::string_view mosaic = packed_mosaic(image.format);
    return mosaic.empty() ? values : values_of_mosaic(values.pixels, mosaic);
  } catch (const Error& error) {
    throw BadMessage(fmt::format("{} (format '{}')", error.cause(), image.format));
  }
}

}  // namespace apriltrack
