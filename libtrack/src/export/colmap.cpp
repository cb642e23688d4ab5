// COLMAP's text model: no camera and no image, and the tags' corners as points, black, without a track. The
// point's id is four times the tag's place in the file, plus the corner, from 1 on; a comment says which tag
// it is.
#include <fmt/format.h>

#include "export_words.h"
#include "writers.h"

namespace apriltrack {

std::vector<ExportedFile> colmap_files(const TagMap& map) {
  std::string points = fmt::format(
      "# 3D point list with one line of data per point:\n#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as "
      "(IMAGE_ID, "
      "POINT2D_IDX)\n# Number of points: {}, mean track length: 0\n",
      4 * map.tags.size());
  int id = 0;
  for (const MapTag& tag : map.tags) {
    points += fmt::format("# {}: bottom left, bottom right, top right, top left\n", to_string(tag.key));
    for (const Eigen::Vector3d& corner : corners_in_map(tag))
      points += fmt::format("{} {} 0 0 0 0\n", ++id, exact_numbers(corner));
  }
  return {{"cameras.txt",
           "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
           "# Number of cameras: 0\n"},
          {"images.txt",
           "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, "
           "CAMERA_ID, NAME\n#   POINTS2D[] as (X, Y, POINT3D_ID)\n# Number of images: 0, mean observations "
           "per image: 0\n"},
          {"points3D.txt", points}};
}

}  // namespace apriltrack
