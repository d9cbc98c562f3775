// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image_segmentation.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

Silhouette from_mask(const Photograph& photo) {
  Silhouette s;
  s.width = photo.width;
  s.height = photo.height;
  s.from_mask = true;
  s.tree.resize(photo.mask.size());
  s.cover.resize(photo.mask.size());
  for (std::size_t i = 0; i < photo.mask.size(); ++i) {
    s.tree[i] = photo.mask[i] ? 1 : 0;
    s.cover[i] = s.tree[i];
  }
  return s;
}

}  // namespace

void SegmentationOptions::validate() const {
  require(seed_ratio > 0 && seed_ratio < 1, "seed_ratio", seed_ratio, "must be between 0 and 1");
  require(grow_ratio >= seed_ratio && grow_ratio < 1, "grow_ratio", grow_ratio,
          "must be between seed_ratio and 1");
}

Silhouette find_silhouette(const Photograph& photo, const SegmentationOptions& options) {
  options.validate();
  photo.validate();
  if (photo.mask.empty()) throw SolverError(photo.name + ": without a mask no tree is found yet");
  return from_mask(photo);
}

}  // namespace dendrofit
