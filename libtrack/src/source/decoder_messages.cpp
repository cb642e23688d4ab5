#include "apriltrack/source/decoder_messages.h"

extern "C" {
#include <libavutil/log.h>
}

#include <opencv2/core/utils/logger.hpp>

namespace apriltrack {

void silence_decoders() {
  av_log_set_level(AV_LOG_QUIET);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

}  // namespace apriltrack
