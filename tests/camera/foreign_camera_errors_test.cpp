// Every way in which a camera file of another program can be wrong, or beyond our lens models.

#include <gmock/gmock.h>

#include <fstream>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera.h"
#include "support/error_message.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using ::testing::HasSubstr;

struct WrongForeignFile {
  std::string name;
  std::string file;
  std::string text;
  std::vector<std::string> expected;  ///< Parts of the message.
};

void PrintTo(const WrongForeignFile& wrong, std::ostream* out) {
  *out << wrong.name;
}

std::vector<WrongForeignFile> wrong_foreign_files() {
  const std::string matrix = "camera_matrix: [400, 0, 300, 0, 410, 200, 0, 0, 1]\n";
  return {
      {"binned",
       "c.yaml",
       matrix + "D: [0, 0, 0, 0]\nbinning_x: -2\nbinning_y: 2\n",
       {"c.yaml:3: binning_x: must lie in [0, 100000] pixels (is -2)"}},
      {"part_of_the_sensor",
       "c.yaml",
       matrix + "D: [0, 0, 0, 0]\nroi: {x_offset: 0, y_offset: 160000, width: 640, height: 464}\n",
       {"c.yaml:3: roi.y_offset: must lie in [0, 100000] pixels (is 160000)"}},
      // COLMAP
      {"colmap_model",
       "cameras.txt",
       "# list\n1 FOV 640 480 500 510 320 240 0.9\n",
       {"cameras.txt:2: the model 'FOV' is not supported", "OPENCV_FISHEYE",
        "--ImageReader.camera_model OPENCV"}},
      {"colmap_parameters",
       "cameras.txt",
       "1 OPENCV 640 480 500 510 320 240 0.1\n",
       {"cameras.txt:1: OPENCV has 8 parameters (there are 5)"}},
      {"colmap_number",
       "cameras.txt",
       "1 PINHOLE 640 480 500 51O 320 240\n",
       {"cameras.txt:1: parameter 2 must be a finite number (is '51O')"}},
      {"colmap_focal",
       "cameras.txt",
       "1 PINHOLE 640 480 500 -510 320 240\n",
       {"cameras.txt:1: fy must be finite and > 0 pixels (is -510)"}},
      {"colmap_width",
       "cameras.txt",
       "1 PINHOLE 0 480 500 510 320 240\n",
       {"cameras.txt:1: the width", "(is '0')"}},
      {"colmap_second_line",
       "cameras.txt",
       "1 PINHOLE 640 480 500 510 320 240\n\n2 PINHOLE\n",
       {"cameras.txt:3: must be"}},
      {"colmap_empty",
       "cameras.txt",
       "# Camera list with one line of data per camera:\n",
       {"no camera in this list"}},
      {"colmap_binary",
       "cameras.bin",
       std::string("\1\0\0\0\0", 5),
       {"zero bytes", "model_converter --output_type TXT"}},
      // mrcal
      {"mrcal_splined",
       "c.cameramodel",
       "{\n 'lensmodel': 'LENSMODEL_SPLINED_STEREOGRAPHIC_order=3',\n 'intrinsics': [1, 1, 1, 1],\n "
       "'imagersize': [6, 4],\n}\n",
       {"c.cameramodel:2: lensmodel: 'LENSMODEL_SPLINED", "mrcal-convert-lensmodel LENSMODEL_OPENCV8"}},
      {"mrcal_numbers",
       "c.cameramodel",
       "{\n 'lensmodel': 'LENSMODEL_OPENCV4',\n 'intrinsics': [1, 1, 1, 1],\n 'imagersize': [6, 4],\n}\n",
       {"c.cameramodel:3: intrinsics: LENSMODEL_OPENCV4 has 8 numbers", "(there are 4)"}},
      {"mrcal_thin_prism",
       "c.cameramodel",
       "{'lensmodel': 'LENSMODEL_OPENCV12', 'imagersize': [6, 4],\n"
       "'intrinsics': [1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0]}\n",
       {"c.cameramodel:2: intrinsics: has 12 coefficients", "apriltrack camera convert --fit"}},
      // ROS .ini
      {"ini_two_cameras",
       "c.ini",
       "[image]\nwidth\n6\nheight\n4\n[left]\ncamera matrix\n1 0 1 0 1 1 0 0 1\n[right]\n",
       {"c.ini: must be of one camera", "there are 2"}},
      {"ini_short_matrix",
       "c.ini",
       "[image]\nwidth\n6\nheight\n4\n[left]\ncamera matrix\n1 0 1\n0 1 1\ndistortion\n0 0 0 0 0\n",
       {"c.ini:7", "camera matrix: must be a 3x3 matrix, 9 numbers (there are 6)"}},
      {"ini_no_distortion",
       "c.ini",
       "[image]\nwidth\n6\nheight\n4\n[left]\ncamera matrix\n1 0 1\n0 1 1\n0 0 1\n",
       {"c.ini: 'distortion' is missing in [left]"}},
      {"ini_width",
       "c.ini",
       "[image]\nwidth\n6.5\nheight\n4\n[left]\ncamera matrix\n1 0 1 0 1 1 0 0 1\ndistortion\n0 0 0 0 0\n",
       {"c.ini:2: width must be a whole number", "6.5"}},
      {"ini_twice",
       "c.ini",
       "[image]\nwidth\n6\nwidth\n6\n[left]\ncamera matrix\n1 0 1 0 1 1 0 0 1\n",
       {"c.ini:4: 'width' stands twice in [image]"}},
      // nerfstudio
      {"nerfstudio_per_frame",
       "transforms.json",
       "{\"camera_model\": \"OPENCV\", \"frames\": [{\"fl_x\": 5}]}",
       {"transforms.json:1", "'fl_x' is missing at the top level"}},
      {"nerfstudio_k4",
       "transforms.json",
       "{\"fl_x\": 5, \"fl_y\": 5, \"cx\": 3, \"cy\": 2, \"w\": 6, \"h\": 4,\n\"k4\": 0.1}",
       {"transforms.json:2: k4: must be 0 (is 0.1)"}},
      {"nerfstudio_model",
       "transforms.json",
       "{\"fl_x\": 5, \"fl_y\": 5, \"cx\": 3, \"cy\": 2, \"w\": 6, \"h\": 4,\n\"camera_model\": "
       "\"EQUIRECTANGULAR\"}",
       {"transforms.json:2: camera_model: 'EQUIRECTANGULAR' is not supported", "OPENCV_FISHEYE"}},
      // OpenImuCameraCalibrator
      {"openicc_model",
       "gopro.json",
       "{\"image_width\": 6, \"image_height\": 4,\n\"intrinsic_type\": \"DOUBLE_SPHERE\", \"intrinsics\": "
       "{\"focal_length\": 5, \"aspect_ratio\": 1, \"principal_pt_x\": 3, \"principal_pt_y\": 2}}",
       {"gopro.json:2: intrinsic_type: 'DOUBLE_SPHERE' is not supported", "FISHEYE"}},
      {"xml_of_others",
       "c.xml",
       "<?xml version=\"1.0\"?>\n<lens/>\n",
       {"c.xml:2: is XML", "<opencv_storage>"}},
      {"xml_skew",
       "c.xml",
       "<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- a\ncomment "
       "-->\n<camera_matrix><rows>3</rows><cols>3</cols>\n<data>5 9 3\n"
       "0 5 2\n0 0 1</data></camera_matrix>\n<distortion_coefficients><data>0 0 0 "
       "0</data></distortion_coefficients>\n"
       "</opencv_storage>\n",
       {"c.xml:5: camera_matrix: a skew of 9 pixels"}},
      {"xml_cut_off",
       "c.xml",
       "<opencv_storage>\n<camera_matrix>\n<rows>3</rows>\n",
       {"c.xml:4: is XML, but"}},
      {"xml_closed_wrongly",
       "c.xml",
       "<opencv_storage>\n<rows>3</cols>\n",
       {"c.xml:2: is XML, but </rows> must stand here"}},
      {"matlab",
       "c.mat",
       "MATLAB 5.0 MAT-file: [1, 2\n}",
       {"c.mat:", "no valid YAML", "camera files that are read: Kalibr", "COLMAP"}},
      {"xml_empty",
       "c.xml",
       "<opencv_storage>\n</opencv_storage>\n",
       {"c.xml:2: is no camera file of a known kind"}},
  };
}

class ForeignFileThatIsWrong : public ::testing::TestWithParam<WrongForeignFile> {};

INSTANTIATE_TEST_SUITE_P(Files, ForeignFileThatIsWrong, ::testing::ValuesIn(wrong_foreign_files()),
                         [](const auto& file) { return file.param.name; });

TEST_P(ForeignFileThatIsWrong, IsRefusedWithThePlaceAndTheWayOut) {
  const auto path = test::temporary_folder() / GetParam().file;
  std::ofstream(path) << GetParam().text;
  const std::string message = test::message_of([&] { read_cameras(path); });
  for (const std::string& part : GetParam().expected) EXPECT_THAT(message, HasSubstr(part));
}

}  // namespace
}  // namespace apriltrack
