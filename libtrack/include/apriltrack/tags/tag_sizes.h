#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// Edge lengths in metres: tag_sizes.yaml, with `--tag-size` as the default for ids it does not name.
class TagSizes {
 public:
  explicit TagSizes(std::optional<double> default_size_m = std::nullopt) : default_size_m_(default_size_m) {}

  void set(const TagKey& key, double size_m) { sizes_m_[key] = size_m; }
  /// For an id of whatever family.
  void set(int id, double size_m) { sizes_by_id_m_[id] = size_m; }
  void set_default(double size_m) { default_size_m_ = size_m; }

  /// `family/ID`, else `ID`, else the default; nullopt when none is given.
  std::optional<double> find(const TagKey& key) const;

 private:
  std::optional<double> default_size_m_;
  std::map<TagKey, double> sizes_m_;
  std::map<int, double> sizes_by_id_m_;
};

/// fallback_size_m: `--tag-size`; the file's own `default` wins over it.
TagSizes read_tag_sizes(const std::filesystem::path& path, std::optional<double> fallback_size_m);

}  // namespace apriltrack
