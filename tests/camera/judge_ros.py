"""What ROS's camera_calibration_parsers read from a camera file, for judges_test.cpp: one line a field."""
import sys

import camera_calibration_parsers

name, info = camera_calibration_parsers.readCalibration(sys.argv[1])
print("name", name)
print("size", info.width, info.height)
print("model", info.distortion_model)
print("K", *(repr(float(x)) for x in info.K))
print("D", *(repr(float(x)) for x in info.D))
