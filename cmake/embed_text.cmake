# Makes a C++ source of text files, so that the program carries them: a function that returns all of them, one after the other.
# A script of its own, run when one of them changes; it needs no tool beside CMake, also where the compiler is for another machine.
#
#   cmake -DFUNCTION=scene_viewer_script -DHEADER=scene_viewer.h -DOUTPUT=out.cpp "-DFILES=a.js;b.js" -P embed_text.cmake
set(piece_length 30000) # C++ promises literals of 65536 characters only
set(pieces "")
foreach(path IN LISTS FILES)
  file(SIZE ${path} length)
  set(offset 0)
  while(offset LESS length)
    file(READ ${path} piece OFFSET ${offset} LIMIT ${piece_length})
    math(EXPR rest "${length} - ${offset}")
    if(rest GREATER piece_length)
      set(rest ${piece_length})
    endif()
    string(SUBSTRING "${piece}" 0 ${rest} piece) # CMake ends what it reads with a line break
    string(FIND "${piece}" ")APRILTRACK\"" end_mark)
    if(NOT end_mark EQUAL -1)
      message(FATAL_ERROR "${path} has )APRILTRACK\", which ends the literal it is put into")
    endif()
    string(APPEND pieces "    R\"APRILTRACK(${piece})APRILTRACK\",\n")
    math(EXPR offset "${offset} + ${piece_length}")
  endwhile()
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/embed_text.cmake.
#include \"${HEADER}\"

namespace apriltrack {
namespace {

constexpr const char* kPieces[] = {
${pieces}};

}  // namespace

std::string ${FUNCTION}() {
  std::string all;
  for (const char* piece : kPieces) all += piece;
  return all;
}

}  // namespace apriltrack
")
