#pragma once

// What a program that tracks needs. Further parts have headers of their own: source/, sim/, eval/, calib/.

#include "apriltrack/base/error.h"
#include "apriltrack/base/version.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/image/frame.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "apriltrack/tracker/localizer.h"
