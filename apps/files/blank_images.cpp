#include "blank_images.h"

#include <fmt/format.h>

namespace apriltrack::app {

std::string told_of_blank_images(std::size_t num_images) {
  return fmt::format(
      "each of {} frames is of one brightness; is the lens covered, or the exposure much too short (black) "
      "or too long (white)?",
      num_images);
}

}  // namespace apriltrack::app
