#include <algorithm>
#include <cmath>

#include "contact/bake/worker/point_grid.hpp"
#include "contact/bake/worker/shell_bake.hpp"
#include "fault/fault.hpp"

namespace tact::contact {

void build_hierarchy(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals,
                     const std::vector<double>& areas, int levels, Pointshell& shell) {
  TACT_CHECK(levels >= 1 && !positions.empty());
  const std::size_t n = positions.size();
  // The first counts[l] points are those of levels 0 .. l; counts grow by a constant factor.
  std::vector<std::size_t> counts;
  for (int l = 1; l <= levels; ++l) {
    const double c = std::pow(static_cast<double>(n), static_cast<double>(l) / levels);
    const std::size_t least = counts.empty() ? 1 : counts.back();  // a level may be empty when points are few
    counts.push_back(l == levels ? n : std::clamp(static_cast<std::size_t>(std::lround(c)), least, n));
  }

  std::vector<std::uint32_t> order;         // breadth-first: index into positions
  std::vector<std::uint32_t> parent(n, 0);  // breadth-first index of the parent, by breadth-first index
  order.reserve(n);
  shell.level_begin.assign(1, 0);
  shell.child_begin.assign(n, 0);
  shell.child_end.assign(n, 0);
  std::size_t from = 0;
  for (const std::size_t to : counts) {
    const std::size_t above_begin = shell.level_begin.size() > 1 ? shell.level_begin[shell.level_begin.size() - 2] : 0;
    const std::size_t above_end = order.size();
    if (above_end == 0) {
      for (std::size_t i = from; i < to; ++i) order.push_back(static_cast<std::uint32_t>(i));
    } else if (to > from) {
      std::vector<Vec3> above;
      for (std::size_t k = above_begin; k < above_end; ++k) above.push_back(positions[order[k]]);
      TACT_CHECK(!above.empty());
      const PointGrid grid(above, (positions[order[0]].norm() + 1e-9) / std::sqrt(static_cast<double>(above.size())));
      std::vector<std::pair<std::uint32_t, std::uint32_t>> children;  // parent, point
      for (std::size_t i = from; i < to; ++i) {
        children.emplace_back(static_cast<std::uint32_t>(above_begin) + grid.nearest(positions[i]),
                              static_cast<std::uint32_t>(i));
      }
      std::sort(children.begin(), children.end());
      for (const auto& [p, i] : children) {
        parent[order.size()] = p;
        order.push_back(i);
      }
    }
    const auto begin = static_cast<std::uint32_t>(above_end), end = static_cast<std::uint32_t>(order.size());
    // Children of the level above tile this one.
    if (above_end > 0) {
      std::uint32_t next = begin;
      for (std::size_t k = above_begin; k < above_end; ++k) {
        shell.child_begin[k] = next;
        while (next < end && parent[next] == k) ++next;
        shell.child_end[k] = next;
      }
    }
    if (to > from || order.empty()) shell.level_begin.push_back(end);
    from = to;
  }
  for (std::size_t k = shell.level_begin[shell.level_begin.size() - 2]; k < n; ++k) {
    shell.child_begin[k] = shell.child_end[k] = static_cast<std::uint32_t>(n);
  }

  shell.position_T.clear();
  shell.normal_T.clear();
  shell.area_m2.clear();
  for (const std::uint32_t i : order) {
    shell.position_T.push_back(positions[i].cast<float>());
    shell.normal_T.push_back(normals[i].cast<float>().normalized());
    shell.area_m2.push_back(static_cast<float>(areas[i]));
  }
  // Tight radii: each point against each of its ancestors, on the rounded positions.
  std::vector<double> radius(n, 0);
  for (std::size_t k = shell.level_begin[1]; k < n; ++k) {
    for (std::size_t a = k; a >= shell.level_begin[1];) {
      a = parent[a];
      const double d = (shell.position_T[k].cast<double>() - shell.position_T[a].cast<double>()).norm();
      radius[a] = std::max(radius[a], d);
    }
  }
  shell.radius_m.clear();
  for (const double r : radius) shell.radius_m.push_back(static_cast<float>(r * (1 + 1e-6)));
}

}  // namespace tact::contact
