// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/observed_tree.h"

#include "cli/views_output.h"
#include "core/errors.h"

namespace dendrofit::cli {
namespace {

ObservedTree from_scan(Session& session, const std::filesystem::path& input,
                       const ReconstructSettings& settings, const std::filesystem::path& folder,
                       const std::vector<std::string>& mesh_formats) {
  ObservedTree observed;
  observed.scan = settings.read_scan(session, input, session.progress());
  observed.model = reconstruct(observed.scan, settings.resolve(session.common()), session.progress());
  write_reconstruction(folder, observed.model, mesh_formats, observed.scan.crs_wkt);
  say_reconstruction(session, observed.model);
  return observed;
}

ObservedTree from_views(Session& session, ViewSet read, const ReconstructSettings& settings,
                        const PhotoSettings& photo, const std::filesystem::path& folder,
                        const std::vector<std::string>& mesh_formats) {
  const ViewSet set = photo.scaled(std::move(read), session.progress());
  const ViewsReconstruction result =
      reconstruct_views(set, {.cloud = settings.resolve(session.common())}, session.progress());
  write_views_reconstruction(folder, set, result, mesh_formats);
  say_views_reconstruction(session, result);
  ObservedTree observed;
  observed.model = result.model;
  return observed;
}

ObservedTree from_photo(Session& session, const PhotoInput& input, const std::filesystem::path& folder,
                        const std::vector<std::string>& mesh_formats) {
  const PhotoReconstruction photo = reconstruct_from(input, session.progress());
  write_photo_reconstruction(folder, input, photo, mesh_formats);
  say_photo_reconstruction(session, photo);
  if (!photo.has_tree)
    throw SolverError("the crown is in leaf: its outline shows no branches to fit a growth model to");
  if (!photo.metric)
    throw SolverError("a growth model is fitted in metres: give the tree's --height, or --scale-bar");
  ObservedTree observed;
  observed.one_view = true;
  observed.model.tree = photo.tree;
  observed.model.metrics = photo.metrics;
  observed.model.warnings = photo.warnings;
  observed.model.foot = photo.tree.origin_shift;
  observed.overlay_png = photo_overlay(input, photo);
  return observed;
}

}  // namespace

ObservedTree observe_tree(Session& session, const std::filesystem::path& input,
                          const ReconstructSettings& scan, const PhotoSettings& photo,
                          const std::filesystem::path& folder, const std::vector<std::string>& mesh_formats) {
  const double dbh_height_m = scan.options.dbh_height_m;
  ObservedTree observed;
  if (!photo.asked_for(input)) {
    observed = from_scan(session, input, scan, folder, mesh_formats);
  } else if (!photo.has_cameras()) {
    observed =
        from_photo(session, photo.read_photo(input, session.common(), dbh_height_m), folder, mesh_formats);
  } else {
    ViewSet set = photo.read_views();
    observed = set.views.size() > 1
                   ? from_views(session, std::move(set), scan, photo, folder, mesh_formats)
                   : from_photo(session, photo.from_view(std::move(set), session.common(), dbh_height_m),
                                folder, mesh_formats);
  }
  observed.inputs = photo.inputs(input);
  return observed;
}

}  // namespace dendrofit::cli
