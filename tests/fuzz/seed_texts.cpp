#include "seed_texts.h"

namespace apriltrack::fuzz {
namespace {

constexpr const char* kConstraints = R"(apriltrack_constraints: 1
constraints:
  - {type: distance, name: door, tags: [3, tag25h9/4], distance_m: 0.512, sigma_m: 0.001}
  - {type: position, tag: 3, position_m: {x: 1.20, z: 0.85}, sigma_m: 0.002}
  - type: relative_pose
    tags: [5, 6]
    position_m: {x: 0.30, y: 0.0, z: 0.0}
    orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}
    sigma_m: 0.0005
    sigma_rad: 0.002
  - {type: coplanar, tags: [7, 8, 9, 10], sigma_m: 0.001, sigma_rad: 0.01}
  - {type: upright, tags: [7, 8], sigma_rad: 0.01}
  - {type: floor, tags: [11, 12], sigma_m: 0.002, sigma_rad: 0.01}
  - {type: gravity, tag: 5, direction: {x: 0.01, y: 9.80, z: -0.12}, sigma_rad: 0.005}
  - {type: gravity, camera: cam0, timestamp_ns: 1403636579763555584, direction: {x: 0, y: 9.81, z: 0}, sigma_rad: 0.01}
)";

constexpr const char* kEuroc = R"(%YAML:1.0
sensor_type: camera
comment: VI-Sensor cam0
T_BS:
  cols: 4
  rows: 4
  data: [0.01, -0.99, 0.004, -0.02, 0.99, 0.01, 0.02, -0.06, -0.02, 0.003, 0.99, 0.009, 0, 0, 0, 1]
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375]
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
)";

constexpr const char* kNerfstudio =
    R"({"camera_model": "OPENCV", "fl_x": 600.5, "fl_y": 601.25, "cx": 320.5, "cy": 241.5,
 "w": 640, "h": 480, "k1": 0.1, "k2": -0.2, "p1": 0.003, "p2": 0.004, "frames": []})";

constexpr const char* kOpenIcc =
    R"({"stabelized": false, "fps": 60.0, "final_reproj_error": 0.3, "nr_calib_images": 90,
 "image_width": 960, "image_height": 540, "intrinsic_type": "FISHEYE",
 "intrinsics": {"aspect_ratio": 1.0, "focal_length": 438.5, "principal_pt_x": 481.0, "principal_pt_y": 270.0, "skew": 0.0,
 "radial_distortion_1": 0.05, "radial_distortion_2": 0.05, "radial_distortion_3": -0.03, "radial_distortion_4": 0.01}})";

constexpr const char* kRosIni = R"(# oST version 5.0 parameters

[image]

width
640

height
480

[narrow_stereo]

camera matrix
600.0 0.0 320.0
0.0 601.0 240.0
0.0 0.0 1.0

distortion
0.1 -0.2 0.001 0.002 0.0

rectification
1.0 0.0 0.0
0.0 1.0 0.0
0.0 0.0 1.0

projection
600.0 0.0 320.0 0.0
0.0 601.0 240.0 0.0
0.0 0.0 1.0 0.0
)";

constexpr const char* kOpenCvXml = R"(<?xml version="1.0"?>
<opencv_storage>
<image_width>640</image_width>
<image_height>480</image_height>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows><cols>3</cols><dt>d</dt>
  <data>600. 0. 320. 0. 601. 240. 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>5</rows><cols>1</cols><dt>d</dt>
  <data>0.1 -0.2 0.001 0.002 0.003</data></distortion_coefficients>
</opencv_storage>
)";

constexpr const char* kMrcal = R"({ 'lensmodel': 'LENSMODEL_OPENCV12',
  'intrinsics': [ 600., 601., 320., 240., 0.1, -0.2, 0.001, 0.002, 0.003, 0., 0., 0., 1e-5, 0., 0., 0.,],
  'extrinsics': [ 0.1, 0.2, 0.3, 1., 2., 3.,],
  'imagersize': [ 640, 480,],
}
)";

constexpr const char* kKalibrGrid = R"(target_type: 'aprilgrid'
tagCols: 6
tagRows: 6
tagSize: 0.088
tagSpacing: 0.3
)";

constexpr const char* kTagSlam = R"(bodies:
  - room:
      is_static: true
      is_default_body: true
      default_tag_size: 0.16
      pose: {position: {x: 0, y: 0, z: 0}, rotation: {x: 0, y: 0, z: 0}, R: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
      tags:
      - id: 4
        size: 0.12
        pose: {position: {x: 1, y: 2.5, z: 0.1}, rotation: {x: 0.1, y: 0.2, z: -0.3}}
)";

constexpr const char* kApriltagRos = R"(standalone_tags: [{id: 9, size: 0.1}]
tag_bundles:
  [{name: 'b', layout: [{id: 0, size: 0.1, x: 0, y: 0, z: 0, qw: 1, qx: 0, qy: 0, qz: 0},
    {id: 1, size: 0.12, x: 0.5, y: 0.25, z: -0.1, qw: 0.5, qx: 0.5, qy: 0.5, qz: 0.5}]}]
)";

constexpr const char* kKalibrRig = R"(cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.2, 0.1, 0.001, 0.002]
  distortion_model: radtan
  intrinsics: [461.5, 460.25, 362.5, 246.5]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  response: gamma:2.2
cam1:
  T_cn_cnm1: [[1.0, 0.0, 0.0, -0.11], [0.0, 1.0, 0.0, 0.001], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
  camera_model: pinhole
  distortion_coeffs: [-0.2, 0.1, 0.001, 0.002]
  distortion_model: equidistant
  intrinsics: [461.5, 460.25, 362.5, 246.5]
  line_delay: 1.0e-05
  label: left
  resolution: [752, 480]
)";

