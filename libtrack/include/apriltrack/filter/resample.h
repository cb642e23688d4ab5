#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "apriltrack/base/random.h"

namespace apriltrack {

/// Indices of the particles that live on, ascending: particle i count * weights[i] times in the mean, by
/// independent draws (the SIR filter as first written: Gordon, Salmond, Smith 1993). weights sum to 1.
std::vector<std::size_t> resample_multinomial(std::span<const double> weights, std::size_t count,
                                              RandomStream& random);

}  // namespace apriltrack
