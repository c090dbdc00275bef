// What a hand feels of a wedge, [P] fig. 4: two contacts whose normals lean by an angle to both sides of the vertical.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "bench/benchmarks.hpp"
#include "contact/response/assemble.hpp"
#include "contact/stiffness/law.hpp"

namespace tact::bench {
namespace {

constexpr double kThreshold = 0.01;  // of k: an eigenvalue below this counts as zero for the filter

/// Stiffness over k, left-right and up-down.
struct Felt {
  double across, up;
};

Mat3 translation(const std::string& law_name, double angle_rad) {
  contact::Pointshell shell;
  contact::ContactBuffer contacts(2);
  contacts.size = 2;
  for (const std::size_t i : {0u, 1u}) {
    const double side = i == 0 ? -1 : 1;
    const Vec3 N(-side * std::sin(angle_rad), 0, std::cos(angle_rad));
    shell.position_T.push_back(Eigen::Vector3f(static_cast<float>(side * 0.05), 0, 0));
    shell.normal_T.push_back(N.cast<float>());
    contacts.point_id[i] = static_cast<std::uint32_t>(i);
    contacts.r[i] = shell.position_T[i].cast<double>();
    contacts.N[i] = contacts.g[i] = N;
    contacts.depth_m[i] = 1e-4;
  }
  shell.radius_m.assign(2, 0.f);
  shell.area_m2.assign(2, 1e-6f);
  shell.child_begin.assign(2, 0);
  shell.child_end.assign(2, 0);
  shell.level_begin = {0, 2};
  shell.bounding_radius_m = 0.05;
  const auto law = contact::make_law(law_name, {}, shell, 2);
  law->weigh(contacts);
  return contact::assemble(contacts, *law, 1, 0, Twist{}).K.topLeftCorner<3, 3>();
}

Felt by_law(const std::string& law_name, double angle_rad) {
  const Mat3 K = translation(law_name, angle_rad);
  return {K(0, 0), K(2, 2)};
}

/// Law `eigen-filter`, the idea [P] shows not to work and that therefore lives here only: every eigenvalue of the
/// unscaled gradient that is not nearly zero becomes k.
Felt eigen_filtered(double angle_rad) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(translation("none", angle_rad));
  Vec3 filtered = Vec3::Zero();
  for (int i = 0; i < 3; ++i) filtered[i] = eigen.eigenvalues()[i] > kThreshold ? 1 : 0;
  const Mat3 K = eigen.eigenvectors() * filtered.asDiagonal() * eigen.eigenvectors().transpose();
  return {K(0, 0), K(2, 2)};
}

struct Column {
  std::string name;
  Felt (*at)(double angle_rad);
};
const Column kColumns[] = {
    {"unscaled", [](double a) { return by_law("none", a); }},
    {"eigen-filter", eigen_filtered},
    {"adaptive-3dof", [](double a) { return by_law("adaptive-3dof", a); }},
    {"adaptive-6dof", [](double a) { return by_law("adaptive-6dof", a); }},
    {"potential", [](double a) { return by_law("potential", a); }},
};

}  // namespace

void bench_wedge(const Effort& effort, Report& report) {
  report.say(
      "[P] fig. 4: two contacts of equal depth, normals leaning by the angle to both sides. Stiffness over k, "
      "left-right / "
      "up-down. eigen-filter: each eigenvalue of the unscaled matrix above " +
      number(kThreshold) + " k becomes k.");
  std::vector<std::string> header{"angle, degrees"};
  for (const Column& column : kColumns) header.push_back(column.name);
  std::vector<Report::Row> rows;
  for (const double degrees : {0.0, 0.1, 0.3, 1.0, 2.0, 4.0, 4.1, 6.0, 10.0, 20.0, 30.0, 45.0, 60.0, 75.0, 90.0}) {
    Report::Row row{number(degrees)};
    for (const Column& column : kColumns) {
      const Felt felt = column.at(degrees * M_PI / 180);
      row.push_back(number(felt.across) + " / " + number(felt.up));
    }
    rows.push_back(row);
  }
  report.table(header, rows);
  Chart chart{
      "Stiffness of a wedge over k, left-right (solid dots: up-down)", "angle, degrees", "over k", false, false, {}};
  for (const Column& column : kColumns) {
    Chart::Line across{column.name, {}}, up{column.name + ", up-down", {}, true};
    for (int degrees = 0; degrees <= 90; degrees += 1) {
      across.points.push_back({1.0 * degrees, column.at(degrees * M_PI / 180).across});
      if (degrees % 5 == 0) up.points.push_back({1.0 * degrees, column.at(degrees * M_PI / 180).up});
    }
    chart.lines.push_back(across);
    if (column.name == "unscaled" || column.name == "eigen-filter" || column.name == "adaptive-6dof")
      chart.lines.push_back(up);
  }
  report.chart(chart);

  // A jump stays when the step shrinks, a steep rise does not.
  report.say("Largest change of either from one angle to the next, by step, from 0 to 90 degrees.");
  rows.clear();
  std::vector<double> jumps, jumps_near_0;  // at the last step, by column; below 10 degrees
  for (const double step : {0.01, 0.001}) {
    const int steps = static_cast<int>((effort.quick ? 10 : 90) / step);
    Report::Row row{number(step)};
    jumps.clear();
    jumps_near_0.clear();
    for (const Column& column : kColumns) {
      double largest = 0, near_0 = 0;
      Felt before = column.at(0);
      for (int i = 1; i <= steps; ++i) {
        const Felt now = column.at(i * step * M_PI / 180);
        largest = std::max({largest, std::fabs(now.across - before.across), std::fabs(now.up - before.up)});
        if (i * step <= 10) near_0 = largest;
        before = now;
      }
      row.push_back(number(largest));
      jumps.push_back(largest);
      jumps_near_0.push_back(near_0);
    }
    rows.push_back(row);
  }
  header.front() = "step, degrees";
  report.table(header, rows);
  // Softer sideways than upwards below 45 degrees, by how much depending on the angle: as without scaling.
  const Felt felt = by_law("adaptive-6dof", 20 * M_PI / 180), true_felt = by_law("none", 20 * M_PI / 180);
  const double ratio = felt.across / felt.up, true_ratio = true_felt.across / true_felt.up;
  const bool jumps_not = jumps_near_0[3] < 0.01 && jumps_near_0[1] > 0.5;
  report.claim(
      "below 45 degrees up-down is stiffer than left-right, by an amount that the angle says; eigenvalue filtering "
      "cannot do that and jumps near 0; the adaptive law can",
      "at 20 degrees left-right over up-down: " + number(true_ratio) + " unscaled, " + number(ratio) +
          " adaptive-6dof; largest change within a thousandth of a degree near 0: eigen-filter " +
          number(jumps_near_0[1]) + " k, adaptive-6dof " + number(jumps_near_0[3]) + " k, potential " +
          number(jumps_near_0[4]) + " k; adaptive-6dof up to 90 degrees: " + number(jumps[3]) + " k",
      jumps_not && std::fabs(ratio - true_ratio) < 0.05 * true_ratio ? Holds::yes
      : jumps_not                                                    ? Holds::partly
                                                                     : Holds::no,
      "Where the two normals come within eps of each other, near 0, the adaptive laws begin to count them as "
      "one: a steep rise, not a jump. Near 90 degrees levers and normals are parallel and the direction of their "
      "torque swings, which adaptive-6dof follows. Law potential shares stiffness between directions and is stiffer "
      "left-right than it should be at small angles.");
}

}  // namespace tact::bench
