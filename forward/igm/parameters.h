// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of the integrated growth model (IGM; Yi et al. 2018, "Tree growth modelling constrained by
// growth equations", Computer Graphics Forum 37): one table that feeds files, help, search scaling and
// bounds.
#pragma once

#include "core/parameters.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// One tree type. The growth equation counts internodes over cycles: a final size of 100 means 100 rho_m.
/// Symbols as in the paper; where the paper is silent the authors' published program decides (see the table's
/// `source` column).
struct IgmParameters {
  std::string equation = "logistic";                  ///< name of a row of growth_equations()
  std::vector<double> equation_values{2, 100, 0.34};  ///< its parameters, in that row's order
  double rho_m = 0.1;                                 ///< internode length, metres
  double lambda = 0.52;                               ///< Borchert-Honda share of the axis, (0, 1)
  double k = 0.5;                                     ///< fraction of an axis's nodes that receive resource
  double tau = 4;                                     ///< cycles of apical control on the trunk
  double alpha = 10;                                  ///< resource per unit of light
  double sigma = 0.5;                                 ///< ageing of light sensitivity
  double mu = 1.0;                                    ///< weight of the optimal (light) direction
  double gamma = 0.2;                                 ///< weight of the tropism of branches
  double gamma_late = 0.2;                            ///< the same from late_cycle on (Fig. 4)
  int late_cycle = 1000;                              ///< 1000: never
  double b_min = 1.8;                                 ///< shading base until cycle tau (darker)
  double b_max = 2.2;                                 ///< shading base from cycle schedule_cycles (lighter)
  double shed_ratio = 0.35;                           ///< least mean light of a branch that stays
  double branch_angle_deg = 38;                       ///< of branches on the trunk
  double pipe_exponent = 2.6;                         ///< of the pipe model
  double tip_radius_m = 0.003;                        ///< of the youngest internodes, metres
  int cycles = 20;                                    ///< cycles to grow, at most
  int schedule_cycles = 20;         ///< cycle at which b reaches b_max; drooping counts from it
  bool resource_allocation = true;  ///< false: the equation alone says how far a bud grows
  bool restore_light = false;       ///< shed branches give their light back
  bool stretch_internodes = false;  ///< internode rho v / floor(v) in place of rho, v a shoot's share
  bool stretch_by_node = false;     ///< v there of all shoots of the node
  bool paper = false;               ///< the authors' double count of sibling branches in the radii
  int max_markers = 20000;          ///< marker points of one tree in one cycle
  int max_order = 12;               ///< branches of this order (trunk 1) bear no branches

  /// The largest growth of one shoot in cycle T, in internodes: dX/dt of the equation, and 4 before cycle 5.
  double cap(int cycle) const;
  /// The shading base b of internodes born in cycle T (Yi 2018, Fig. 10b).
  double shading_base(int cycle) const;

  /// Value by key, booleans as 0 and 1, the equation's own parameters among them. InputError for an unknown
  /// key.
  double get(std::string_view key) const;
  /// Sets a number by key. Throws InputError, led by `where`, for an unknown key (naming the nearest) or a
  /// value outside its bounds.
  void set(std::string_view key, double value, std::string_view where = "");
  /// Whether the key is a switch, true or false.
  static bool is_switch(std::string_view key);
  /// Takes another equation with that equation's default values. InputError for an unknown name.
  void set_equation(std::string_view name, std::string_view where = "");

  /// Throws InputError naming field, value and limit.
  void validate() const;
};

/// The table for one equation: the equation's own rows first, then the model's, in the order of the struct.
std::vector<ParameterSpec> igm_parameter_table(std::string_view equation = "logistic");

/// A named parameter set.
struct IgmPreset {
  std::string_view name;
  std::string_view summary;  ///< what it is, with every doubtful cell
  int roots = 1;             ///< stems it is meant to start with (shrubs: several)
  IgmParameters parameters;
  double printed_height_m = 0;  ///< as Table 2 prints it, 0 where it does not
  double printed_dbh_m = 0;
  int printed_last_cycle = 0;
};

/// `standard` and the IGM rows of Table 2, `table2-01` to `table2-14`.
std::span<const IgmPreset> igm_presets();
/// InputError naming the nearest known name.
const IgmPreset& igm_preset(std::string_view name);

}  // namespace dendrofit
