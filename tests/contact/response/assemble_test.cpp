#include "contact/response/assemble.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <functional>

#include "contact/contact_set.hpp"
#include "math/exp_log.hpp"

namespace tact::contact {
namespace {

using test::ContactSet;

/// An analytic field: value, gradient and second derivative at a point of O.
struct Field {
  std::function<double(const Vec3&)> value;
  std::function<Vec3(const Vec3&)> gradient;
  std::function<Mat3(const Vec3&)> curvature;
};

Field half_space() {
  return {[](const Vec3& p) { return p.z(); }, [](const Vec3&) { return Vec3(Vec3::UnitZ()); },
          [](const Vec3&) { return Mat3(Mat3::Zero()); }};
}
Field sphere(double radius) {
  return {[=](const Vec3& p) { return p.norm() - radius; }, [](const Vec3& p) { return Vec3(p.normalized()); },
          [](const Vec3& p) {
            const Vec3 n = p.normalized();
            return Mat3((Mat3::Identity() - n * n.transpose()) / p.norm());
          }};
}

/// The contacts of a fixed set of points at a pose: no point joins or leaves, so the wrench is differentiable.
ContactBuffer contacts_at(const ContactSet& points, const Field& field, const Pose& X_OT,
                          ForceDirection along = ForceDirection::gradient) {
  ContactBuffer b(points.size());
  b.force_along = along;
  b.size = points.size();
  for (std::size_t i = 0; i < b.size; ++i) {
    const Vec3 p_O = X_OT * points.r[i];
    b.point_id[i] = static_cast<std::uint32_t>(i);
    b.r[i] = X_OT.q * points.r[i];
    b.N[i] = X_OT.q * points.N[i];
    b.g[i] = field.gradient(p_O);
    b.depth_m[i] = -field.value(p_O);
  }
  return b;
}

Response respond(Law& law, ContactBuffer b, double k, double damping = 0, const Twist& V = {}) {
  law.weigh(b);
  return assemble(b, law, k, damping, V);
}

/// Points just under the surface of the field, normals near its gradient but not equal to it.
ContactSet points_in(const Field& field, std::mt19937& rng, int n, double extent) {
  ContactSet set;
  while (set.size() < static_cast<std::size_t>(n)) {
    const Vec3 p(test::uniform(rng, -extent, extent), test::uniform(rng, -extent, extent),
                 test::uniform(rng, -extent, extent));
    const double depth = -field.value(p);
    if (depth > 2e-4 && depth < 3e-3) set.add(p, field.gradient(p) + 0.3 * test::random_unit(rng), depth);
  }
  return set;
}

TEST(Assemble, APointInAPlaneIsPushedOutAsByASpring) {
  ContactSet set;
  set.add(Vec3(0.1, 0, 0), Vec3::UnitZ(), 2e-3);
  const auto law = make_law("none", {}, set.shell(), 1);
  const Response a = respond(*law, set.buffer(), 1000);
  EXPECT_NEAR(a.F.force.z(), 2.0, 1e-6);
  EXPECT_NEAR(a.F.torque.y(), -0.2, 1e-6);  // (0.1, 0, 0) x (0, 0, 2)
  EXPECT_NEAR(a.K(2, 2), 1000, 1e-6);
  EXPECT_NEAR(a.G(2, 2), -1000, 1e-6);
  EXPECT_EQ(a.B.norm(), 0);
}

/// How forces along g turn as the field's own gradient does: what assemble leaves out of G.
Mat6 from_curvature(const ContactBuffer& weighed, const Field& field, double k) {
  Mat6 out = Mat6::Zero();
  for (std::size_t i = 0; i < weighed.size; ++i) {
    Eigen::Matrix<double, 3, 6> moved;
    moved << Mat3::Identity(), -skew(weighed.r[i]);
    const Mat3 turn = k * weighed.weight[i] * weighed.depth_m[i] * field.curvature(weighed.r[i]);
    out += moved.transpose() * turn * moved;
  }
  return out;
}

/// G against central differences of the wrench, for every law and direction of force, with the contact set frozen.
TEST(Assemble, GIsTheDerivativeOfTheWrenchForEveryLaw) {
  std::mt19937 rng(21);
  for (const Field& field : {half_space(), sphere(0.05)}) {
    const ContactSet points = points_in(field, rng, 60, 0.05);
    const Pose X_OT;
    LawParams params;
    params.epsilon = 0.2;  // so that the adaptive laws have something to weigh
    for (const std::string_view name : law_names()) {
      for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
        const auto law = make_law(name, params, points.shell(), points.size());
        const double k = 2e4;
        ContactBuffer here = contacts_at(points, field, X_OT, along);
        law->weigh(here);
        Mat6 G = assemble(here, *law, k, 0, {}).G;
        if (along == ForceDirection::gradient) G += from_curvature(here, field, k);
        Mat6 numeric;
        for (int c = 0; c < 6; ++c) {
          const double step = c < 3 ? 1e-7 : 1e-6;
          const Vec6 dx = step * Vec6::Unit(c);
          const auto wrench = [&](const Vec6& x) {
            return respond(*law, contacts_at(points, field, displaced(X_OT, x), along), k).F.vector();
          };
          numeric.col(c) = (wrench(dx) - wrench(-dx)) / (2 * step);
        }
        EXPECT_LT((G - numeric).norm(), 1e-5 * G.norm()) << name << "\n" << G << "\n\n" << numeric;
        EXPECT_LT((G.bottomRows<3>() - numeric.bottomRows<3>()).norm(), 1e-4 * G.bottomRows<3>().norm()) << name;
      }
    }
  }
}

/// The formulas of assemble.hpp, contact by contact, for weights that do not follow the depths.
Response by_definition(const ContactBuffer& c, double k, double damping, const Twist& V) {
  Response out;
  Vec6 F = Vec6::Zero();
  for (std::size_t i = 0; i < c.size; ++i) {
    const Vec3 &r = c.r[i], &g = c.g[i], &e = c.force_direction(i);
    Vec6 s, sh;
    s << e, r.cross(e);
    sh << g, r.cross(g);
    const double w = c.weight[i], spring = k * c.depth_m[i], speed = s.dot(V.vector());
    const double b = std::fabs(speed) > 0 ? std::min(damping, spring / std::fabs(speed)) : damping;
    F += w * (spring - b * speed) * s;
    out.G -= k * w * s * sh.transpose();
    out.K += k * w * s * s.transpose();
    out.B += w * b * s * s.transpose();
    const Vec3 f = w * spring * e;
    if (e == g) {
      out.G.block<3, 3>(3, 3) += skew(f) * skew(r);
    } else {
      out.G.block<3, 3>(0, 3) -= skew(f);
      out.G.block<3, 3>(3, 3) -= skew(r.cross(f));
    }
  }
  out.F = Wrench::from(F);
  return out;
}

TEST(Assemble, AnyNumberOfContactsSumsUpAsDefined) {
  std::mt19937 rng(26);
  for (int n = 1; n <= 40; ++n) {
    const ContactSet set = test::random_contacts(rng, n);
    const auto law = make_law("none", {}, set.shell(), set.size());
    for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
      ContactBuffer contacts = set.buffer();
      contacts.force_along = along;
      law->weigh(contacts);
      for (std::size_t i = 0; i < contacts.size; ++i) {
        contacts.weight[i] = test::uniform(rng, 0.1, 1);
        contacts.g[i] = rng() % 4 == 0 ? Vec3(Vec3::Zero()) : test::random_unit(rng);
      }
      for (const double damping : {0.0, 1.0, 1e3}) {
        const Twist V = Twist::from(Vec6(1e-2 * Vec6::Random()));
        const Response a = assemble(contacts, *law, 1000, damping, V), b = by_definition(contacts, 1000, damping, V);
        EXPECT_LT((a.F.vector() - b.F.vector()).norm(), 1e-12 * (1 + b.F.vector().norm())) << n;
        EXPECT_LT((a.G - b.G).norm(), 1e-12 * b.G.norm()) << n;
        EXPECT_LT((a.K - b.K).norm(), 1e-12 * b.K.norm()) << n;
        EXPECT_LE((a.B - b.B).norm(), 1e-12 * b.B.norm()) << n;
      }
    }
  }
}

