#pragma once

#include <cstddef>
#include <string>

namespace apriltrack::app {

/// Why a recording of nothing but blank images (is_blank()) gives no result, and what to ask.
std::string told_of_blank_images(std::size_t num_images);

}  // namespace apriltrack::app
