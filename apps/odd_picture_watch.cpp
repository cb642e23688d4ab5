#include "odd_picture_watch.h"

#include <fmt/format.h>

#include <algorithm>

#include "console.h"

namespace apriltrack::app {

void OddPictureWatch::add(const GrayView& image, std::span<const Detection> detections) {
  ++num_frames_;
  if (std::ranges::any_of(detections, [](const Detection& one) { return one.hamming.value_or(0) == 0; }))
    ++num_with_tags_;
  else
    tagless_.offer(image);
}

std::optional<OddPictures> OddPictureWatch::look(const DetectorOptions& detector) const {
  constexpr std::size_t kOneIn = 10;
  if (kOneIn * num_with_tags_ > num_frames_ || tagless_.images().empty()) return std::nullopt;
  return find_odd_pictures(tagless_.images(), detector);
}

std::optional<std::string> OddPictureWatch::told(const DetectorOptions& detector) const {
  if (is_interrupted()) return std::nullopt;
  const auto odd = look(detector);
  if (!odd) return std::nullopt;
  return app::told(*odd);
}

std::string told(const OddPictures& odd) {
  const std::string tags =
      odd.tags.size() == 1 ? to_string(*odd.tags.begin())
                           : fmt::format("{} and {} more", to_string(*odd.tags.begin()), odd.tags.size() - 1);
  const std::string mirrored =
      "turn mirroring (selfie view) off in the camera, or flip the pictures left to right (ffmpeg -i IN -vf "
      "hflip OUT), and use a camera file made of pictures that are not mirrored";
  const std::string inverted =
      "print tags black on white; pictures that are negatives can be turned (ffmpeg -i IN -vf negate OUT)";
  if (odd.are_mirrored && odd.are_inverted)
    return fmt::format(
        "the pictures are mirrored, and light on dark: tags are read in the negative of their "
        "mirror image ({}); {}; {}",
        tags, mirrored, inverted);
  if (odd.are_mirrored)
    return fmt::format("the pictures are mirrored: tags are read in their mirror image ({}); {}", tags,
                       mirrored);
  return fmt::format("the tags are light on dark: they are read in the negative of the pictures ({}); {}",
                     tags, inverted);
}

}  // namespace apriltrack::app
