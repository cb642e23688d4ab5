#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "apriltrack/image/image.h"

struct AVFrame;
struct SwsContext;

namespace apriltrack {

/// Makes 8-bit grey, 0 black to 255 white, of whatever pixels a video decoder gives: the luma of YUV with its
/// range spread, or that of RGB.
class GrayConverter {
 public:
  /// Empty when the pixels are of a kind that cannot be converted.
  GrayImage convert(const AVFrame& frame);

 private:
  struct Input {
    int width = 0;
    int height = 0;
    int format = -1;
    bool is_full_range = false;
    bool operator==(const Input&) const = default;
  };
  struct Deleter {
    void operator()(SwsContext* context) const;
  };
  void set_up(const Input& input);

  Input input_;
  std::unique_ptr<SwsContext, Deleter> context_;
  std::vector<std::uint8_t> padded_;
};

}  // namespace apriltrack
