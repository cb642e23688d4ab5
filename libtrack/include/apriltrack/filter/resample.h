#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "apriltrack/base/random.h"

namespace apriltrack {

/// Indices of the particles that live on, ascending: particle i about count * weights[i] times, never off by
/// more than one (systematic resampling: Kitagawa 1996). One random number. weights sum to 1.
std::vector<std::size_t> resample_systematic(std::span<const double> weights, std::size_t count,
                                             RandomStream& random);

/// The same with independent draws: the SIR filter as first written (Gordon, Salmond, Smith 1993).
std::vector<std::size_t> resample_multinomial(std::span<const double> weights, std::size_t count,
                                              RandomStream& random);

}  // namespace apriltrack
