// SPDX-License-Identifier: GPL-3.0-or-later
// Stands in for the generated viewer_bundle.cpp in builds with DENDROFIT_VIEWER=OFF.
#include "cli/report/viewer_bundle.h"

namespace dendrofit {

std::string_view viewer_bundle() {
  return {};
}

}  // namespace dendrofit
