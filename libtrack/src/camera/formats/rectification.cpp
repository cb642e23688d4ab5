#include "rectification.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "../camera_fields.h"

namespace apriltrack {
namespace {

/// Row by row; empty where the node is missing or holds zeros alone.
std::vector<double> stated_matrix(const std::optional<YamlNode>& node, std::size_t size) {
  if (!node || node->is_null()) return {};
  std::vector<double> values = read_matrix_values(*node);
  if (values.size() != size)
    node->fail(fmt::format("must be a matrix of {} numbers (there are {})", size, values.size()));
  if (std::ranges::all_of(values, [](double value) { return value == 0.0; })) return {};
  return values;
}

ConversionLoss of_matrix(LossKind kind, const YamlNode& node, std::vector<double> numbers = {}) {
  return {.kind = kind, .which = {"cam0"}, .value = node.key_path(), .numbers = std::move(numbers)};
}

}  // namespace

void note_rectification(const std::optional<YamlNode>& rectification,
                        const std::optional<YamlNode>& projection, const Pinhole& pinhole,
                        std::vector<ConversionLoss>& lost) {
  const std::vector<double> r = stated_matrix(rectification, 9);
  if (!r.empty() && r != std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1})
    lost.push_back(of_matrix(LossKind::kRectification, *rectification));
  const std::vector<double> p = stated_matrix(projection, 12);
  if (p.empty()) return;
  const std::vector<double> left = {p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]};
  if (left != std::vector<double>{pinhole.fx, 0, pinhole.cx, 0, pinhole.fy, pinhole.cy, 0, 0, 1})
    lost.push_back(of_matrix(LossKind::kRectification, *projection));
  if (p[3] == 0.0 && p[7] == 0.0) return;
  const auto baseline_m = [&](double entry, double focal_px, const char* name) {
    if (entry != 0.0 && !(focal_px > 0.0))
      projection->fail(fmt::format("{} must be > 0 (is {})", name, focal_px));
    return entry == 0.0 ? 0.0 : -entry / focal_px;
  };
  lost.push_back(of_matrix(LossKind::kExtrinsics, *projection,
                           {baseline_m(p[3], p[0], "its fx"), baseline_m(p[7], p[5], "its fy")}));
}

}  // namespace apriltrack
