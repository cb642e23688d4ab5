#pragma once

#include <string>
#include <vector>

#include "apriltrack/report/html_page.h"
#include "calibrate_run.h"

namespace apriltrack::app {

/// What came of the run in a few sentences.
std::string verdict(const CalibrateRun& run);
/// Each tag with its views, residual, errors claimed, and its weakest direction.
HtmlTable tags_table(const TagMap& map, const JointCovariance& joint, const MapEvidence& evidence,
                     const MapAssessment& assessment);
HtmlTable corrections_table(const std::vector<CameraCorrection>& corrections, const std::string& caption);
/// Of each camera that the tags' pictures tell: what was taken for its response, and what they say.
HtmlTable responses_table(const ResponseFindings& responses);
/// "cam0 0.50 px, cam1 0.47 px".
std::string in_words(const std::vector<LensBlur>& lenses);
std::string words_of_refinement(const RefinementResult& refinement);
std::string words_of_halves(const CrossValidation& halves);
HtmlTable halves_table(const CrossValidation& halves);
/// Files and options, defaults included.
HtmlTable calibrate_settings_table(const CalibrateRun& run);

}  // namespace apriltrack::app
