#include "hypotheses/print_errors.h"

#include <utility>

#include "apriltrack/calib/systematic_errors.h"

namespace apriltrack {

std::vector<ParameterView> errors_of_prints(const Observations& observations,
                                            const std::vector<std::size_t>& views, const MapState& state,
                                            const std::optional<PrintBatches>& batches,
                                            const std::optional<double>& aspect,
                                            CameraParameters refined_aspects) {
  std::vector<ParameterView> of_batches, of_aspect;
  if (batches) of_batches = size_errors(observations, views, state, *batches);
  if (aspect) of_aspect = aspect_errors(observations, views, state, *aspect, std::move(refined_aspects));
  return beside(std::move(of_batches), of_aspect);
}

}  // namespace apriltrack
