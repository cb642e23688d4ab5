#include "apriltrack/image/response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

template <class Function>
std::array<float, 256> tabulate(const Function& light_of_code) {
  std::array<float, 256> table{};
  for (int code = 0; code < 256; ++code) table[code] = static_cast<float>(light_of_code(code / 255.0));
  return table;
}

double srgb_to_linear(double code) {
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

double linear_to_srgb(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

template <class T>
Image<T> map_pixels(const GrayView& image, const std::array<T, 256>& table) {
  Image<T> out(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    std::transform(image.row(y), image.row(y) + image.width(), out.row(y),
                   [&](std::uint8_t code) { return table[code]; });
  }
  return out;
}

}  // namespace

ResponseCurve::ResponseCurve(const std::array<float, 256>& linear_light)
    : ResponseCurve(linear_light, "table") {}

ResponseCurve::ResponseCurve(const std::array<float, 256>& linear_light, std::string name)
    : linear_light_(linear_light), name_(std::move(name)) {
  APRILTRACK_CHECK(
      std::all_of(linear_light.begin(), linear_light.end(), [](float v) { return std::isfinite(v); }),
      "a response table must hold finite numbers");
  APRILTRACK_CHECK(std::is_sorted(linear_light.begin(), linear_light.end()),
                   "a response table must never decrease");
}

ResponseCurve ResponseCurve::linear() {
  return ResponseCurve(tabulate([](double code) { return code; }), "linear");
}

ResponseCurve ResponseCurve::srgb() {
  return ResponseCurve(tabulate(srgb_to_linear), "srgb");
}

ResponseCurve ResponseCurve::gamma(double exponent) {
  APRILTRACK_CHECK(exponent >= 0.2 && exponent <= 5.0, "a gamma exponent must lie in [0.2, 5]");
  return ResponseCurve(tabulate([&](double code) { return std::pow(code, exponent); }),
                       fmt::format("gamma:{}", exponent));
}

Image<float> to_linear_light(const GrayView& image, const ResponseCurve& response) {
  return map_pixels(image, response.linear_light());
}

GrayImage to_linear_bytes(const GrayView& image, const ResponseCurve& response) {
  std::array<std::uint8_t, 256> table{};
  for (int code = 0; code < 256; ++code) {
    const float light = std::clamp(response.linear_light()[code], 0.0F, 1.0F);
    table[code] = static_cast<std::uint8_t>(std::lround(255.0F * light));
  }
  return map_pixels(image, table);
}

GrayImage linear_to_srgb_bytes(const GrayView& image) {
  std::array<std::uint8_t, 256> table{};
  for (int code = 0; code < 256; ++code)
    table[code] = static_cast<std::uint8_t>(std::lround(255.0 * linear_to_srgb(code / 255.0)));
  return map_pixels(image, table);
}

}  // namespace apriltrack
