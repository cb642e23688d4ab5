#include "lens.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

/// Points (i + 1/2) (1, x, y) / count of the time in the exposure and of the place in a pixel, wrapped. As
/// many as keep the error of a step of light at rest below 0.11 %; x and y near count / 2, so that slow
/// motion, which shifts the places from look to look, leaves them spread.
struct Lattice {
  double min_sigma_px;
  int count, x, y;
};
constexpr Lattice kLattices[] = {{0.35, 13, 6, 4}, {0.0, 32, 15, 41}};

constexpr double kReach_sigmas = 4.8;  // the variance is then short by 3e-5 of itself

const Lattice& lattice_for(double sigma_px) {
  return *std::find_if(std::begin(kLattices), std::end(kLattices),
                       [&](const Lattice& lattice) { return sigma_px >= lattice.min_sigma_px; });
}

/// In [-1/2, 1/2).
double wrapped(double value) {
  return value - std::floor(value + 0.5);
}

std::vector<float> gaussian_about(double offset_px, double sigma_px) {
  const int reach = static_cast<int>(std::ceil(kReach_sigmas * sigma_px - 0.5));
  std::vector<float> weights;
  for (int n = -reach; n <= reach; ++n) {
    const double from_middle = (n + offset_px) / sigma_px;
    weights.push_back(static_cast<float>(std::exp(-0.5 * from_middle * from_middle)));
  }
  return weights;
}

double sum(const std::vector<float>& weights) {
  double total = 0.0;
  for (const float weight : weights) total += weight;
  return total;
}

/// out = sum of lines[k] * weights[k], or that added to it. In strips, so that sums stay in registers.
void combine(const std::vector<const float*>& lines, const std::vector<float>& weights, bool adds, int count,
             float* out) {
  constexpr int kStrip = 16;
  for (int start = 0; start < count; start += kStrip) {
    float strip[kStrip] = {};
    const int width = std::min(kStrip, count - start);
    if (width == kStrip) {
      for (std::size_t k = 0; k < weights.size(); ++k) {
        const float* line = lines[k] + start;
        for (int x = 0; x < kStrip; ++x) strip[x] += weights[k] * line[x];
      }
    } else {
      for (std::size_t k = 0; k < weights.size(); ++k) {
        for (int x = 0; x < width; ++x) strip[x] += weights[k] * lines[k][start + x];
      }
    }
    for (int x = 0; x < width; ++x) out[start + x] = adds ? out[start + x] + strip[x] : strip[x];
  }
}

Image<float> combine_in_rows(const Image<float>& in, const std::vector<float>& weights) {
  const auto reach = static_cast<std::ptrdiff_t>(weights.size() / 2);
  std::vector<float> padded(static_cast<std::size_t>(in.width() + 2 * reach));
  std::vector<const float*> lines;
  for (std::size_t k = 0; k < weights.size(); ++k) lines.push_back(padded.data() + k);
  Image<float> out(in.width(), in.height());
  for (int y = 0; y < in.height(); ++y) {
    const float* row = in.row(y);
    std::fill_n(padded.begin(), reach, row[0]);
    std::copy_n(row, in.width(), padded.begin() + reach);
    std::fill_n(padded.end() - reach, reach, row[in.width() - 1]);
    combine(lines, weights, false, in.width(), out.row(y));
  }
  return out;
}

void add_columns(const Image<float>& in, const std::vector<float>& weights, Image<float>& sum) {
  const int count = static_cast<int>(weights.size());
  std::vector<const float*> lines(weights.size());
  for (int y = 0; y < in.height(); ++y) {
    for (int k = 0; k < count; ++k)
      lines[static_cast<std::size_t>(k)] = in.row(std::clamp(y + k - count / 2, 0, in.height() - 1));
    combine(lines, weights, true, in.width(), sum.row(y));
  }
}

}  // namespace

Lens::Lens(double sigma_px) {
  if (sigma_px <= 0.0) {
    looks_.push_back({.offset_px = Eigen::Vector2f::Zero(), .across = {1.0F}, .down = {1.0F}});
    return;
  }
  const Lattice& lattice = lattice_for(sigma_px);
  double total = 0.0;
  for (int i = 0; i < lattice.count; ++i) {
    const double time = (i + 0.5) / lattice.count;
    const Eigen::Vector2d offset(wrapped(time * lattice.x - 0.5), wrapped(time * lattice.y - 0.5));
    looks_.push_back({.offset_px = offset.cast<float>(),
                      .across = gaussian_about(offset.x(), sigma_px),
                      .down = gaussian_about(offset.y(), sigma_px)});
    total += sum(looks_.back().across) * sum(looks_.back().down);
  }
  for (Look& look : looks_) {
    for (float& weight : look.down) weight = static_cast<float>(weight / total);
  }
}

void Lens::add(const Image<float>& seen, int look, Image<float>& blurred) const {
  const Look& one = looks_[static_cast<std::size_t>(look)];
  add_columns(combine_in_rows(seen, one.across), one.down, blurred);
}

}  // namespace apriltrack
