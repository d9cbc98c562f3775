// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/progress.h"

#include "core/errors.h"

namespace dendrofit {

void Progress::check() const {
  if (cancelled()) throw Cancelled{};
}

Progress& no_progress() {
  static Progress silent;
  return silent;
}

}  // namespace dendrofit
