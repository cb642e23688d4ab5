#pragma once

#include "apriltrack/geometry/tag_corners.h"  // the solver of planar poses needs them, too
