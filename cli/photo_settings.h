// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs on the command line: what `reconstruct`, `fit` and `run` have in common for them.
#pragma once

#include "cli/command.h"
#include "io/read_cameras.h"
#include "recon/reconstruct_photo.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// One photograph ready for reconstruct_photo.
struct PhotoInput {
  Photograph photo;
  ReconstructPhotoOptions options;
  Vec3 origin_shift = Vec3::Zero();  ///< world = origin_shift + the camera's local coordinates
  std::vector<std::string> warnings;
};

struct PhotoSettings {
  std::optional<double> height_m;
  std::string scale_bar, root;
  std::filesystem::path mask, cameras, colmap;
  double eye_height_m = 1.6;

  void declare(OptionTable& table);
  /// True where --cameras or --colmap is given, or `input` is a picture by content or name.
  bool asked_for(const std::filesystem::path& input) const;
  /// The files read: for run.toml.
  std::vector<std::filesystem::path> inputs(const std::filesystem::path& input) const;
  /// Throws UsageError where options exclude each other.
  void check(const std::filesystem::path& input) const;
  /// Whether there are cameras of their own: --cameras or --colmap.
  bool has_cameras() const { return !cameras.empty() || !colmap.empty(); }
  ViewSet read_views() const;
  /// Several views ready for reconstruct_views: with a unit of length where they have none. Throws UsageError
  /// for a scale that contradicts cameras with a unit, and for what only one photograph can be asked.
  ViewSet scaled(ViewSet set, Progress& progress) const;
  PhotoInput read_photo(const std::filesystem::path& input, const CommonOptions& common,
                        double dbh_height_m) const;
  /// The one view of a set.
  PhotoInput from_view(ViewSet set, const CommonOptions& common, double dbh_height_m) const;

 private:
  ReconstructPhotoOptions resolve(const CommonOptions& common, double dbh_height_m,
                                  const Photograph& photo) const;
};

/// Reads, reconstructs, and places the tree in the world.
PhotoReconstruction reconstruct_from(const PhotoInput& input, Progress& progress);

/// qsm.csv, skeleton.csv, metrics.json, reconstruction.json, overlay.png and tree meshes; of a leafy crown
/// only the outline's metrics and the overlay.
void write_photo_reconstruction(const std::filesystem::path& folder, const PhotoInput& input,
                                const PhotoReconstruction& result,
                                const std::vector<std::string>& mesh_formats);
std::string photo_reconstruction_json(const PhotoReconstruction& result);
/// metrics.json; what a photograph does not tell is null.
std::string photo_metrics_json(const PhotoReconstruction& result);
/// The bytes of overlay.png.
std::string photo_overlay(const PhotoInput& input, const PhotoReconstruction& result);
void say_photo_reconstruction(const Session& session, const PhotoReconstruction& result);

}  // namespace dendrofit::cli
