// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/bough_gaps.h"

#include "recon/image/distance.h"

#include <algorithm>

namespace dendrofit {
namespace {

constexpr std::size_t kFewestPixels = 30;
constexpr float kDrawnOut = 4;  // length over thickness

class Bridges {
 public:
  Bridges(const std::vector<std::uint8_t>& strong, const std::vector<std::uint8_t>& faint, int width,
          int height, int gap_px, std::vector<std::uint8_t>& tree)
      : faint_(faint), width_(width), height_(height), gap_px_(gap_px), tree_(tree), own_(tree.size()) {
    for (std::size_t p = 0; p < own_.size(); ++p) own_[p] = strong[p] && !tree[p];
    thick_ = distance_inside(own_, width, height);
    from_.assign(own_.size(), kUnseen);
  }

  std::size_t add() {
    std::vector<std::vector<std::size_t>> pieces = drawn_out();
    std::size_t added = 0;
    // What a piece brings nearer, the next round reaches.
    for (bool more = true; more;) {
      more = false;
      for (auto& piece : pieces) {
        if (piece.empty()) continue;
        const std::size_t now = join(piece);
        if (now == 0) continue;
        added += now;
        piece.clear();
        more = true;
      }
    }
    return added;
  }

 private:
  static constexpr std::size_t kUnseen = static_cast<std::size_t>(-1);

  template <class Visit>
  void around(std::size_t p, const Visit& visit) const {
    const auto w = static_cast<std::size_t>(width_);
    const int x = static_cast<int>(p % w), y = static_cast<int>(p / w);
    for (int ny = std::max(0, y - 1); ny <= std::min(height_ - 1, y + 1); ++ny)
      for (int nx = std::max(0, x - 1); nx <= std::min(width_ - 1, x + 1); ++nx)
        visit(static_cast<std::size_t>(ny) * w + static_cast<std::size_t>(nx));
  }

  std::vector<std::vector<std::size_t>> drawn_out() const {
    std::vector<std::vector<std::size_t>> pieces;
    std::vector<std::uint8_t> seen(own_.size(), 0);
    std::vector<std::size_t> piece;
    for (std::size_t start = 0; start < own_.size(); ++start) {
      if (!own_[start] || seen[start]) continue;
      piece.assign(1, start);
      seen[start] = 1;
      float thickest = 0;
      for (std::size_t k = 0; k < piece.size(); ++k) {
        thickest = std::max(thickest, thick_[piece[k]]);
        around(piece[k], [&](std::size_t q) {
          if (!own_[q] || seen[q]) return;
          seen[q] = 1;
          piece.push_back(q);
        });
      }
      const float across = std::max(1.0F, 2 * thickest - 1);
      if (piece.size() >= kFewestPixels && static_cast<float>(piece.size()) >= kDrawnOut * across * across)
        pieces.push_back(piece);
    }
    return pieces;
  }

  /// Walks from the piece over faint pixels to the tree; adds both where it gets there.
  std::size_t join(const std::vector<std::size_t>& piece) {
    std::vector<std::size_t> front = piece, reached = piece, next;
    for (const std::size_t p : piece) from_[p] = p;
    std::size_t end = kUnseen;
    for (int step = 0; step <= gap_px_ && end == kUnseen && !front.empty(); ++step) {
      next.clear();
      for (const std::size_t p : front)
        around(p, [&](std::size_t q) {
          if (from_[q] != kUnseen || (!tree_[q] && !faint_[q])) return;
          from_[q] = p;
          reached.push_back(q);
          if (tree_[q] && end == kUnseen) end = q;
          next.push_back(q);
        });
      std::swap(front, next);
    }
    std::size_t added = 0;
    const auto mark = [&](std::size_t p) {
      added += !tree_[p];
      tree_[p] = 1;
    };
    if (end != kUnseen) {
      for (std::size_t p = from_[end]; from_[p] != p; p = from_[p])
        around(p, [&](std::size_t q) {
          if (faint_[q]) mark(q);
        });
      for (const std::size_t p : piece) mark(p);
    }
    for (const std::size_t p : reached) from_[p] = kUnseen;
    return added;
  }

  const std::vector<std::uint8_t>& faint_;
  int width_, height_, gap_px_;
  std::vector<std::uint8_t>& tree_;
  std::vector<std::uint8_t> own_;
  std::vector<float> thick_;
  std::vector<std::size_t> from_;
};

}  // namespace

std::size_t bridge_gaps(const std::vector<std::uint8_t>& strong, const std::vector<std::uint8_t>& faint,
                        int width, int height, int gap_px, std::vector<std::uint8_t>& tree) {
  return Bridges(strong, faint, width, height, gap_px, tree).add();
}

}  // namespace dendrofit