/// The points of a set that are inside the field at a pose.
ContactBuffer touching(const ContactSet& points, const Field& field, const Pose& X_OT, ForceDirection along) {
  const ContactBuffer all = contacts_at(points, field, X_OT, along);
  ContactBuffer b(points.size());
  b.force_along = along;
  for (std::size_t i = 0; i < all.size; ++i) {
    if (all.depth_m[i] <= 0) continue;
    b.point_id[b.size] = all.point_id[i];
    b.r[b.size] = all.r[i];
    b.N[b.size] = all.N[i];
    b.g[b.size] = all.g[i];
    b.depth_m[b.size++] = all.depth_m[i];
  }
  return b;
}

/// Once round: into contact, along and turning, out again, while points join and leave. Relative to the work done on
/// the way in.
double net_work(const std::string& name, ForceDirection along) {
  std::mt19937 rng(31);
  const Field field = sphere(0.05);
  const ContactSet points = points_in(field, rng, 200, 0.05);
  const auto law = make_law(name, {}, points.shell(), points.size());
  const int steps = 20000;
  const auto pose = [&](int step) {
    const double angle = 2 * std::numbers::pi * step / steps;
    return Pose{Vec3(1e-3 * std::cos(angle), 2e-3 * std::sin(angle), 1e-3 * std::sin(2 * angle)),
                exp_so3(Vec3(0.02 * std::sin(angle), 0.03 * std::cos(angle), 0.01 * std::cos(3 * angle)))};
  };
  double net = 0, absolute = 0;
  for (int step = 0; step < steps; ++step) {
    const Vec6 dx = displacement(pose(step), pose(step + 1));
    const Pose middle = displaced(pose(step), 0.5 * dx);
    const double work = respond(*law, touching(points, field, middle, along), 2e4).F.vector().dot(dx);
    net += work;
    absolute += std::fabs(work);
  }
  return net / absolute;
}

