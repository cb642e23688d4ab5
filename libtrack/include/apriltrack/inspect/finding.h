#pragma once

#include <string>

namespace apriltrack {

enum class FindingSeverity {
  kStops,    ///< A calibration would end without a map, or refuse its input.
  kWarning,  ///< It would go on, to a worse or a smaller map.
  kNote,     ///< Good to know.
};

/// Something that the user should know about recordings before they are used to calibrate.
struct RecordingFinding {
  FindingSeverity severity = FindingSeverity::kNote;
  std::string about;  ///< A fixed word for programs, such as "mixed_resolutions" (docs/file_formats.md).
  std::string text;   ///< For people: what is wrong, and what to do.
};

}  // namespace apriltrack
