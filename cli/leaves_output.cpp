// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/leaves_output.h"

#include <nlohmann/json.hpp>

namespace dendrofit::cli {

std::string leaves_json(const LeafResult& result) {
  const LeafReport& r = result.report;
  const nlohmann::ordered_json json = {{"achieved_count", r.achieved_count}, {"achieved_area_m2", r.achieved_area_m2}};
  return json.dump(2) + "\n";
}

}  // namespace dendrofit::cli
