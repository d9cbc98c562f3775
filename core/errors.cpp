// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/errors.h"

#include <sstream>

namespace dendrofit {

void require(bool holds, const std::string& field, double value, const std::string& limit) {
  if (holds) return;
  std::ostringstream message;
  message << field << " = " << value << ": " << limit;
  throw InputError(message.str());
}

}  // namespace dendrofit
