#include "apriltrack/base/random.h"

#include <cmath>
#include <numbers>

namespace apriltrack {
namespace {

constexpr std::uint64_t kGoldenGamma = 0x9e3779b97f4a7c15;

std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t key_1, std::uint64_t key_2)
    : key_(mix(mix(mix(seed + kGoldenGamma) + key_1 + kGoldenGamma) + key_2 + kGoldenGamma)) {}

RandomStream::result_type RandomStream::operator()() {
  return mix(key_ + kGoldenGamma * ++counter_);
}

double RandomStream::uniform() {
  return static_cast<double>((*this)() >> 11) * 0x1.0p-53;
}

double RandomStream::uniform(double low, double high) {
  return low + (high - low) * uniform();
}

double RandomStream::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

}  // namespace apriltrack