TEST(Assemble, AlongTheGradientNoWorkIsDoneRoundAClosedPath) {
  EXPECT_LT(std::fabs(net_work("none", ForceDirection::gradient)), 1e-5);
  EXPECT_LT(std::fabs(net_work("potential", ForceDirection::gradient)), 1e-5);
  // Along the points' normals, or with weights that follow the number of contacts, energy comes and goes.
  EXPECT_GT(std::fabs(net_work("none", ForceDirection::normal)), 1e-4);
  EXPECT_GT(std::fabs(net_work("potential", ForceDirection::normal)), 1e-4);
}

TEST(Assemble, KIsSymmetricAndPositiveSemidefiniteForEveryLaw) {
  std::mt19937 rng(22);
  for (int trial = 0; trial < 30; ++trial) {
    const ContactSet set = test::random_contacts(rng, 1 + 7 * trial, trial % 9, 0.05);
    for (const std::string_view name : law_names()) {
      const auto law = make_law(name, {}, set.shell(), set.size());
      const Mat6 K = respond(*law, set.buffer(), 1000).K;
      EXPECT_EQ((K - K.transpose()).norm(), 0) << name;
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat6>(K).eigenvalues().minCoeff(), -1e-11 * K.norm()) << name;
    }
  }
}

TEST(Assemble, PotentialIsAtLeastKStiffAlongTheNormalOfParallelContacts) {
  std::mt19937 rng(23);
  for (int trial = 0; trial < 30; ++trial) {
    ContactSet set = test::flat_face(6, 6, 0.1, 0);
    for (auto& d : set.depth_m) d = std::pow(10, test::uniform(rng, -6, -3));
    const auto law = make_law("potential", {}, set.shell(), set.size());
    EXPECT_GE(respond(*law, set.buffer(), 1000).K(2, 2), 1000 * (1 - 1e-9));
  }
}

