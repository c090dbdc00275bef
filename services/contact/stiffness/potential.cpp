#include "contact/stiffness/potential.hpp"

#include <algorithm>
#include <cmath>

#include "contact/stiffness/distinct_directions.hpp"

namespace tact::contact {
namespace {

/// x^n, n >= 0, by squaring.
double power(double x, int n) noexcept {
  double result = 1;
  for (; n > 0; n >>= 1, x *= x) {
    if (n & 1) result *= x;
  }
  return result;
}

double normalisation(const PotentialDirections& u, int p, int q) { return (2.0 * q / p + 1.0) / u.count; }

/// gamma of a normal: a lonely contact weighs c gamma^2 sum_u beta^(2/p) = 1.
double lonely_scale(const PotentialDirections& u, int p, int q, const Vec3& n) {
  double sum = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(u.count); ++j) {
    const double t = 0.5 + n.x() * u.x[j] + n.y() * u.y[j] + n.z() * u.z[j];
    sum += std::pow(std::max(t, 0.0), 2.0 * q / p);
  }
  return 1.0 / std::sqrt(normalisation(u, p, q) * sum);
}

}  // namespace

Potential::Potential(const Pointshell& shell, int p, int q, int directions, std::size_t capacity)
    : p_(p), q_(q), directions_(directions), work_(0) {
  std::vector<Vec3> normals(shell.size());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = shell.normal_T[i].cast<double>().normalized();
  DistinctDirections distinct = distinct_directions(normals);
  class_of_ = std::move(distinct.class_of);
  classes_.reserve(distinct.direction.size());
  for (const Vec3& n : distinct.direction) classes_.push_back({n, lonely_scale(directions_, p, q, n), 0, 0});
  work_ = PotentialWorkspace(std::min(capacity, classes_.size()));
}

void Potential::weigh(ContactBuffer& contacts) noexcept {
  ++tick_;
  work_.size = 0;
  double deepest = 0;
  for (std::size_t i = 0; i < contacts.size; ++i) deepest = std::max(deepest, contacts.depth_m[i]);

  for (std::size_t i = 0; i < contacts.size; ++i) {
    Class& c = classes_[class_of_[contacts.point_id[i]]];
    if (c.tick != tick_) {
      c.tick = tick_;
      c.group = static_cast<std::uint32_t>(work_.size++);
      work_.group[c.group] = {{c.n_T.x(), c.n_T.y(), c.n_T.z()}, 0, {}};
    }
    PotentialGroup& group = work_.group[c.group];
    const double rho = c.gamma * contacts.depth_m[i] / deepest;
    const double slope = power(rho, p_ - 1);
    group.power += slope * rho;
    const Vec3& r = contacts.r[i];
    const Vec3& N = contacts.N[i];
    const Vec3& g = contacts.g[i];
    const Vec3 rxN = r.cross(N), rxg = r.cross(g);
    const double y = c.gamma * slope;
    for (int a = 0; a < 3; ++a) {
      group.moment[a] += y * N[a];
      group.moment[3 + a] += y * rxN[a];
      group.moment[6 + a] += y * g[a];
      group.moment[9 + a] += y * rxg[a];
    }
  }
  run_potential(directions_, p_, q_, work_);

  const double c = normalisation(directions_, p_, q_);
  for (std::size_t i = 0; i < contacts.size; ++i) {
    const Class& k = classes_[class_of_[contacts.point_id[i]]];
    const double rho = k.gamma * contacts.depth_m[i] / deepest;
    contacts.weight[i] = c * k.gamma * k.gamma * power(rho, p_ - 2) * work_.sum[k.group];
  }
}

/// H_ij = (p-1) w_i [i=j] - (p-2) c sum_u A_u^(2/p-2) y_iu y_ju, y_iu = beta_iu gamma_i rho_i^(p-1): the Hessian of E/k
/// in the depths, positive semidefinite as E is convex in them.
void Potential::include_weight_derivative(Mat6& ss, Mat6& sh) const noexcept {
  const double c = normalisation(directions_, p_, q_);
  ss = (p_ - 1) * ss - (p_ - 2) * c * work_.ss;
  sh = (p_ - 1) * sh - (p_ - 2) * c * work_.sh;
}

}  // namespace tact::contact
