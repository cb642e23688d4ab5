#include "gray_converter.h"

extern "C" {
#include <libavutil/frame.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>

namespace apriltrack {
namespace {

constexpr int kVectorBytes = 64;

/// The old names of full-range formats, which the converter only takes with a warning for each frame.
AVPixelFormat without_range(AVPixelFormat format) {
  switch (format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    case AV_PIX_FMT_YUVJ440P:
      return AV_PIX_FMT_YUV440P;
    case AV_PIX_FMT_YUVJ411P:
      return AV_PIX_FMT_YUV411P;
    default:
      return format;
  }
}

}  // namespace

void GrayConverter::Deleter::operator()(SwsContext* context) const {
  sws_freeContext(context);
}

GrayImage GrayConverter::convert(const AVFrame& frame) {
  if (frame.width <= 0 || frame.height <= 0) return {};
  const auto told = static_cast<AVPixelFormat>(frame.format);
  const AVPixelFormat format = without_range(told);
  const bool is_full_range = format != told || frame.color_range == AVCOL_RANGE_JPEG;
  set_up({.width = frame.width, .height = frame.height, .format = format, .is_full_range = is_full_range});
  if (!context_) return {};
  // The converter writes whole vectors, beyond the end of a row whose width is no multiple of theirs.
  const int padded_width = (frame.width + kVectorBytes - 1) / kVectorBytes * kVectorBytes;
  padded_.resize(static_cast<std::size_t>(padded_width) * static_cast<std::size_t>(frame.height) +
                 kVectorBytes);
  const std::array<std::uint8_t*, 4> target = {padded_.data(), nullptr, nullptr, nullptr};
  const std::array<int, 4> stride = {padded_width, 0, 0, 0};
  sws_scale(context_.get(), frame.data, frame.linesize, 0, frame.height, target.data(), stride.data());
  GrayImage image(frame.width, frame.height);
  const GrayView rows(padded_.data(), frame.width, frame.height, padded_width);
  for (int y = 0; y < frame.height; ++y) std::copy_n(rows.row(y), frame.width, image.row(y));
  return image;
}

void GrayConverter::set_up(const Input& input) {
  if (input == input_) return;
  input_ = input;
  const auto format = static_cast<AVPixelFormat>(input.format);
  context_.reset(sws_getContext(input.width, input.height, format, input.width, input.height,
                                AV_PIX_FMT_GRAY8, SWS_BICUBIC, nullptr, nullptr, nullptr));
  if (!context_) return;
  constexpr int kUnity = 1 << 16;
  const int* weights = sws_getCoefficients(SWS_CS_ITU601);
  sws_setColorspaceDetails(context_.get(), weights, input.is_full_range, weights, 1, 0, kUnity, kUnity);
}

}  // namespace apriltrack
