#include "painted_recording.h"

#include <algorithm>

#include "apriltrack/source/image_file.h"
#include "apriltrack/tags/tag_family.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace fs = std::filesystem;

GrayImage paint(const std::vector<PaintedTag>& tags, int width) {
  constexpr int kCell_px = 8;
  constexpr int kSamples = 4;  // a pixel and axis
  GrayImage image(width, 160, 110);
  for (const PaintedTag& tag : tags) {
    const TagPattern pattern = TagFamily::get(tag.family).pattern(tag.id);
    const double middle_x = 80.3 + 150.0 * tag.column, middle_y = 79.6;
    const double half_px = 0.5 * kCell_px * pattern.width_at_border();
    const int reach_px = static_cast<int>(half_px) + 2 * kCell_px;
    for (int y = 80 - reach_px; y <= 80 + reach_px; ++y) {
      for (int x = static_cast<int>(middle_x) - reach_px; x <= static_cast<int>(middle_x) + reach_px; ++x) {
        double sum = 0.0;
        for (int i = 0; i < kSamples * kSamples; ++i) {
          const double dx = 2.0 * (i % kSamples + 0.5) / kSamples - 1.0;
          const double dy = 2.0 * (i / kSamples + 0.5) / kSamples - 1.0;
          sum += pattern.brightness((x + dx - middle_x) / half_px, (y + dy - middle_y) / half_px);
        }
        image(x, y) = static_cast<std::uint8_t>(20.0 + 200.0 * sum / (kSamples * kSamples));
      }
    }
  }
  return image;
}

GrayImage seen_in_passing(const GrayImage& picture, int frame) {
  const int shift_px = 2 * frame;
  GrayImage image(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) image(x, y) = picture(std::max(0, x - shift_px), y);
  return image;
}

void Doctor::SetUp() {
  folder_ = temporary_folder();
  write_text(path("camera.yaml"), kPaintedCamera);
  fs::create_directories(folder_ / "frames");
}

void Doctor::film(int count, const GrayImage& picture) {
  for (int i = 0; i < count; ++i, ++num_frames_)
    write_image(folder_ / "frames" / (std::to_string(1'000'000'000 + 100'000'000LL * num_frames_) + ".png"),
                seen_in_passing(picture, num_frames_).view());
}

ProgramRun Doctor::look(const std::vector<std::string>& more) const {
  std::vector<std::string> words = {"doctor", folder_.string(), "--no-other-families"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words);
}

}  // namespace apriltrack::test
