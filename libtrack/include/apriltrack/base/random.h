#pragma once

#include <cstdint>
#include <limits>

namespace apriltrack {

/// A stream of random numbers keyed by what it serves (seed, frame, particle, ...), never by the thread,
/// so that results do not depend on how work is spread. Counter-based: number n is a hash of (key, n).
///
/// Satisfies std::uniform_random_bit_generator. The mixing function is SplitMix64's finaliser
/// (Steele, Lea, Flood, OOPSLA 2014). Unlike the standard's distributions, uniform() and normal() give the
/// same numbers with every standard library.
class RandomStream {
 public:
  using result_type = std::uint64_t;

  explicit RandomStream(std::uint64_t seed, std::uint64_t key_1 = 0, std::uint64_t key_2 = 0);

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

  result_type operator()();
  /// In [0, 1).
  double uniform();
  /// In [low, high).
  double uniform(double low, double high);
  /// Mean 0, standard deviation 1 (Box-Muller).
  double normal();

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace apriltrack
