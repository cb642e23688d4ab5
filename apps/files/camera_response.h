#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "apriltrack/source/response_sample.h"
#include "cli/console.h"

namespace apriltrack::app {

/// As response_of_sample(), for a camera, whose response becomes the one that is found; says in words what is
/// used.
ResponseFinding estimate_by_sample(std::span<const SampledInput> inputs, const DetectorOptions& detector,
                                   const TagSizes& sizes, int num_threads, const Console& console,
                                   Camera& camera);

/// Warns, or says what differs without being beyond doubt.
void tell(const ResponseFinding& finding, const Console& console);

/// "stated", "estimated" or "assumed".
const char* word_of(ResponseOrigin origin);
nlohmann::json json_of(const ResponseFinding& finding);

}  // namespace apriltrack::app
