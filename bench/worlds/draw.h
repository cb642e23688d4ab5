#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <span>

#include "apriltrack/base/random.h"

namespace apriltrack::worlds {

/// Parts of a world draw from streams of their own, so that a change in one part leaves the others as they
/// were.
enum class Part : std::uint64_t {
  kKind,
  kSurroundings,
  kTags,
  kLens,
  kSensor,
  kMotion,
  kLight,
  kDisturbances,
  kFault
};

/// Draws of one part of one attempt at a world.
class Draw {
 public:
  Draw(std::uint64_t seed, Part part, std::uint64_t attempt = 0)
      : random_(seed, 0x776f'726c'6400 + static_cast<std::uint64_t>(part), attempt) {}

  double uniform(double low, double high) { return random_.uniform(low, high); }
  double log_uniform(double low, double high) {
    return std::exp(random_.uniform(std::log(low), std::log(high)));
  }
  double normal() { return random_.normal(); }
  /// In [low, high], both included.
  int integer(int low, int high) { return low + static_cast<int>(random_.uniform() * (high - low + 1)); }
  bool chance(double probability) { return random_.uniform() < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  template <typename T, std::size_t N>
  T one_of(const T (&choices)[N]) {
    return choices[integer(0, static_cast<int>(N) - 1)];
  }
  /// Index into `weights`, which need not add up to 1.
  std::size_t weighted(std::span<const double> weights) {
    double total = 0.0;
    for (const double weight : weights) total += weight;
    double left = uniform(0.0, total);
    for (std::size_t i = 0; i + 1 < weights.size(); ++i) {
      if (left < weights[i]) return i;
      left -= weights[i];
    }
    return weights.size() - 1;
  }
  Eigen::Vector3d normal_vector() { return {normal(), normal(), normal()}; }
  RandomStream& stream() { return random_; }

 private:
  RandomStream random_;
};

}  // namespace apriltrack::worlds
