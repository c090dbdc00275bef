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

}  // namespace

std::vector<Vec3> Potential::directions(int count) {
  std::vector<Vec3> u;
  const double golden_angle = M_PI * (3.0 - std::sqrt(5.0));
  for (int j = 0; j < count; ++j) {
    const double height = 1.0 - (2.0 * j + 1.0) / count;
    const double radius = std::sqrt(1.0 - height * height), angle = golden_angle * j;
    u.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
  }
  return u;
}

Potential::Potential(const Pointshell& shell, const Params& params, std::size_t capacity)
    : p_(params.p), work_(0, 0, static_cast<std::size_t>(params.directions)) {
  std::vector<Vec3> normals(shell.size());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = shell.normal_T[i].cast<double>().normalized();
  DistinctDirections distinct = distinct_directions(normals);
  class_of_ = std::move(distinct.class_of);
  classes_.reserve(distinct.direction.size());
  const std::vector<Vec3> u = directions(params.directions);
  for (const Vec3& n : distinct.direction) classes_.push_back(make_class(n, u, params));
  const std::size_t contacts = std::min(capacity, shell.size());
  work_ = PotentialWorkspace(contacts, std::min(contacts, classes_.size()), u.size());
}

Potential::Class Potential::make_class(const Vec3& n_T, const std::vector<Vec3>& u, const Params& params) {
  const double limit = std::cos(params.reach_rad);
  const auto begin = static_cast<std::uint32_t>(supports_.beta.size());
  double lonely = 0;
  for (std::size_t j = 0; j < u.size(); ++j) {
    const double t = (n_T.dot(u[j]) - limit) / (1 - limit);
    if (t <= 0) continue;
    const auto beta = static_cast<float>(power(t, params.q));
    if (beta < 1e-30f) continue;
    supports_.direction.push_back(static_cast<std::uint16_t>(j));
    supports_.beta.push_back(beta);
    lonely += std::pow(static_cast<double>(beta), 2.0 / params.p);
  }
  return {{begin, static_cast<std::uint32_t>(supports_.beta.size())}, 1 / std::sqrt(lonely), 0, 0};
}

void Potential::weigh(ContactBuffer& contacts) noexcept {
  ++tick_;
  work_.size = 0;
  for (std::size_t i = 0; i < contacts.size; ++i) {
    const std::uint32_t c = class_of_[contacts.point_id[i]];
    __builtin_prefetch(&classes_[c]);
    work_.group_of[i] = c;
  }
  for (std::size_t i = 0; i < contacts.size; ++i) {
    Class& c = classes_[work_.group_of[i]];
    if (c.tick != tick_) {
      c.tick = tick_;
      c.group = static_cast<std::uint32_t>(work_.size++);
      work_.group[c.group].support = c.support;
      for (const std::uint32_t e : {c.support.begin, c.support.end - 1}) {
        __builtin_prefetch(supports_.direction.data() + e);
        __builtin_prefetch(supports_.beta.data() + e);
      }
    }
    work_.group_of[i] = c.group;
    work_.gamma[i] = c.gamma;
  }
  run_potential(supports_, p_, contacts, work_);
}

/// H_ij = (p-1) w_i [i=j] - (p-2) sum_u A_u^(2/p-2) y_iu y_ju, y_iu = beta_iu gamma_i rho_i^(p-1): the Hessian of E/k
/// in the depths, positive semidefinite as E is convex in them.
void Potential::include_weight_derivative(Mat6& ss, Mat6& sh) const noexcept {
  ss = (p_ - 1) * ss - (p_ - 2) * work_.ss;
  sh = (p_ - 1) * sh - (p_ - 2) * work_.sh;
}

}  // namespace tact::contact
