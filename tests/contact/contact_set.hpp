#pragma once
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "contact/model/contact.hpp"
#include "contact/model/pointshell.hpp"

namespace tact::contact::test {

/// v as single precision stores it. Not inlined: GCC 12 drops the rounding of v.cast<float>().cast<double>() in pairs.
[[gnu::noinline]] inline Vec3 rounded_to_float(const Vec3& v) {
  volatile float f[3];
  for (int i = 0; i < 3; ++i) f[i] = static_cast<float>(v[i]);
  return {f[0], f[1], f[2]};
}

/// R p + t with the bits of place().
inline Vec3 placed(const Mat3& R, const Vec3& t, const Eigen::Vector3f& p) {
  const double x = static_cast<double>(p.x()), y = static_cast<double>(p.y()), z = static_cast<double>(p.z());
  Vec3 out;
  for (int i = 0; i < 3; ++i) out[i] = ((R(i, 0) * x + R(i, 1) * y) + R(i, 2) * z) + t[i];
  return out;
}

/// Contacts by hand: a flat shell (one level) whose points are all in contact, tool frame = field frame.
struct ContactSet {
  std::vector<Vec3> r, N, g;
  std::vector<double> depth_m;

  void add(const Vec3& position, const Vec3& normal, double depth) { add(position, normal, depth, normal); }
  void add(const Vec3& position, const Vec3& normal, double depth, const Vec3& gradient) {
    r.push_back(rounded_to_float(position));  // as the shell stores them
    N.push_back(rounded_to_float(normal.normalized()));
    g.push_back(gradient);
    depth_m.push_back(depth);
  }
  std::size_t size() const { return r.size(); }

  Pointshell shell() const {
    Pointshell s;
    for (std::size_t i = 0; i < size(); ++i) {
      s.position_T.push_back(r[i].cast<float>());
      s.normal_T.push_back(N[i].cast<float>());
    }
    s.radius_m.assign(size(), 0.f);
    s.child_begin.assign(size(), 0);
    s.child_end.assign(size(), 0);
    s.level_begin = {0, static_cast<std::uint32_t>(size())};
    s.area_m2.assign(size(), 1e-6f);
    return s;
  }
  ContactBuffer buffer() const {
    ContactBuffer b(size());
    b.size = size();
    for (std::size_t i = 0; i < size(); ++i) {
      b.point_id[i] = static_cast<std::uint32_t>(i);
      b.r[i] = r[i];
      b.N[i] = N[i];
      b.g[i] = g[i];
      b.depth_m[i] = depth_m[i];
    }
    return b;
  }
};

inline Vec3 random_unit(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  for (;;) {
    const Vec3 v(normal(rng), normal(rng), normal(rng));
    if (v.norm() > 1e-3) return v.normalized();
  }
}

inline double uniform(std::mt19937& rng, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(rng);
}

/// Points all over, normals all over or (clusters > 0) near a few directions, depths up to 1 mm.
inline ContactSet random_contacts(std::mt19937& rng, int n, int clusters = 0, double spread = 0) {
  ContactSet set;
  std::vector<Vec3> centre;
  for (int c = 0; c < clusters; ++c) centre.push_back(random_unit(rng));
  for (int i = 0; i < n; ++i) {
    Vec3 normal = random_unit(rng);
    if (clusters > 0) normal = centre[static_cast<std::size_t>(i % clusters)] + spread * normal;
    set.add(uniform(rng, 0.01, 0.1) * random_unit(rng), normal, uniform(rng, 1e-5, 1e-3),
            normal.normalized() + 0.1 * random_unit(rng));
  }
  return set;
}

/// A face of m x m points in the plane z = 0, inward normal +z, all at one depth.
inline ContactSet flat_face(int nx, int ny, double side_m, double depth) {
  ContactSet set;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      set.add(Vec3(side_m * (i + 0.5) / nx - side_m / 2, side_m * (j + 0.5) / ny - side_m / 2, 0), Vec3::UnitZ(),
              depth);
    }
  return set;
}

}  // namespace tact::contact::test
