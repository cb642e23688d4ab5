#include "jpeg_picture.h"

// In this order: libjpeg's headers need FILE and size_t, and jerror.h needs jpeglib.h.
// clang-format off
#include <cstddef>
#include <cstdio>
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <array>
#include <csetjmp>
#include <opencv2/imgproc.hpp>

#include "apriltrack/base/error.h"
#include "tiff_directory.h"

namespace apriltrack {
namespace {

constexpr int kExifMarker = JPEG_APP0 + 1;
constexpr unsigned kMaxMarkerBytes = 0xFFFF;
/// Cheap cameras leave a byte or two before the end marker, which hurt nobody. More of them are left over
/// where the decoder lost its place.
constexpr int kMostStrayBytes = 4;

/// libjpeg's error manager with a place to jump to, and what it told first.
struct ErrorManager {
  jpeg_error_mgr base;  ///< First, for libjpeg hands out a pointer to it.
  std::jmp_buf way_out;
  jpeg_progress_mgr progress;
  std::array<char, JMSG_LENGTH_MAX> told;
  bool is_damaged;
};

ErrorManager& manager_of(j_common_ptr codec) {
  return *reinterpret_cast<ErrorManager*>(codec->err);
}

void on_error(j_common_ptr codec) {
  ErrorManager& manager = manager_of(codec);
  manager.base.format_message(codec, manager.told.data());
  manager.is_damaged = true;
  std::longjmp(manager.way_out, 1);
}

/// level: -1 of a warning, which is of damaged data and ends the work, for such a picture is refused; above,
/// of what is no matter.
void on_message(j_common_ptr codec, int level) {
  if (level >= 0) return;
  const jpeg_error_mgr& error = manager_of(codec).base;
  const bool is_harmless = error.msg_code == JWRN_ADOBE_XFORM || error.msg_code == JWRN_JFIF_MAJOR ||
                           (error.msg_code == JWRN_EXTRANEOUS_DATA && error.msg_parm.i[0] <= kMostStrayBytes);
  if (!is_harmless) on_error(codec);
}

/// 1 where the file does not tell.
std::int64_t orientation_of(const jpeg_decompress_struct& codec) {
  constexpr std::string_view kExif("Exif\0\0", 6);
  for (jpeg_saved_marker_ptr marker = codec.marker_list; marker != nullptr; marker = marker->next) {
    const std::string_view data(reinterpret_cast<const char*>(marker->data), marker->data_length);
    if (marker->marker == kExifMarker && data.starts_with(kExif))
      return tiff_value(data.substr(kExif.size()), kTiffOrientation).value_or(1);
  }
  return 1;
}

/// A small file may hold scans without end, each over the whole picture; cameras make ten.
void limit_scans(j_common_ptr codec) {
  constexpr int kMostScans = 200;
  const auto* decoder = reinterpret_cast<const jpeg_decompress_struct*>(codec);
  if (decoder->input_scan_number <= kMostScans) return;
  codec->err->msg_code = JERR_BAD_SCAN_SCRIPT;
  codec->err->msg_parm.i[0] = decoder->input_scan_number;
  on_error(codec);
}

/// Rows of grey values; nothing with a destructor may live here, for libjpeg jumps out of it. into: stays
/// empty where the file has four inks, which libjpeg does not turn grey.
void decode_rows(jpeg_decompress_struct& codec, ErrorManager& manager, std::string_view bytes, cv::Mat& into,
                 std::int64_t& orientation) {
  if (setjmp(manager.way_out) != 0) return;
  jpeg_create_decompress(&codec);
  codec.progress = &manager.progress;
  jpeg_save_markers(&codec, kExifMarker, kMaxMarkerBytes);
  jpeg_mem_src(&codec, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&codec, TRUE);
  orientation = orientation_of(codec);
  constexpr int kInks = 4;
  if (codec.num_components == kInks) return;
  codec.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&codec);
  into.create(static_cast<int>(codec.output_height), static_cast<int>(codec.output_width), CV_8UC1);
  while (codec.output_scanline < codec.output_height) {
    JSAMPROW row = into.ptr<std::uint8_t>(static_cast<int>(codec.output_scanline));
    jpeg_read_scanlines(&codec, &row, 1);
  }
  jpeg_finish_decompress(&codec);
}

/// EXIF 2.3, section 4.6.4: where the file's first row and column are in the upright picture.
cv::Mat upright(const cv::Mat& stored, std::int64_t orientation) {
  constexpr int kBothAxes = -1, kUpsideDown = 0, kLeftToRight = 1;
  cv::Mat turned;
  const bool is_on_its_side = orientation >= 5 && orientation <= 8;
  if (is_on_its_side)
    cv::transpose(stored, turned);
  else
    turned = stored;
  if (orientation == 2 || orientation == 6) cv::flip(turned, turned, kLeftToRight);
  if (orientation == 3 || orientation == 7) cv::flip(turned, turned, kBothAxes);
  if (orientation == 4 || orientation == 8) cv::flip(turned, turned, kUpsideDown);
  return turned;
}

}  // namespace

JpegPicture decode_jpeg(std::string_view bytes, PictureTurn turn) {
  jpeg_decompress_struct codec{};
  ErrorManager manager{};
  codec.err = jpeg_std_error(&manager.base);
  manager.base.error_exit = on_error;
  manager.base.emit_message = on_message;
  manager.progress.progress_monitor = limit_scans;
  JpegPicture picture;
  std::int64_t orientation = 1;
  decode_rows(codec, manager, bytes, picture.pixels, orientation);
  if (manager.is_damaged) {
    picture.damage = manager.told.data();
    picture.pixels.release();
  } else if (!picture.pixels.empty() && turn == PictureTurn::kUpright) {
    picture.pixels = upright(picture.pixels, orientation);
  }
  jpeg_destroy_decompress(&codec);
  return picture;
}

}  // namespace apriltrack
