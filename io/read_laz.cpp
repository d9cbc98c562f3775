// SPDX-License-Identifier: GPL-3.0-or-later
// LAZ: header, records and chunk table by ourselves; the points through the LASzip library where the build
// has it (io/laszip.cpp), else through scripts/laz (Node and npm's laz-perf) in a process of its own.
#include "io/child_process.h"
#include "io/cloud_formats.h"
#include "io/laz_stream.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace dendrofit {
namespace {

constexpr std::uint32_t kVariableChunks = 0xffffffff;

}  // namespace

// A decoder believes what it is told: what the chunk table contradicts is found here, before it runs.
void check_laz_chunks(const FileBytes& bytes, const LasHeader& h) {
  const auto fail = [&](std::uint64_t at, const std::string& what) {
    fail_at_byte(bytes.path(), at, what + "; the file is truncated or damaged, copy it again");
  };
  if (h.chunk_points == 0)
    fail(h.points_offset, "compressed points without a 'laszip encoded' record that says how");
  if (h.point_count == 0) fail_in_file(bytes.path(), "holds no points; is it the file you meant?");
  auto table = bytes.number<std::uint64_t>(h.points_offset, "place of the chunk table");
  if (table == ~std::uint64_t{0})
    table = bytes.number<std::uint64_t>(bytes.size() - 8, "place of the chunk table");
  if (table < h.points_offset + 8 || table > bytes.size() || bytes.size() - table < 8)
    fail(h.points_offset,
         "a chunk table at byte " + std::to_string(table) + " of " + std::to_string(bytes.size()));
  const auto chunks = bytes.number<std::uint32_t>(table + 4, "number of chunks");
  // Each chunk starts with one point as it is.
  const std::uint64_t most = (table - h.points_offset - 8) / h.record_length;
  if (chunks == 0 || chunks > most)
    fail(table + 4, std::to_string(chunks) + " chunks of points where " + std::to_string(most) + " fit");
  if (h.chunk_points == kVariableChunks) return;
  const std::uint64_t needed = (h.point_count + h.chunk_points - 1) / h.chunk_points;
  if (needed != chunks)
    fail(table + 4, "the header claims " + std::to_string(h.point_count) + " points, which are " +
                        std::to_string(needed) + " chunks; the file has " + std::to_string(chunks));
}

void fail_laz_damaged(const FileBytes& bytes, std::uint64_t points, std::uint64_t of) {
  fail_at_byte(bytes.path(), bytes.size(),
               "decompression failed after " + std::to_string(points) + " of " + std::to_string(of) +
                   " points; the file is damaged, copy it again");
}

#if !DENDROFIT_HAS_LASZIP

namespace {

// The folder with laz_points.js: named by the environment, installed beside the program, or in the sources.
std::filesystem::path helper_folder() {
  std::vector<std::filesystem::path> folders;
  if (const char* set = std::getenv("DENDROFIT_LAZ_HELPER")) folders.emplace_back(set);
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back(program.parent_path().parent_path() / "share" / "dendrofit" / "laz");
  folders.emplace_back(DENDROFIT_LAZ_FOLDER);
  for (const std::filesystem::path& folder : folders)
    if (std::filesystem::exists(folder / "laz_points.js", error)) return folder;
  return folders.back();
}

}  // namespace

void laz_records(const FileBytes& bytes, const LasHeader& h,
                 const std::function<void(const char* records, std::uint64_t count)>& take,
                 Progress& progress) {
  const std::filesystem::path node = find_program({"node", "nodejs"});
  const std::filesystem::path folder = helper_folder();
  std::error_code ignored;
  if (node.empty() || !std::filesystem::exists(folder / "node_modules" / "laz-perf", ignored))
    fail_in_file(
        bytes.path(),
        "is compressed (LAZ) and the decompressor is not installed; install it with 'sudo apt-get install -y "
        "nodejs npm && npm ci --prefix " +
            folder.string() + "', or save the cloud as .las");
  ChildProcess child(
      {node.string(), (folder / "laz_points.js").string(), std::filesystem::absolute(bytes.path()).string()});
  std::vector<char> block(std::size_t{h.record_length} * 65536);
  std::uint64_t done = 0;
  while (done < h.point_count) {
    const std::uint64_t points = std::min<std::uint64_t>(65536, h.point_count - done);
    const std::size_t wanted = points * h.record_length;
    const std::size_t got = child.read(block.data(), wanted);
    take(block.data(), got / h.record_length);
    done += got / h.record_length;
    if (got < wanted) break;
  }
  progress.check();  // a Ctrl-C ends the child too
  if (done < h.point_count || child.wait() != 0) fail_laz_damaged(bytes, done, h.point_count);
}

#endif

PointCloud read_laz(const FileBytes& bytes, Progress& progress) {
  const LasHeader header = read_las_header(bytes);
  check_laz_chunks(bytes, header);
#if DENDROFIT_HAS_LASZIP
  return laszip_read(bytes, header, progress);
#else
  LasDecoder decoder(header, progress);
  laz_records(
      bytes, header, [&](const char* records, std::uint64_t count) { decoder.append(records, count); },
      progress);
  return decoder.take();
#endif
}

}  // namespace dendrofit
