#include "tracked_film.h"

#include <algorithm>
#include <fstream>
#include <vector>

#include "support/shared_data.h"

namespace apriltrack::test {

void TrackReport::SetUp() {
  if (!folder_.empty()) return;
  folder_ = temporary_folder();
  run_for_json({"simulate", "--scene", "room", "--frames", "14", "--speed", "3", "--output", path("film")});
  std::vector<std::filesystem::path> pictures;
  for (const auto& entry : std::filesystem::directory_iterator(path("film/frames")))
    pictures.push_back(entry.path());
  std::ranges::sort(pictures, {},
                    [](const std::filesystem::path& picture) { return std::stoll(picture.stem()); });
  std::ofstream(pictures.at(3), std::ios::trunc) << "no picture";
  run_ = run_program({"track", path("film"), "--method", "pnp", "--output", path("out.tum"), "--frames-csv",
                      path("frames.csv"), "--report", path("it's.html")});
}

}  // namespace apriltrack::test
