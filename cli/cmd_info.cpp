// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit info FILE
#include "cli/commands.h"
#include "core/metrics.h"
#include "io/file_info.h"
#include "io/json_text.h"
#include "io/metrics_json.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

using Json = nlohmann::ordered_json;

std::size_t roots_of(const Tree& tree) {
  return static_cast<std::size_t>(std::count(tree.parent.begin(), tree.parent.end(), -1));
}

Json to_json(const std::filesystem::path& file, const FileInfo& info) {
  Json json = {{"file", file.string()}, {"kind", info.kind}, {"format", info.format}, {"bytes", info.bytes}};
  if (info.cloud) json["points"] = info.cloud->size();
  if (info.tree) {
    json["cylinders"] = info.tree->size();
    json["roots"] = roots_of(*info.tree);
  }
  if (!info.bounds.empty()) {
    const auto triple = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
    json["bounds"] = {{"min", triple(info.bounds.lo)}, {"max", triple(info.bounds.hi)}};
  }
  if (info.kind == "table") {
    json["series"] = info.series;
    json["rows"] = info.rows;
  }
  if (info.kind == "mesh") json["triangles"] = info.rows;
  if (info.cloud && !info.cloud->scanner_positions.empty()) {
    json["scanner_positions"] = Json::array();
    for (const Vec3& p : info.cloud->scanner_positions) {
      const Vec3 world = p + info.cloud->origin_shift;
      json["scanner_positions"].push_back({world.x(), world.y(), world.z()});
    }
  }
  for (const auto& [key, value] : info.details)
    if (!json.contains(key)) json[key] = value;
  if (!info.crs_wkt.empty()) json["crs"] = info.crs_wkt;
  if (info.tree) json["metrics"] = Json::parse(metrics_to_json(measure(*info.tree)));
  return json;
}

class Info : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("FILE", file_, "Point cloud, QSM, mesh or measurement table");
  }

  int run(Session& session) override {
    const FileInfo info = describe_file(file_, session.progress());
    session.json(json_text(to_json(file_, info)));
    session.say(fmt::format("{}: {} ({}), {} bytes", file_.string(), info.kind, info.format, info.bytes));
    if (info.cloud) session.say(fmt::format("  points      {}", info.cloud->size()));
    if (info.kind == "mesh") session.say(fmt::format("  triangles   {}", info.rows));
    if (info.kind == "table")
      session.say(fmt::format("  series      {}\n  rows        {}", info.series, info.rows));
    for (const auto& [key, value] : info.details) session.say(fmt::format("  {:<11} {}", key, value));
    if (!info.bounds.empty()) {
      const Vec3 size = info.bounds.size();
      session.say(fmt::format("  from        {:.3f} {:.3f} {:.3f} m", info.bounds.lo.x(), info.bounds.lo.y(),
                              info.bounds.lo.z()));
      session.say(fmt::format("  to          {:.3f} {:.3f} {:.3f} m", info.bounds.hi.x(), info.bounds.hi.y(),
                              info.bounds.hi.z()));
      session.say(fmt::format("  size        {:.3f} x {:.3f} x {:.3f} m", size.x(), size.y(), size.z()));
    }
    if (!info.crs_wkt.empty()) session.say("  CRS         " + info.crs_wkt);
    if (info.cloud && !info.cloud->scanner_positions.empty())
      session.say(fmt::format("  scanners    {} positions (--json lists them)",
                              info.cloud->scanner_positions.size()));
    if (info.tree && roots_of(*info.tree) > 1)
      session.say(
          fmt::format("  roots       {} (what follows is of all stems together)", roots_of(*info.tree)));
    if (info.tree) say_metrics(session, *info.tree, measure(*info.tree));
    return 0;
  }

 private:
  std::filesystem::path file_;
};

}  // namespace

std::unique_ptr<Command> make_info() {
  return std::make_unique<Info>();
}

}  // namespace dendrofit::cli
