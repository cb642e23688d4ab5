#pragma once

#include <string>
#include <vector>

#include "apriltrack/detect/detector.h"
#include "apriltrack/source/frame_source.h"
#include "calibrate_input.h"
#include "console.h"
#include "doctor_facts.h"
#include "frame_options.h"

namespace apriltrack::app {

struct LookOptions {
  std::string camera;  ///< File; empty: a sequence folder's own, where there is one.
  std::string camera_name;
  DetectorOptions detector;
  FrameOptions frames;
  int num_threads = 0;
  bool tries_other_families = true;
};

/// Reads every frame of every INPUT, finds the tags of the families asked for and measures their blur; looks
/// for all other families in small copies of a few frames of each (FamilySample), and, where hardly a tag is
/// read, for tags in the mirror image and the negative of up to 4. Ctrl-C ends it, with the facts until then.
///
/// Images whose names are no times are taken at one a second where no rate is given. Throws as open_source,
/// read_cameras and SessionClocks do.
Facts look_at(const std::vector<std::string>& inputs, const LookOptions& options, const Console& console);

}  // namespace apriltrack::app
