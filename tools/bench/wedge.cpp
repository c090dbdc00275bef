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

  // A jump stays when the step shrinks, a steep rise does not.
  report.say("Largest change of either from one angle to the next, by step, from 0 to 90 degrees.");
  rows.clear();
  for (const double step : {0.01, 0.001}) {
    const int steps = static_cast<int>((effort.quick ? 10 : 90) / step);
    Report::Row row{number(step)};
    for (const Column& column : kColumns) {
      double largest = 0;
      Felt before = column.at(0);
      for (int i = 1; i <= steps; ++i) {
        const Felt now = column.at(i * step * M_PI / 180);
        largest = std::max({largest, std::fabs(now.across - before.across), std::fabs(now.up - before.up)});
        before = now;
      }
      row.push_back(number(largest));
    }
    rows.push_back(row);
  }
  header.front() = "step, degrees";
  report.table(header, rows);
}

}  // namespace tact::bench
