// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/version.h"

namespace dendrofit::cli {

std::string_view version() {
  return DENDROFIT_VERSION;
}

}  // namespace dendrofit::cli
