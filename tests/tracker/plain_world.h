#pragma once

#include <initializer_list>

#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack::test {

/// A pinhole for images of 320 x 240: what is 2 m away moves by 1 px for each centimetre.
inline Camera plain_camera() {
  return {.model = CameraModel({200.0, 200.0, 160.0, 120.0}, NoDistortion{})};
}

/// Tags of 0.2 m with these ids, all in the map's origin.
inline TagMap tags_at_origin(std::initializer_list<int> ids) {
  TagMap map;
  for (const int id : ids) {
    MapTag tag;
    tag.key = {"tag36h11", id};
    tag.size_m = 0.2;
    map.tags.push_back(tag);
  }
  return map;
}

}  // namespace apriltrack::test
