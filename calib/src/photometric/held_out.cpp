#include "photometric/held_out.h"

#include <cmath>
#include <map>
#include <utility>

#include "numerics/upper_median.h"

namespace apriltrack {
namespace {

constexpr double kNumbersOfView = 6.0;
constexpr int kLeastPicturesOfTag = 3;  ///< Fewer may be lost by chance.

struct PicturesOfTag {
  int explained = 0;  ///< Before.
  int lost = 0;       ///< Of these.
};

/// The mean over its standard error, as of Student's test.
void take_gains(const std::map<int, double>& gains, HeldOutComparison& result) {
  const auto num = static_cast<double>(gains.size());
  double mean = 0.0, squares = 0.0;
  for (const auto& [moment, gain] : gains) mean += gain / num;
  for (const auto& [moment, gain] : gains) squares += (gain - mean) * (gain - mean);
  result.moments = static_cast<int>(gains.size());
  if (num < 2.0 || mean == 0.0) return;
  result.gain_in_errors = mean / std::sqrt(squares / (num * (num - 1.0)));
}

}  // namespace

std::optional<HeldOutComparison> compare_held_out(const std::vector<PhotometricView>& views,
                                                  const std::vector<std::optional<double>>& before,
                                                  const std::vector<std::optional<double>>& after) {
  std::vector<double> of_both;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (before[i] && after[i]) of_both.push_back(*after[i]);
  }
  if (of_both.empty()) return std::nullopt;
  const double lost2 = kOutlierOfMedian2 * upper_median(std::move(of_both));
  double squares_before = 0.0, squares_after = 0.0, count = 0.0;
  std::map<int, PicturesOfTag> tags;
  std::map<int, double> gains;  // by moment
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!before[i]) continue;
    squares_before += *before[i];
    squares_after += after[i].value_or(lost2);
    gains[views[i].moment] += *before[i] - after[i].value_or(lost2);
    count += kNumbersOfView;
    PicturesOfTag& tag = tags[views[i].tag];
    ++tag.explained;
    tag.lost += after[i] ? 0 : 1;
  }
  HeldOutComparison result{std::sqrt(squares_before / count), std::sqrt(squares_after / count), 0.0, 0, {}};
  take_gains(gains, result);
  for (const auto& [number, tag] : tags) {
    if (tag.explained >= kLeastPicturesOfTag && 2 * tag.lost > tag.explained)
      result.lost_tags.push_back(number);
  }
  return result;
}

}  // namespace apriltrack
