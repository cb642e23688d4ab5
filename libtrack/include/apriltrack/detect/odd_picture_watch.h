#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "apriltrack/detect/odd_pictures.h"
#include "apriltrack/image/even_sample.h"

namespace apriltrack {

/// Finds out whether the images of a recording in which hardly a tag is read are mirrored, or have light and
/// dark exchanged. Keeps small copies of up to four images without tags for that.
class OddPictureWatch {
 public:
  /// The next image of the recording, and what was read in it.
  void add(const GrayView& image, std::span<const Detection> detections);

  /// Searches the copies as find_odd_pictures() does; of the families that `detector` names. nullopt, at
  /// once, where more than one image in ten shows a tag that was read without a corrected bit.
  std::optional<OddPictures> look(const DetectorOptions& detector) const;
  /// Where tags are read in some images and a quarter or more of the images have none: what is wrong with
  /// these, if it is the same in three of four copies. (A mirror that hangs in the scene is seen less often.)
  std::optional<OddPictures> look_among_good(const DetectorOptions& detector) const;
  /// look() in words, with the way out; nullopt likewise.
  std::optional<std::string> message(const DetectorOptions& detector) const;

 private:
  EvenSample tagless_{4};  // a search in each of three ways takes 0.1 to 0.3 s
  std::size_t num_frames_ = 0;
  std::size_t num_with_tags_ = 0;
};

/// For people: "the pictures are mirrored: ...", with what to do. families: those that were asked for.
/// are_all: whether all images are odd, or only some.
std::string message_of(const OddPictures& odd, std::span<const std::string> families, bool are_all = true);

}  // namespace apriltrack
