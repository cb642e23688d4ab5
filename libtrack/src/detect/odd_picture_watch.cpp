#include "apriltrack/detect/odd_picture_watch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace apriltrack {

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

std::optional<OddPictures> OddPictureWatch::look_among_good(const DetectorOptions& detector) const {
  const std::size_t num_without = num_frames_ - num_with_tags_;
  if (num_with_tags_ == 0 || 4 * num_without < num_frames_) return std::nullopt;
  const auto odd = find_odd_pictures(tagless_.images(), detector);
  if (!odd || 4 * odd->pictures < 3 * tagless_.images().size()) return std::nullopt;
  return odd;
}

std::optional<std::string> OddPictureWatch::message(const DetectorOptions& detector) const {
  const auto odd = look(detector);
  if (!odd) return std::nullopt;
  return message_of(*odd, detector.families);
}

std::string message_of(const OddPictures& odd, std::span<const std::string> families, bool are_all) {
  const std::string tags =
      odd.tags.size() == 1 ? to_string(*odd.tags.begin())
                           : fmt::format("{} and {} more", to_string(*odd.tags.begin()), odd.tags.size() - 1);
  std::set<std::string> others;  // that are there, and were not asked for
  for (const TagKey& tag : odd.tags)
    if (std::ranges::find(families, tag.family) == families.end()) others.insert("--family " + tag.family);
  const std::string give = others.empty() ? ""
                                          : fmt::format(", and these are no {}: give {}",
                                                        fmt::join(families, ", "), fmt::join(others, " "));
  const std::string pictures = are_all ? "the pictures are" : "some pictures, though not all, are";
  const std::string mirrored =
      "turn mirroring (selfie view) off in the camera, or flip the pictures left to right (ffmpeg -i IN -vf "
      "hflip OUT), and use a camera file made of pictures that are not mirrored";
  const std::string inverted =
      "print tags black on white; pictures that are negatives can be turned (ffmpeg -i IN -vf negate OUT)";
  if (odd.are_mirrored && odd.are_inverted)
    return fmt::format(
        "{} mirrored, and light on dark: tags are read in the negative of their mirror image ({}){}; {}; {}",
        pictures, tags, give, mirrored, inverted);
  if (odd.are_mirrored)
    return fmt::format("{} mirrored: tags are read in their mirror image ({}){}; {}", pictures, tags, give,
                       mirrored);
  return fmt::format("{} light on dark: they are read in the negative of the pictures ({}){}; {}",
                     are_all ? "the tags are" : "the tags of some pictures, though not of all, are", tags,
                     give, inverted);
}

}  // namespace apriltrack
