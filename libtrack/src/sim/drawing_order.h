#pragma once

#include <cstddef>
#include <vector>

#include "film.h"

namespace apriltrack {

/// Bodies in the order in which they are painted: what lies on the walls first; then each before those that
/// may hide it. Of two bodies, the one on the eye's side of a plane that parts them may hide the other; the
/// planes tried are those of their panels. Where none parts them, the one whose centre is nearer is painted
/// later.
std::vector<std::size_t> drawing_order(const PreparedScene& prepared, double time_s);

}  // namespace apriltrack
