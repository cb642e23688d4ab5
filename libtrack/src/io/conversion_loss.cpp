#include "apriltrack/io/conversion_loss.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

struct KindRow {
  LossKind kind;
  std::string_view name;
  LossSubject subject;
};

constexpr KindRow kKinds[] = {
    {LossKind::kSizes, "sizes", LossSubject::kMap},
    {LossKind::kFamilies, "families", LossSubject::kMap},
    {LossKind::kCovariance, "covariance", LossSubject::kMap},
    {LossKind::kTags, "tags", LossSubject::kMap},
    {LossKind::kFrameName, "frame_name", LossSubject::kMap},
    {LossKind::kOrigin, "origin", LossSubject::kMap},
    {LossKind::kFieldSize, "field_size", LossSubject::kMap},
    {LossKind::kMatrixOrder, "matrix_order", LossSubject::kMap},
    {LossKind::kProvenance, "provenance", LossSubject::kMap},
    {LossKind::kStatistics, "statistics", LossSubject::kMap},
    {LossKind::kExtensions, "extensions", LossSubject::kMap},
    {LossKind::kForeignKeys, "foreign_keys", LossSubject::kMap},
    {LossKind::kResolution, "resolution", LossSubject::kCamera},
    {LossKind::kResponse, "response", LossSubject::kCamera},
    {LossKind::kExposure, "exposure", LossSubject::kCamera},
    {LossKind::kLineDelay, "line_delay", LossSubject::kCamera},
    {LossKind::kExtrinsics, "extrinsics", LossSubject::kCamera},
    {LossKind::kRectification, "rectification", LossSubject::kCamera},
    {LossKind::kNames, "names", LossSubject::kCamera},
    {LossKind::kFurtherCameras, "further_cameras", LossSubject::kCamera},
    {LossKind::kSkew, "skew", LossSubject::kCamera},
    {LossKind::kLensTerms, "lens_terms", LossSubject::kCamera},
    {LossKind::kUnreadLens, "unread_lens", LossSubject::kCamera},
    {LossKind::kCameraKeys, "camera_keys", LossSubject::kCamera},
    {LossKind::kTimes, "times", LossSubject::kTrajectory},
    {LossKind::kVelocities, "velocities", LossSubject::kTrajectory},
    {LossKind::kBiases, "biases", LossSubject::kTrajectory},
};

static_assert(std::size(kKinds) == static_cast<std::size_t>(LossKind::kBiases) + 1, "one row of each kind");

constexpr auto kAllKinds = [] {
  std::array<LossKind, std::size(kKinds)> kinds{};
  std::ranges::transform(kKinds, kinds.begin(), &KindRow::kind);
  return kinds;
}();

const KindRow& row_of(LossKind kind) {
  const auto* row = std::ranges::find(kKinds, kind, &KindRow::kind);
  APRILTRACK_CHECK(row != std::end(kKinds), "every kind of loss has a row");
  return *row;
}

constexpr std::array<std::string_view, 5> kHowNames = {"left_out", "assumed", "given", "converted",
                                                       "unknown"};
static_assert(kHowNames.size() == static_cast<std::size_t>(LossHow::kUnknown) + 1);

}  // namespace

std::span<const LossKind> loss_kinds() {
  return kAllKinds;
}

std::string_view to_string(LossKind kind) {
  return row_of(kind).name;
}

LossSubject subject_of(LossKind kind) {
  return row_of(kind).subject;
}

std::string_view to_string(LossHow how) {
  return kHowNames.at(static_cast<std::size_t>(how));
}

}  // namespace apriltrack
