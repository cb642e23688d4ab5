#include "apriltrack/photometric/pattern_textures.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace apriltrack {
namespace {

constexpr double kMinSigmaInCells = 0.5 / 48.0;  // half a texel of the finest texture
constexpr double kMaxSigmaInCells = 3.0;
constexpr double kStepsPerOctave = 4.0;
/// Of a full cache, the share that goes at once: what is dropped is looked for seldom then.
constexpr std::size_t kDroppedShare = 4;

/// Levels of sigmas in cells lie between -30 and 6.
std::uint64_t key_of(std::size_t index, int level_u, int level_v) {
  constexpr int kOffset = 128;
  return (static_cast<std::uint64_t>(index) << 16) | (static_cast<std::uint64_t>(level_u + kOffset) << 8) |
         static_cast<std::uint64_t>(level_v + kOffset);
}

int level_of_sigma(double sigma_in_cells) {
  const double sigma = std::clamp(sigma_in_cells, kMinSigmaInCells, kMaxSigmaInCells);
  return static_cast<int>(std::lround(kStepsPerOctave * std::log2(sigma)));
}

}  // namespace

PatternTextures::PatternTextures(std::vector<TagPattern> patterns, std::size_t max_bytes)
    : patterns_(std::move(patterns)), max_bytes_(max_bytes) {}

std::shared_ptr<const PatternTexture> PatternTextures::blurred(std::size_t index, double sigma_u,
                                                               double sigma_v) {
  const double cell = patterns_[index].cell_size();
  const int level_u = level_of_sigma(sigma_u / cell), level_v = level_of_sigma(sigma_v / cell);
  const std::uint64_t key = key_of(index, level_u, level_v);
  if (const auto found = entries_.find(key); found != entries_.end()) {
    found->second.last_use = ++num_uses_;
    return found->second.texture;
  }
  const auto sigma_of = [cell](int level) { return cell * std::exp2(level / kStepsPerOctave); };
  const auto texture =
      std::make_shared<const PatternTexture>(patterns_[index], sigma_of(level_u), sigma_of(level_v));
  entries_.emplace(key, Entry{texture, ++num_uses_});
  num_bytes_ += texture->num_bytes();
  if (num_bytes_ > max_bytes_) drop_oldest();
  return texture;
}

void PatternTextures::drop_oldest() {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> by_age;  // last use, key
  for (const auto& [key, entry] : entries_) by_age.emplace_back(entry.last_use, key);
  std::sort(by_age.begin(), by_age.end());
  for (const auto& [last_use, key] : by_age) {
    if (num_bytes_ <= max_bytes_ - max_bytes_ / kDroppedShare) return;
    const auto entry = entries_.find(key);
    num_bytes_ -= entry->second.texture->num_bytes();
    entries_.erase(entry);
  }
}

}  // namespace apriltrack
