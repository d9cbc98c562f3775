// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/distance.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace dendrofit {
namespace {

std::vector<float> distance_to_zero(const cv::Mat& nonzero) {
  const auto pixels = static_cast<std::size_t>(nonzero.rows) * static_cast<std::size_t>(nonzero.cols);
  std::vector<float> distance(pixels);
  cv::Mat out(nonzero.rows, nonzero.cols, CV_32F, distance.data());
  if (cv::countNonZero(nonzero) == nonzero.rows * nonzero.cols) {
    out.setTo(static_cast<float>(nonzero.rows + nonzero.cols));
    return distance;
  }
  cv::distanceTransform(nonzero, out, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  return distance;
}

}  // namespace

std::vector<float> distance_inside(const std::vector<std::uint8_t>& marked, int width, int height) {
  const cv::Mat view(height, width, CV_8U, const_cast<std::uint8_t*>(marked.data()));
  return distance_to_zero(view);
}

std::vector<float> distance_outside(const std::vector<std::uint8_t>& marked, int width, int height) {
  const cv::Mat view(height, width, CV_8U, const_cast<std::uint8_t*>(marked.data()));
  return distance_to_zero(view == 0);
}

}  // namespace dendrofit
