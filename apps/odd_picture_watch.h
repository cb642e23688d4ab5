#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "apriltrack/detect/odd_pictures.h"
#include "apriltrack/image/even_sample.h"

namespace apriltrack::app {

/// Keeps small copies of a few frames without tags, in case that hardly any frame has one: then it asks
/// whether the pictures are mirrored, or light and dark exchanged.
class OddPictureWatch {
 public:
  void add(const GrayView& image, std::span<const Detection> detections);

  /// nullopt, at once, where more than one frame in ten shows a tag that was read without a corrected bit.
  std::optional<OddPictures> look(const DetectorOptions& detector) const;
  /// Where tags are read in some frames, and in a quarter or more none: what is wrong with these, if it is
  /// the same with three in four of those that were kept. A mirror in the picture is seen more seldom.
  std::optional<OddPictures> look_among_good(const DetectorOptions& detector) const;
  /// The same in words, with the way out; nullopt likewise.
  std::optional<std::string> told(const DetectorOptions& detector) const;

 private:
  EvenSample tagless_{4};  // a search in each of three ways takes 0.1 to 0.3 s
  std::size_t num_frames_ = 0;
  std::size_t num_with_tags_ = 0;
};

/// "the pictures are mirrored: ...", with what to do. families: asked for; are_all: else some alone are odd.
std::string told(const OddPictures& odd, std::span<const std::string> families, bool are_all = true);

}  // namespace apriltrack::app
