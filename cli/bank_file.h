// SPDX-License-Identifier: GPL-3.0-or-later
// The bank of prior simulations that is installed with the program.
#pragma once

#include "fit/prior_bank.h"

#include <filesystem>
#include <memory>

namespace dendrofit::cli {

/// share/dendrofit/igm.bank beside the program (in a build folder) or beside its bin folder (installed);
/// empty where there is none.
std::filesystem::path installed_bank_path();

/// The bank there, or nullptr. Throws IoError for a damaged one.
std::shared_ptr<const PriorBank> installed_bank();

}  // namespace dendrofit::cli
