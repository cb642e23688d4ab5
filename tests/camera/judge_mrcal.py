"""mrcal's own reading, writing and projection of a camera model, for judges_test.cpp.

  judge_mrcal.py project MODEL < points    a pixel for each line "x y z"
  judge_mrcal.py rewrite MODEL COPY        the model as mrcal writes it
"""
import sys

import mrcal
import numpy as np

command, model = sys.argv[1], mrcal.cameramodel(sys.argv[2])
if command == "project":
    points = np.loadtxt(sys.stdin)
    for u, v in mrcal.project(points, *model.intrinsics()):
        print(repr(float(u)), repr(float(v)))
    print("place", *(repr(float(x)) for x in model.extrinsics_rt_fromref()))
    print("size", *model.imagersize())
else:
    model.write(sys.argv[3])
