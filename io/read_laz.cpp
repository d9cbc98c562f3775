// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/cloud_formats.h"

namespace dendrofit {

PointCloud read_laz(const FileBytes& bytes, Progress& /*progress*/) {
  fail_in_file(bytes.path(), "a compressed LAS (LAZ); save it as .las");
}

PointCloud read_e57(const FileBytes& bytes, Progress& /*progress*/) {
  fail_in_file(bytes.path(), "an E57 file; save it as .las or .ply");
}

}  // namespace dendrofit
