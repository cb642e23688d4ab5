#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "apriltrack/photometric/pattern_texture.h"

namespace apriltrack {

/// The textures of many tags, made when first asked for, in steps of 2^(1/4) of each sigma; sigmas stop at
/// three cells, where no cell is left to see.
///
/// Bounded in memory, all tags together: when it is full, the textures that nobody asked for longest go.
/// Those who hold one keep it alive. A texture is the same whether it was kept or is made anew.
class PatternTextures {
 public:
  /// By family, the sharpest texture takes 0.6 to 1.4 MB, one blurred by a quarter of a cell 25 to 50 kB, by
  /// three cells 160 to 220 kB, for it reaches far beyond the tag: room for thirty tags at their worst.
  static constexpr std::size_t kMaxBytes = std::size_t{40} << 20;

  explicit PatternTextures(std::vector<TagPattern> patterns, std::size_t max_bytes = kMaxBytes);

  /// index: of the pattern. sigma_u, sigma_v: in half tag sizes.
  std::shared_ptr<const PatternTexture> blurred(std::size_t index, double sigma_u, double sigma_v);
  const TagPattern& pattern(std::size_t index) const { return patterns_[index]; }
  /// Of the textures kept.
  std::size_t num_bytes() const { return num_bytes_; }

 private:
  struct Entry {
    std::shared_ptr<const PatternTexture> texture;
    std::uint64_t last_use = 0;
  };
  void drop_oldest();

  std::vector<TagPattern> patterns_;
  std::size_t max_bytes_;
  std::size_t num_bytes_ = 0;
  std::uint64_t num_uses_ = 0;
  std::unordered_map<std::uint64_t, Entry> entries_;  ///< By tag and the levels of its sigmas.
};

}  // namespace apriltrack