constexpr const char* kBasalt = R"({"value0": {
  "T_imu_cam": [
    {"px": 1, "py": 2, "pz": 3, "qx": 0, "qy": 0, "qz": 0.7071067811865476, "qw": 0.7071067811865476},
    {"px": 5, "py": 7, "pz": 11, "qx": 0, "qy": 0, "qz": 0, "qw": 1}],
  "intrinsics": [
    {"camera_type": "kb4", "intrinsics": {"fx": 380.5, "fy": 381.25, "cx": 321.5, "cy": 241.75,
      "k1": 0.01, "k2": -0.02, "k3": 0.003, "k4": -0.0004}},
    {"camera_type": "pinhole-radtan8", "intrinsics": {"fx": 269.5, "fy": 270.25, "cx": 322.5, "cy": 228.75,
      "k1": 0.3, "k2": -0.021, "p1": -0.00025, "p2": 0.000061, "k3": 0.0158, "k4": 0.575, "k5": -0.063,
      "k6": 0.034, "rpmax": 2.7276}}],
  "resolution": [[640, 480], [648, 488]],
  "vignette": [], "imu_update_rate": 200.0, "cam_time_offset_ns": 0}})";

constexpr const char* kVinsPinhole = R"(%YAML:1.0
---
model_type: PINHOLE
camera_name: camera
image_width: 752
image_height: 480
distortion_parameters:
   k1: -0.29
   k2: 0.09
   p1: 0.00012
   p2: -0.00003
projection_parameters:
   fx: 461.5
   fy: 460.25
   cx: 363.5
   cy: 248.125
)";

constexpr const char* kVinsFisheye = R"(%YAML:1.0
---
model_type: KANNALA_BRANDT
image_width: 512
image_height: 510
projection_parameters:
   k2: -0.01
   k3: 0.03
   k4: -0.04
   k5: 0.016
   mu: 190.5
   mv: 191.25
   u0: 254.5
   v0: 256.75
)";

constexpr const char* kOrbSlam = R"(%YAML:1.0
File.version: "1.0"
Camera.type: "KannalaBrandt8"
Camera1.fx: 458.5
Camera1.fy: 457.25
Camera1.cx: 367.125
Camera1.cy: 248.5
Camera1.k1: 0.003
Camera1.k2: 0.0007
Camera1.k3: -0.002
Camera1.k4: 0.0002
Camera2.fx: 459.5
Camera2.fy: 457.25
Camera2.cx: 367.125
Camera2.cy: 248.5
Camera2.k1: 0.1
Camera2.k2: 0.2
Camera2.k3: 0.3
Camera2.k4: 0.4
Camera.width: 752
Camera.height: 480
Camera.fps: 20
Stereo.T_c1_c2: !!opencv-matrix
   rows: 4
   cols: 4
   dt: f
   data: [1, 0, 0, 0.11, 0, 1, 0, 0.001, 0, 0, 1, 0.002, 0, 0, 0, 1]
)";

constexpr const char* kOrbSlam2 = R"(%YAML:1.0
Camera.fx: 458.5
Camera.fy: 457.25
Camera.cx: 367.125
Camera.cy: 248.5
Camera.k1: -0.28
Camera.k2: 0.07
Camera.p1: 0.0002
Camera.p2: 0.00002
Camera.k3: 1.1
Camera.width: 752
Camera.height: 480
)";

std::string response_table() {
  std::string text = "# light\n";
  for (int i = 0; i < 256; ++i) text += std::to_string(i * i) + (i % 8 == 7 ? "\n" : " ");
  return text;
}

}  // namespace

std::vector<SeedText> seed_texts() {
  return {
      {"constraints", kConstraints},
      {"tag_sizes", "default: 0.12\nsizes: {3: 0.16, tag25h9/4: 0.05}\n"},
      {"aprilgrid", kKalibrGrid},
      {"map", kKalibrGrid},
      {"map", kTagSlam},
      {"map", kApriltagRos},
      {"map", "1 0.5 -1.25 2 0 1.57 0.1\n7 1 2 3 0.1 -0.2 3\n"},
      {"map", "Marker\\Priors = 1 0.5 -1.25 2 0 1.57 0.1|7 1 2 3 0.1 -0.2 3\n"},
      {"map", "ID,X,Y,Z,Z-Rotation,X-Rotation\n1,593.68,9.68,53.38,120,0\n2,637.21,34.79,53.38,120,30\n"},
      {"camera", kEuroc},
      {"camera", kNerfstudio},
      {"camera", kOpenIcc},
      {"camera", kRosIni},
      {"camera", kOpenCvXml},
      {"camera", kMrcal},
      {"camera", kKalibrRig},
      {"camera", kBasalt},
      {"camera", kVinsPinhole},
      {"camera", kVinsFisheye},
      {"camera", kOrbSlam},
      {"camera", kOrbSlam2},
      {"response_table", response_table()},
      {"frames_csv", "timestamp_ns,exposure_s,gain\n0,0.016,1\n1000,,2.5\n2000,0.004,\n"},
      {"yaml", "a: [1, 2.5, .inf, 010]\nb: &x {c: \"d\\n\", e: 'f'}\ng: *x\nh: !!opencv-matrix\n  rows: 1\n"},
      {"json", R"({"a": [1, -2.5e3, true, null], "b": {"c": "\u00e9\n"}})"},
      {"trajectory", "# timestamp tx ty tz qx qy qz qw\n1.5 1 2 3 0 0 0 1\n1.6 1 2 3.5 0.5 0.5 0.5 0.5\n"},
      {"image", "P2\n# c\n3 2\n15\n0 1 2\n3 4 15\n"},
  };
}

}  // namespace apriltrack::fuzz
