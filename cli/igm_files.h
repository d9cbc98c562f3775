// SPDX-License-Identifier: GPL-3.0-or-later
// Growth-model files: parameters, sites, and the series a simulation writes.
#pragma once

#include "forward/igm/grow.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// A preset's name or a parameter file (TOML; the keys of igm_parameter_table, "equation", and "preset" to
/// start from one). A word that is neither throws InputError with the nearest preset; unknown keys and values
/// out of bounds throw InputError with file and line.
IgmParameters load_igm_parameters(const std::string& preset_or_file);

/// Applies "key=value" words of --set.
void apply_settings(IgmParameters& parameters, const std::vector<std::string>& settings);

/// params.toml: every parameter with unit and meaning; load_igm_parameters reads it back exactly. `remarks`
/// lead it.
std::string igm_parameters_toml(const IgmParameters& parameters, const std::vector<std::string>& remarks);

/// site.toml: [[tree]] root = [x, y, z] (several stems: 3 numbers each, one list) and parameters = preset,
/// file or table; [[box]] min, max; [[halfspace]] point, normal; [[mesh]] file (relative to the site file).
/// Trees without parameters of their own grow under `parameters`. Throws InputError with file and line.
IgmSite load_site(const std::filesystem::path& file, const IgmParameters& parameters);

/// growth.csv:
/// cycle,height_m,dbh_m,stem_internodes,internodes,axes,living_buds,shed_internodes,light_mean,length_m,
/// volume_m3[,tree]; the last column only for several trees.
std::string growth_series_csv(const std::vector<GrowthRecord>& series);

}  // namespace dendrofit::cli
