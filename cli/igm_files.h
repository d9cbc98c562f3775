// SPDX-License-Identifier: GPL-3.0-or-later
// Growth-model files: parameters, and the series a simulation writes. (Sites: cli/site_file.h.)
#pragma once

#include "forward/igm/grow.h"
#include "io/toml.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// What a preset or a parameter file describes.
struct IgmSetup {
  IgmParameters parameters;
  int roots = 1;               ///< stems of one plant: a shrub has several
  std::filesystem::path site;  ///< site file, empty where there is none
};

/// A preset's name or a parameter file (TOML; the keys of igm_parameter_table, "equation", "preset" to start
/// from one, "roots", and "site", a file relative to it). A word that is neither throws InputError with the
/// nearest preset; unknown keys, tables and values out of bounds throw InputError with file and line.
IgmSetup load_igm_setup(const std::string& preset_or_file);

/// Applies "key=value" words of --set.
void apply_settings(IgmSetup& setup, const std::vector<std::string>& settings);

/// params.toml: every parameter with unit and meaning, and what else differs from one tree alone; read back
/// by load_igm_setup exactly. `remarks` lead it.
std::string igm_setup_toml(const IgmSetup& setup, const std::vector<std::string>& remarks);
std::string igm_parameters_toml(const IgmParameters& parameters, const std::vector<std::string>& remarks);

/// Adds the rows of params.toml for the parameters alone.
void write_parameters(const IgmParameters& parameters, TomlWriter& toml);

/// `parameters` changed by what entries say. Throws InputError with file and line.
IgmParameters igm_parameters_from(const std::vector<TomlEntry>& entries, const std::filesystem::path& file,
                                  IgmParameters parameters);

/// "file, line N" of an entry.
std::string toml_place(const std::filesystem::path& file, const TomlEntry& entry);

/// growth.csv:
/// cycle,height_m,dbh_m,stem_internodes,internodes,axes,living_buds,shed_internodes,light_mean,length_m,
/// volume_m3[,tree]; the last column only for several trees.
std::string growth_series_csv(const std::vector<GrowthRecord>& series);

}  // namespace dendrofit::cli
