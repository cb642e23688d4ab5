#include "apriltrack/sim/image_formation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "apriltrack/base/check.h"
#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

void check_range(const char* name, double value, double low, double high) {
  APRILTRACK_CHECK(value >= low && value <= high, std::string(name) + " must lie in [" + std::to_string(low) +
                                                      ", " + std::to_string(high) + "] (is " +
                                                      std::to_string(value) + ")");
}

/// The code whose light is nearest: what rounding does in codes, as far as the curve is straight between
/// neighbours.
class Encoder {
 public:
  explicit Encoder(const ResponseCurve& response) {
    const auto& light = response.linear_light();
    for (std::size_t code = 0; code + 1 < light.size(); ++code)
      upper_[code] = 0.5F * (light[code] + light[code + 1]);
    for (std::size_t bucket = 0; bucket < first_.size(); ++bucket) {
      const float low = static_cast<float>(bucket) / kBuckets;
      first_[bucket] =
          static_cast<std::uint8_t>(std::upper_bound(upper_.begin(), upper_.end(), low) - upper_.begin());
    }
  }

  std::uint8_t operator()(float light) const {
    const float clipped = std::min(std::max(light, 0.0F), 1.0F);
    std::uint8_t code = first_[static_cast<std::size_t>(clipped * kBuckets)];
    while (code < 255 && clipped >= upper_[code]) ++code;
    return code;
  }

 private:
  static constexpr float kBuckets = 4096.0F;
  std::array<float, 255> upper_{};
  std::array<std::uint8_t, 4097> first_{};
};

}  // namespace

void ImageFormation::check() const {
  if (lens_blur_sigma_px != 0.0) check_range("lens_blur_sigma_px, if not 0,", lens_blur_sigma_px, 0.2, 20.0);
  check_range("vignetting", vignetting, 0.0, 0.95);
  check_range("sensor_gain", sensor_gain, 1e-3, 1e3);
  check_range("full_well", full_well, 1.0, 1e9);
  check_range("read_noise", read_noise, 0.0, 1e6);
  check_range("noise", noise, 0.0, 100.0);
  check_range("amplification", amplification, 1e-3, 1e4);
}

void expose_sensor(Image<float>& light, const ImageFormation& formation) {
  const double centre_x = 0.5 * (light.width() - 1);
  const double centre_y = 0.5 * (light.height() - 1);
  const double corner_squared = std::max(centre_x * centre_x + centre_y * centre_y, 1.0);
  for (int y = 0; y < light.height(); ++y) {
    const double dy_squared = (y - centre_y) * (y - centre_y);
    float* row = light.row(y);
    for (int x = 0; x < light.width(); ++x) {
      const double radius_squared = ((x - centre_x) * (x - centre_x) + dy_squared) / corner_squared;
      row[x] *= static_cast<float>(formation.sensor_gain * (1.0 - formation.vignetting * radius_squared));
    }
  }
}

GrayImage develop(const Image<float>& sensor_light, const ResponseCurve& response,
                  const ImageFormation& formation, std::uint64_t seed, std::uint64_t frame_index) {
  const Encoder encode(response);
  const float shot = static_cast<float>(formation.noise * formation.noise / formation.full_well);
  const float read = static_cast<float>(formation.noise * formation.read_noise / formation.full_well);
  const float amplification = static_cast<float>(formation.amplification);
  GrayImage out(sensor_light.width(), sensor_light.height());
  for (int y = 0; y < out.height(); ++y) {
    RandomStream random(seed, frame_index, static_cast<std::uint64_t>(y));
    const float* light = sensor_light.row(y);
    std::uint8_t* codes = out.row(y);
    for (int x = 0; x < out.width(); ++x) {
      const float sigma = std::sqrt(shot * std::max(light[x], 0.0F) + read * read);
      const float seen = sigma > 0.0F ? light[x] + sigma * static_cast<float>(random.normal()) : light[x];
      codes[x] = encode(amplification * seen);
    }
  }
  return out;
}

}  // namespace apriltrack