TEST(Assemble, DampingOpposesTheMotionAndBIsItsMatrix) {
  std::mt19937 rng(24);
  const ContactSet set = test::random_contacts(rng, 50);
  const auto law = make_law("potential", {}, set.shell(), set.size());
  const Twist V = Twist::from(1e-3 * Vec6::Random());
  const Twist slow = Twist::from(1e-3 * V.vector());
  EXPECT_EQ(respond(*law, set.buffer(), 1000, 1e-3, slow).status & bit(Status::capped), 0u);
  for (const double damping : {1.0, 1e3, 1e6}) {
    const Response still = respond(*law, set.buffer(), 1000, 0, V);
    const Response moving = respond(*law, set.buffer(), 1000, damping, V);
    const Vec6 damped = moving.F.vector() - still.F.vector();
    EXPECT_LT((damped + moving.B * V.vector()).norm(), 1e-9 * still.F.vector().norm());
    EXPECT_LE(damped.dot(V.vector()), 0);
    EXPECT_EQ((moving.B - moving.B.transpose()).norm(), 0);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat6>(moving.B).eigenvalues().minCoeff(), -1e-11 * moving.B.norm());
    EXPECT_EQ((moving.status & bit(Status::capped)) != 0, damping >= 1e3);
  }
}

TEST(Assemble, DampingNeverPullsHoweverFastTheToolLeavesOrArrives) {
  for (const double speed : {-100.0, -1.0, -1e-3, 1e-3, 1.0, 100.0}) {
    ContactSet set;
    set.add(Vec3::Zero(), Vec3::UnitZ(), 1e-3);
    const auto law = make_law("none", {}, set.shell(), 1);
    const Response a = respond(*law, set.buffer(), 1000, 10, {Vec3(0, 0, speed), Vec3::Zero()});
    EXPECT_GE(a.F.force.z(), 0);
    EXPECT_LE(a.F.force.z(), 2.0 + 1e-12);
  }
}

TEST(Assemble, TurningTheResponseIsTurningTheContacts) {
  std::mt19937 rng(25);
  const ContactSet set = test::random_contacts(rng, 30);
  const Quat q = exp_so3(Vec3(0.3, -1.2, 2.0));
  const auto law = make_law("adaptive-6dof", {}, set.shell(), set.size());
  ContactBuffer turned = set.buffer();
  for (std::size_t i = 0; i < turned.size; ++i) {
    for (auto* v : {&turned.r[i], &turned.N[i], &turned.g[i]}) *v = q * *v;
  }
  const Twist V{Vec3(0.01, 0.02, -0.01), Vec3(0.1, 0, 0.2)};
  const Response a = rotated(respond(*law, set.buffer(), 1000, 1, V), q.toRotationMatrix());
  const Response b = respond(*law, turned, 1000, 1, {q * V.linear, q * V.angular});
  EXPECT_LT((a.F.vector() - b.F.vector()).norm(), 1e-9);
  EXPECT_LT((a.G - b.G).norm(), 1e-9 * b.G.norm());
  EXPECT_LT((a.K - b.K).norm(), 1e-9 * b.K.norm());
  EXPECT_LT((a.B - b.B).norm(), 1e-9 * b.B.norm());
}

TEST(Assemble, NoContactsMeanNoWrench) {
  const ContactSet set = test::flat_face(2, 2, 0.1, 1e-3);
  for (const std::string_view name : law_names()) {
    const auto law = make_law(name, {}, set.shell(), 4);
    const Response a = respond(*law, ContactBuffer(4), 1000, 1);
    EXPECT_EQ(a.F.vector().norm() + a.G.norm() + a.K.norm() + a.B.norm(), 0) << name;
  }
}

}  // namespace
}  // namespace tact::contact
