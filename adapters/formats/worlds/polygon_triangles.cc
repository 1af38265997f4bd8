// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/polygon_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>

namespace prospect {
namespace {

using Eigen::Vector2d;
/// Numbers of corners.
using Numbers = std::vector<std::uint32_t>;

/// More than 0: c lies to the left of the way from a to b.
double side(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Vector2d u = b - a, v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

/// Whether the way from b to q leads into the corner a b c of something that lies to its left.
bool leads_into(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& q) {
  const bool left_of_first = side(a, b, q) > 0.0, left_of_second = side(b, c, q) > 0.0;
  return side(a, b, c) > 0.0 ? left_of_first && left_of_second : left_of_first || left_of_second;
}

/// Whether two ways cross, or one ends within the other.
bool crosses(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const double ac = side(a, b, c), ad = side(a, b, d), ca = side(c, d, a), cb = side(c, d, b);
  if (((ac > 0.0) != (ad > 0.0)) && ac != 0.0 && ad != 0.0 && ((ca > 0.0) != (cb > 0.0)) &&
      ca != 0.0 && cb != 0.0) {
    return true;
  }
  const auto within = [](const Vector2d& p, const Vector2d& q, const Vector2d& r) {
    return r != p && r != q && (r - p).dot(q - p) > 0.0 && (r - q).dot(p - q) > 0.0;
  };
  return (ac == 0.0 && within(a, b, c)) || (ad == 0.0 && within(a, b, d)) ||
         (ca == 0.0 && within(c, d, a)) || (cb == 0.0 && within(c, d, b));
}

/// The place in `outline` of the nearest corner that is seen from `from`, a corner of a hole;
/// nothing of the outline and of `others`, further holes, lies between. None: the outline's size.
std::size_t seen_corner(const Ring& p, const Numbers& outline, const Vector2d& from,
                        std::span<const Numbers> others) {
  std::size_t best = outline.size();
  double nearest = std::numeric_limits<double>::infinity();
  const auto in_the_way = [&](const Numbers& ring, const Vector2d& to) {
    for (std::size_t n = 0; n < ring.size(); ++n) {
      if (crosses(from, to, p[ring[n]], p[ring[(n + 1) % ring.size()]])) return true;
    }
    return false;
  };
  for (std::size_t n = 0; n < outline.size(); ++n) {
    const std::size_t size = outline.size();
    const Vector2d &before = p[outline[(n + size - 1) % size]], &at = p[outline[n]],
                   &after = p[outline[(n + 1) % size]];
    const double distance = (at - from).squaredNorm();
    if (distance >= nearest || !leads_into(before, at, after, from)) continue;
    const bool hidden = in_the_way(outline, at) ||
                        std::any_of(others.begin(), others.end(),
                                    [&](const Numbers& ring) { return in_the_way(ring, at); });
    if (hidden) continue;
    nearest = distance;
    best = n;
  }
  return best;
}

/// Whether nothing of the outline is in the ear at place n, which turns to the left.
bool is_free_ear(const Ring& p, const Numbers& left, std::size_t n) {
  const std::size_t size = left.size();
  const Vector2d &a = p[left[(n + size - 1) % size]], &b = p[left[n]], &c = p[left[(n + 1) % size]];
  for (std::size_t k = 0; k < size; ++k) {
    const Vector2d& q = p[left[k]];
    if (q == a || q == c || k == n) continue;
    if (q == b) {
      // Another visit to this corner, whose ways must not lead into the ear.
      if (leads_into(a, b, c, p[left[(k + size - 1) % size]]) ||
          leads_into(a, b, c, p[left[(k + 1) % size]])) {
        return false;
      }
    } else if (side(a, b, q) >= 0.0 && side(b, c, q) >= 0.0 && side(c, a, q) >= 0.0) {
      return false;
    }
  }
  return true;
}

/// Triangles of one outline that runs to the left.
void cut_ears(const Ring& p, Numbers left, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  while (left.size() >= 3) {
    bool cut = false;
    for (std::size_t n = 0; n < left.size() && !cut; ++n) {
      const std::uint32_t a = left[(n + left.size() - 1) % left.size()], b = left[n],
                          c = left[(n + 1) % left.size()];
      const double area = side(p[a], p[b], p[c]);
      if (area < 0.0 || (area > 0.0 && !is_free_ear(p, left, n))) continue;
      if (area > 0.0) triangles.push_back({a, b, c});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(n));
      cut = true;
    }
    if (!cut) break;
  }
}

}  // namespace

double doubled_area(const Ring& ring) {
  double area = 0.0;
  for (std::size_t n = 0; n < ring.size(); ++n) {
    const Vector2d &a = ring[n], &b = ring[(n + 1) % ring.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area;
}

bool is_within(const Vector2d& point, const Ring& ring) {
  bool within = false;
  for (std::size_t n = 0; n < ring.size(); ++n) {
    const Vector2d &a = ring[n], &b = ring[(n + 1) % ring.size()];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    within ^= point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y());
  }
  return within;
}

std::vector<std::array<std::uint32_t, 3>> polygon_triangles(const Ring& outer,
                                                            const std::vector<Ring>& holes) {
  Ring p = outer;
  Numbers outline(outer.size());
  std::iota(outline.begin(), outline.end(), 0U);
  if (doubled_area(outer) < 0.0) std::reverse(outline.begin(), outline.end());
  std::vector<Numbers> cuts;  // each begins with its rightmost corner and runs to the right
  for (const Ring& hole : holes) {
    Numbers numbers(hole.size());
    std::iota(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(p.size()));
    p.insert(p.end(), hole.begin(), hole.end());
    if (hole.size() < 3 || !is_within(hole.front(), outer)) continue;
    if (doubled_area(hole) > 0.0) std::reverse(numbers.begin(), numbers.end());
    const auto rightmost =
        std::max_element(numbers.begin(), numbers.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return p[a].x() < p[b].x(); });
    std::rotate(numbers.begin(), rightmost, numbers.end());
    cuts.push_back(std::move(numbers));
  }
  // What lies farther right is joined first, so that nothing that is yet to come is in the way.
  std::stable_sort(cuts.begin(), cuts.end(), [&](const Numbers& a, const Numbers& b) {
    return p[a.front()].x() > p[b.front()].x();
  });
  for (std::size_t n = 0; n < cuts.size(); ++n) {
    const std::size_t at = seen_corner(p, outline, p[cuts[n].front()], std::span(cuts).subspan(n));
    if (at == outline.size()) continue;
    cuts[n].push_back(cuts[n].front());
    cuts[n].push_back(outline[at]);
    outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(at) + 1, cuts[n].begin(),
                   cuts[n].end());
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  cut_ears(p, std::move(outline), triangles);
  return triangles;
}

}  // namespace prospect
