// SPDX-License-Identifier: GPL-3.0-or-later
// The LASzip library's one home; compiled only where the build found it.
#include "core/errors.h"
#include "io/laz_stream.h"

#include <cstring>

#include <laszip/laszip_api.h>

namespace dendrofit {
namespace {

// A handle of the library, closed and destroyed whatever happens.
class Handle {
 public:
  explicit Handle(const FileBytes& bytes) : path_(bytes.path()) {
    if (laszip_create(&handle_) != 0) fail_in_file(path_, "the LASzip library could not be started");
  }
  ~Handle() {
    if (reading_) laszip_close_reader(handle_);
    if (writing_) laszip_close_writer(handle_);
    laszip_destroy(handle_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  bool open_reader() {
    laszip_BOOL compressed = 0;
    reading_ = laszip_open_reader(handle_, path_.c_str(), &compressed) == 0;
    return reading_ && laszip_get_point_pointer(handle_, &point_) == 0;
  }
  void open_writer(std::ostream& out, bool compress) {
    writing_ = laszip_open_writer_stream(handle_, out, compress, 0) == 0;
    check(writing_, "compression could not be started");
  }
  void close_writer() {
    writing_ = false;
    check(laszip_close_writer(handle_) == 0, "writing failed");
  }
  void check(bool fine, const std::string& what) {
    if (fine) return;
    laszip_CHAR* why = nullptr;
    laszip_get_error(handle_, &why);
    fail_in_file(path_, what + (why ? std::string(" (") + why + ")" : std::string()));
  }
  bool read_point() { return laszip_read_point(handle_) == 0; }
  const laszip_point_struct& point() const { return *point_; }
  laszip_POINTER get() const { return handle_; }

 private:
  std::filesystem::path path_;
  laszip_POINTER handle_ = nullptr;
  laszip_point_struct* point_ = nullptr;
  bool reading_ = false, writing_ = false;
};

void shift_header(laszip_header_struct& h, const Vec3& shift) {
  h.x_offset += shift.x();
  h.y_offset += shift.y();
  h.z_offset += shift.z();
  h.min_x += shift.x();
  h.max_x += shift.x();
  h.min_y += shift.y();
  h.max_y += shift.y();
  h.min_z += shift.z();
  h.max_z += shift.z();
}

}  // namespace

PointCloud laszip_read(const FileBytes& bytes, const LasHeader& h, Progress& progress) {
  Handle reader(bytes);
  LasDecoder decoder(h, progress);
  if (!reader.open_reader()) fail_laz_damaged(bytes, 0, h.point_count);
  for (std::uint64_t i = 0; i < h.point_count; ++i) {
    if (!reader.read_point()) fail_laz_damaged(bytes, i, h.point_count);
    const laszip_point_struct& p = reader.point();
    decoder.append(p.X, p.Y, p.Z, p.intensity,
                   h.point_format >= 6 ? p.extended_classification : p.classification);
  }
  return decoder.take();
}

void laszip_copy(const FileBytes& bytes, const LasHeader& h, std::ostream& out, bool compress,
                 const Vec3& shift, Progress& progress) {
  Handle reader(bytes), writer(bytes);
  if (!reader.open_reader()) fail_laz_damaged(bytes, 0, h.point_count);
  laszip_header_struct* from = nullptr;
  reader.check(laszip_get_header_pointer(reader.get(), &from) == 0, "no header");
  laszip_header_struct header = *from;
  header.start_of_waveform_data_packet_record = 0;
  header.start_of_first_extended_variable_length_record = 0;
  header.number_of_extended_variable_length_records = 0;
  shift_header(header, shift);
  writer.check(laszip_set_header(writer.get(), &header) == 0, "the header was refused");
  writer.check(laszip_preserve_generating_software(writer.get(), 1) == 0, "the header was refused");
  writer.check(laszip_request_native_extension(writer.get(), 1) == 0, "the header was refused");
  writer.open_writer(out, compress);
  progress.begin("copying", static_cast<double>(h.point_count), "points");
  for (std::uint64_t i = 0; i < h.point_count; ++i) {
    if (!reader.read_point()) fail_laz_damaged(bytes, i, h.point_count);
    writer.check(laszip_set_point(writer.get(), &reader.point()) == 0, "a point was refused");
    writer.check(laszip_write_point(writer.get()) == 0, "a point could not be written");
    if ((i + 1) % (1 << 18) == 0) {
      progress.advance(1 << 18);
      progress.check();
    }
  }
  writer.close_writer();
}

}  // namespace dendrofit
