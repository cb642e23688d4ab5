#pragma once

#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/image/image.h"
#include "apriltrack/source/frame_source.h"

namespace apriltrack::test {

/// Every pixel differs from its neighbours, and the picture from that of any other seed.
GrayImage test_picture(int width, int height, int seed = 0);

/// Binary PGM written byte by byte, so that reading is judged against bytes and not against our own writer.
void write_pgm(const std::filesystem::path& path, const GrayImage& image);
void write_text(const std::filesystem::path& path, const std::string& text);
/// Pictures that differ from each other, one per name.
void write_frames(const std::filesystem::path& folder, const std::vector<std::string>& names);
std::string read_bytes(const std::filesystem::path& path);

/// All frames that a source hands out.
std::vector<SourceFrame> read_all(const std::string& input, const SourceOptions& options = {});
std::vector<std::int64_t> times_of(const std::vector<SourceFrame>& frames);

/// Expects an Error of this kind whose text holds all of `words`.
void expect_error(ErrorKind kind, const std::vector<std::string>& words, const std::function<void()>& action);
/// Expects that open_source refuses the input so.
void expect_refused(const std::filesystem::path& input, ErrorKind kind, const std::vector<std::string>& words,
                    const SourceOptions& options = {});

MATCHER_P(SamePixels, expected, "") {
  if (arg.width() != expected.width() || arg.height() != expected.height()) {
    *result_listener << arg.width() << " x " << arg.height();
    return false;
  }
  for (int y = 0; y < arg.height(); ++y) {
    for (int x = 0; x < arg.width(); ++x) {
      if (arg(x, y) == expected(x, y)) continue;
      *result_listener << "pixel (" << x << ", " << y << ") is " << int{arg(x, y)} << ", not "
                       << int{expected(x, y)};
      return false;
    }
  }
  return true;
}

}  // namespace apriltrack::test
