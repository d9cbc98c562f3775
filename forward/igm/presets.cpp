// SPDX-License-Identifier: GPL-3.0-or-later
// Table 2 of Yi et al. 2018, the rows grown with IGM. What was never printed (pipe exponent, tip radius,
// branching angle, marker counts) comes from the authors' program through the defaults.
//
// Light conversion: the program runs alpha = 10 and 8 where the table prints 4 and 3 for the same pair of
// trees, and this formulation reaches the printed heights only so. Every row therefore carries 2.5 times its
// printed alpha.
#include "core/errors.h"
#include "forward/igm/parameters.h"

#include <array>
#include <string>

namespace dendrofit {
namespace {

constexpr double kAlphaScale = 2.5;

struct PrintedRow {
  std::string_view name, summary;
  int roots;
  double lambda, k, tau, rho, x0, xm, r, alpha, sigma, mu, gamma, b_min, b_max, shed, height, dbh;
  int last_cycle;
};

constexpr std::array<PrintedRow, 11> kTable2{{
    {"table2-01", "Table 2 row 1 (Fig. 11, beside a wall)",
     1,           .52,
     .5,          6,
     .1,          2,
     100,         .34,
     4,           .5,
     1.5,         .5,
     1.8,         2.2,
     .25,         6.09,
     .22,         20},
    {"table2-02", "Table 2 row 2 (Fig. 12, under a board)",
     1,           .54,
     .35,         6,
     .1,          2,
     100,         .34,
     4,           .5,
     1.5,         .5,
     1.8,         2.2,
     .35,         7.45,
     .26,         20},
    {"table2-03", "Table 2 row 3 (Fig. 13b, the centre of five trees)",
     1,           .52,
     .5,          5,
     .1,          2,
     100,         .34,
     4,           .5,
     1.5,         .5,
     1.8,         2.3,
     .35,         8.57,
     .23,         20},
    {"table2-04", "Table 2 row 4 (Fig. 13c, an outer one of five trees)",
     1,           .52,
     .5,          5,
     .1,          2,
     100,         .34,
     4,           .5,
     1.5,         .5,
     1.8,         2.3,
     .35,         7.95,
     .27,         20},
    {"table2-05", "Table 2 row 5 (the smaller of two competing trees)",
     1,           .48,
     .5,          4,
     .1,          2,
     70,          .34,
     3,           .5,
     1.5,         .5,
     1.8,         2.5,
     .20,         5.23,
     .17,         14},
    {"table2-06", "Table 2 row 6 (the larger of two competing trees)",
     1,           .52,
     .5,          4,
     .1,          2,
     100,         .34,
     4,           .5,
     1.0,         .2,
     1.8,         2.2,
     .35,         8.07,
     .22,         20},
    {"table2-09", "Table 2 row 9 (shrub, 10 roots); alpha, sigma and last cycle are doubtful readings",
     10,          .46,
     .5,          0,
     .02,         2,
     50,          .34,
     6,           1.0,
     .6,          1.0,
     2.0,         2.5,
     .15,         .68,
     0,           10},
    {"table2-11", "Table 2 row 11 (Fig. 17b, interior density)",
     1,           .52,
     .5,          6,
     .1,          2,
     100,         .34,
     4,           .5,
     1.0,         .5,
     1.8,         2.2,
     .35,         7.22,
     .28,         20},
    {"table2-12", "Table 2 row 12 (Fig. 18, broad-leaved); our trees come out taller than printed",
     1,           .48,
     .5,          2,
     .1,          2,
     100,         .34,
     6,           .5,
     1.0,         .5,
     1.8,         2.5,
     .25,         5.21,
     .13,         20},
    {"table2-13", "Table 2 row 13 (Fig. 18, evergreen shrub, 6 roots)",
     6,           .46,
     .5,          0,
     .01,         2,
     50,          .34,
     6,           1.0,
     1.0,         .2,
     2.0,         2.5,
     .05,         .29,
     0,           12},
    {"table2-14",
     "Table 2 row 14 (Fig. 18, cypress); the printed rho of 0.2 m doubles the printed height, so one of them "
     "is a "
     "misprint (rho_m=0.1 gives about 8 m)",
     1,
     .56,
     .5,
     14,
     .2,
     2,
     100,
     .34,
     3,
     .5,
     .5,
     1.5,
     1.8,
     2.2,
     .45,
     8.06,
     .35,
     20},
}};

std::vector<IgmPreset> make_presets() {
  std::vector<IgmPreset> presets;
  IgmPreset standard{
      "standard",
      "the authors' program: row 6 of Table 2 with x0 = 3 and alpha = 10, shading that lightens from "
      "cycle 14, branches that rise before cycle 16 and droop from it on",
      1,
      {},
      0,
      0,
      0};
  standard.parameters.equation_values = {3, 100, 0.34};
  standard.parameters.tau = 14;
  standard.parameters.gamma = -0.5;
  standard.parameters.gamma_late = 8;
  // "To cycle 16" can be read either way; from 16 on cycle 20 has 12,500 +- 1,900 living internodes (8
  // seeds), from 17 on 15,100 +- 2,200. The authors' trees have about 10,000.
  standard.parameters.late_cycle = 16;
  presets.push_back(standard);
  for (const PrintedRow& row : kTable2) {
    IgmPreset preset{row.name, row.summary, row.roots, {}, row.height, row.dbh, row.last_cycle};
    IgmParameters& p = preset.parameters;
    p.equation_values = {row.x0, row.xm, row.r};
    p.lambda = row.lambda;
    p.k = row.k;
    p.tau = row.tau;
    p.rho_m = row.rho;
    p.alpha = kAlphaScale * row.alpha;
    p.sigma = row.sigma;
    p.mu = row.mu;
    p.gamma = row.gamma;
    p.b_min = row.b_min;
    p.b_max = row.b_max;
    p.shed_ratio = row.shed;
    // The tip radius of the program belongs to internodes of 0.1 m.
    if (row.rho < 0.1) p.tip_radius_m *= row.rho / 0.1;
    presets.push_back(preset);
  }
  return presets;
}

}  // namespace

std::span<const IgmPreset> igm_presets() {
  static const std::vector<IgmPreset> presets = make_presets();
  return presets;
}

const IgmPreset& igm_preset(std::string_view name) {
  std::vector<std::string> known;
  for (const IgmPreset& preset : igm_presets()) {
    if (preset.name == name) return preset;
    known.emplace_back(preset.name);
  }
  throw InputError("unknown preset '" + std::string(name) + "'; did you mean '" + nearest_word(name, known) +
                   "'?");
}

}  // namespace dendrofit
