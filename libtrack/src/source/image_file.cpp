#include "apriltrack/source/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/image/opencv_bridge.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/input_file.h"
#include "apriltrack/io/lower_case.h"
#include "gray_pixels.h"
#include "image_integrity.h"
#include "image_values.h"
#include "jpeg_picture.h"

namespace apriltrack {
namespace {

/// Beyond any camera; a file of a few bytes may claim more, and must not take the machine's memory.
constexpr std::int64_t kMaxPixels = 1 << 28;

void check_size(const ClaimedSize& size, const std::string& where) {
  if (size.width < 1 || size.height < 1)
    throw io_error(where,
                   fmt::format("claims {} x {} pixels: a picture has one and more", size.width, size.height));
  // Divided, not multiplied: both sides come from the file and may be as large as 32 bits allow.
  if (size.width > kMaxPixels / size.height)
    throw io_error(where, fmt::format("claims {} x {} pixels; at most {} are read", size.width, size.height,
                                      kMaxPixels));
}

ImageIntegrity checked(std::string_view bytes, const std::string& where) {
  ImageIntegrity found = inspect_image(bytes);
  if (found.size) check_size(*found.size, where);
  if (!found.damage.empty()) throw io_error(where, found.damage);
  return found;
}

/// Whether the file may hold 16 bits without saying how many of them count.
bool may_be_deep(const ImageIntegrity& found) {
  return found.kind == ImageKind::kTiff || found.bits_per_sample == 16;
}

/// Colour by one formula whatever the file, and the same as of video frames and of messages: OpenCV's own
/// decoders of PNG and PPM have others (libpng cuts fractions off, half a grey level on average).
cv::Mat decode_gray(const cv::Mat& bytes, int turn_flag) {
  const cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_ANYCOLOR | turn_flag);
  if (picture.channels() == 1) return picture;
  cv::Mat gray;
  cv::cvtColor(picture, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

/// JPEG holds the grey picture itself. Empty where it is of inks.
cv::Mat decode_gray_jpeg(std::string_view bytes, const std::string& where, PictureTurn turn) {
  JpegPicture picture = decode_jpeg(bytes, turn);
  if (!picture.damage.empty()) throw io_error(where, fmt::format("cannot be decoded: {}", picture.damage));
  return picture.pixels;
}

/// Empty where OpenCV cannot make a picture of the bytes.
ImageValues decode(std::string_view bytes, const ImageIntegrity& found, const std::string& where,
                   PictureTurn turn) {
  if (found.kind == ImageKind::kJpeg) {
    if (const cv::Mat gray = decode_gray_jpeg(bytes, where, turn); !gray.empty()) return {gray};
  }
  // OpenCV takes a mutable header over constant bytes; it does not write to them.
  const cv::Mat view(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  const int full_scale = found.full_scale;
  const int turn_flag = turn == PictureTurn::kAsStored ? cv::IMREAD_IGNORE_ORIENTATION : 0;
  try {
    // OpenCV hands out a PNM file's numbers as they are, whatever its header says of white: 12 bits would be
    // black.
    if (full_scale > 0 && full_scale < 65535 && full_scale != 255) {
      const cv::Mat numbers = cv::imdecode(view, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | turn_flag);
      cv::Mat gray;
      if (!numbers.empty()) numbers.convertTo(gray, CV_8U, 255.0 / full_scale);
      return {gray};
    }
    if (full_scale == 65535 || may_be_deep(found)) {
      const cv::Mat numbers = cv::imdecode(view, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | turn_flag);
      if (numbers.type() == CV_16UC1) return {numbers};
    }
    return {decode_gray(view, turn_flag)};
  } catch (const cv::Exception& error) {
    throw io_error(where, fmt::format("cannot be decoded: {}", error.err));
  }
}

}  // namespace

ImageValues read_values(const std::filesystem::path& path) {
  return decode_image(read_file(path, kMaxPictureBytes), path.string(), PictureTurn::kUpright);
}

ImageValues decode_image(std::string_view bytes, const std::string& where, PictureTurn turn) {
  if (bytes.size() > kMaxPictureBytes) throw io_error(where, "is larger than 2 GiB: no image");
  const ImageIntegrity found = checked(bytes, where);
  const ImageValues values = found.kind == ImageKind::kPng ? decode(picture_of_png(bytes), found, where, turn)
                                                           : decode(bytes, found, where, turn);
  if (values.pixels.empty()) throw io_error(where, "is not an image that can be decoded, or is damaged");
  return values;
}

GrayImage gray_of(const ImageValues& values, const ValueRange& range) {
  if (!values.is_deep()) return copy_of(values.pixels);
  const double scale = 255.0 / (range.white - range.black);
  cv::Mat gray;
  values.pixels.convertTo(gray, CV_8U, scale, -scale * range.black);
  return copy_of(gray);
}

GrayImage read_image(const std::filesystem::path& path) {
  const ImageValues values = read_values(path);
  if (!values.is_deep()) return copy_of(values.pixels);
  ValueCounts counts;
  counts.add(values.pixels);
  return gray_of(values, counts.range());
}

void write_image(const std::filesystem::path& path, const GrayView& image) {
  APRILTRACK_CHECK(!image.is_empty(), "write_image needs at least one pixel");
  const std::string ending = lower_case_ending(path);
  if (ending != ".png" && ending != ".jpg" && ending != ".jpeg" && ending != ".pgm") {
    throw invalid_input(path.string(),
                        fmt::format("image file must end in .png, .jpg or .pgm (ends in '{}')", ending));
  }
  std::vector<unsigned char> bytes;
  if (!cv::imencode(ending, mat_of(image), bytes)) throw io_error(path.string(), "cannot be encoded");
  write_file_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                        Durability::kComplete);
}

}  // namespace apriltrack
