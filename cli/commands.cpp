// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/commands.h"

#include <array>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

constexpr auto kCommands = std::to_array<CommandRow>({
    {"run", "the main job: scan -> tree model -> fitted growth -> regrown tree -> leaves -> report",
     "dendrofit run tree.las -o result", &make_run},
    {"reconstruct", "scan -> skeleton, cylinder model (QSM) and metrics",
     "dendrofit reconstruct tree.las -o result", &make_reconstruct},
    {"growth", "fit growth equations to measurements over time", "dendrofit growth heights.csv -o curves",
     &make_growth},
    {"fit", "find the growth parameters under which trees like the scanned one grow",
     "dendrofit fit qsm.csv -o result --age 20", &make_fit},
    {"grow", "grow a tree, cycle by cycle", "dendrofit grow standard -o tree --cycles 15", &make_grow},
    {"leaves", "leaves that intersect nothing, on any QSM", "dendrofit leaves qsm.csv -o result --area 40",
     &make_leaves},
    {"scan", "virtual laser scan of a tree, truth beside it",
     "dendrofit scan qsm.csv -o cloud.las --stations 4", &make_scan},
    {"info", "what a file holds", "dendrofit info tree.las", &make_info},
    {"convert", "between point cloud, QSM and mesh formats", "dendrofit convert tree.las tree.ply",
     &make_convert},
    {"view", "a picture or page of results, a point cloud or a QSM, without a display",
     "dendrofit view result --png tree.png --azimuth 30 --elevation 15", &make_view},
});

std::string with_interval(const TreeMetrics& metrics, const std::string& key, double factor,
                          const char* unit) {
  const auto found = metrics.intervals.find(key);
  if (found == metrics.intervals.end()) return "";
  return fmt::format("  (95 %: {:.4g} to {:.4g} {})", factor * found->second.lo, factor * found->second.hi,
                     unit);
}

}  // namespace

std::span<const CommandRow> commands() {
  return kCommands;
}

void say_metrics(const Session& session, const Tree& tree, const TreeMetrics& m) {
  session.say(fmt::format("  cylinders   {}", tree.size()));
  session.say(fmt::format("  height      {:.2f} m{}", m.height_m, with_interval(m, "height_m", 1, "m")));
  if (m.dbh_m)
    session.say(fmt::format("  DBH         {:.1f} cm at {} m{}", 100 * *m.dbh_m, m.dbh_height_m,
                            with_interval(m, "dbh_m", 100, "cm")));
  else
    session.say(fmt::format("  DBH         none: the tree does not reach {} m", m.dbh_height_m));
  session.say(fmt::format("  stem        {:.4g} m3{}", m.stem_volume_m3,
                          with_interval(m, "stem_volume_m3", 1, "m3")));
  session.say(fmt::format("  branches    {:.4g} m3", m.branch_volume_m3));
  session.say(fmt::format("  wood        {:.4g} m3{}", m.total_volume_m3,
                          with_interval(m, "total_volume_m3", 1, "m3")));
  if (m.crown_base_m)
    session.say(fmt::format("  crown       from {:.2f} m, {:.2f} m wide, {:.1f} m2, {:.1f} m3",
                            *m.crown_base_m, m.crown_diameter_m, m.crown_area_m2, m.crown_volume_m3));
  std::string counts;
  for (std::size_t order = 0; order < m.branch_count_by_order.size(); ++order)
    counts += fmt::format("{}{} of order {}", order ? ", " : "", m.branch_count_by_order[order], order);
  session.say("  axes        " + counts);
}

}  // namespace dendrofit::cli
