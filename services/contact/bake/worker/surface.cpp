#include "contact/bake/worker/surface.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>

namespace tact::contact {

struct Surface::Scene {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  explicit Scene(const std::vector<std::array<float, 3>>& vertices,
                 const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    device = rtcNewDevice(nullptr);
    if (device == nullptr) throw std::bad_alloc();
    scene = rtcNewScene(device);
    // Robust: no ray slips through a shared edge. Context filter: sees every crossing.
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);  // no spatial splits: each triangle is met once
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                          3 * sizeof(float), vertices.size()));
    auto* t = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                  3 * sizeof(std::uint32_t), triangles.size()));
    if (v == nullptr || t == nullptr) throw std::bad_alloc();
    for (std::size_t i = 0; i < vertices.size(); ++i) std::copy(vertices[i].begin(), vertices[i].end(), v + 3 * i);
    for (std::size_t i = 0; i < triangles.size(); ++i) std::copy(triangles[i].begin(), triangles[i].end(), t + 3 * i);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::bad_alloc();
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  ~Scene() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

Surface::Surface(const Mesh& mesh) {
  if (mesh.triangles.empty()) return;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t i : t) {
      low = low.cwiseMin(mesh.vertices[i].cast<double>());
      high = high.cwiseMax(mesh.vertices[i].cast<double>());
    }
  }
  middle_ = 0.5 * (low + high);
  size_ = (high - low).maxCoeff();
  std::vector<std::array<float, 3>> vertices(mesh.vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector3f p = (mesh.vertices[i].cast<double>() - middle_).cast<float>();
    vertices[i] = {p.x(), p.y(), p.z()};
  }
  std::vector<Triangle> triangles;
  std::vector<SmallTriangle> small;
  std::vector<Ball> balls;
  triangles.reserve(mesh.triangles.size());
  small.reserve(mesh.triangles.size());
  balls.reserve(mesh.triangles.size());
  const double scale = 1 / size_;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]].cast<double>() - middle_, b = mesh.vertices[t[1]].cast<double>() - middle_,
               c = mesh.vertices[t[2]].cast<double>() - middle_, centre = (a + b + c) / 3;
    triangles.emplace_back(a, b, c);
    small.emplace_back(Triangle(scale * a, scale * b, scale * c));
    const double radius = std::max({(a - centre).norm(), (b - centre).norm(), (c - centre).norm()});
    const Eigen::Vector3f at = (scale * centre).cast<float>();
    balls.push_back({at.x(), at.y(), at.z(), static_cast<float>(scale * radius)});
  }
  triangles_ = std::make_shared<const std::vector<Triangle>>(std::move(triangles));
  small_ = std::make_shared<const std::vector<SmallTriangle>>(std::move(small));
  balls_ = std::make_shared<const std::vector<Ball>>(std::move(balls));
  scene_ = std::make_shared<Scene>(vertices, mesh.triangles);
}

namespace {

RTCPointQuery query_at(const Vec3& p, double radius) {
  RTCPointQuery query{};
  query.x = static_cast<float>(p.x());
  query.y = static_cast<float>(p.y());
  query.z = static_cast<float>(p.z());
  query.radius = static_cast<float>(std::min(radius, 1e30));
  return query;
}

struct Nearest {
  const Triangle* triangles;
  Vec3 p;
  double square;
  double hair;
};

struct Gather {
  std::size_t most;
  std::vector<std::uint32_t>* found;
};

struct Collect {
  RTCIntersectContext context;  // first, so that the filter finds the rest behind it
  std::vector<Crossing>* found;
};

void collect_and_go_on(const RTCFilterFunctionNArguments* arguments) {
  auto* collect = reinterpret_cast<Collect*>(arguments->context);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const float along = RTCRayN_dir_x(arguments->ray, arguments->N, i) * RTCHitN_Ng_x(arguments->hit, arguments->N, i) +
                        RTCRayN_dir_y(arguments->ray, arguments->N, i) * RTCHitN_Ng_y(arguments->hit, arguments->N, i) +
                        RTCRayN_dir_z(arguments->ray, arguments->N, i) * RTCHitN_Ng_z(arguments->hit, arguments->N, i);
    collect->found->push_back({RTCHitN_primID(arguments->hit, arguments->N, i), along < 0});
    arguments->valid[i] = 0;  // refused: the ray goes on
  }
}

}  // namespace

double Surface::distance(const Vec3& p, double limit_m) const {
  if (empty()) return limit_m;
  Nearest nearest{triangles_->data(), p - middle_, limit_m * limit_m, 1e-6 * size_};
  // Embree's radius is float: a hair more, so that rounding drops nothing.
  RTCPointQuery query = query_at(nearest.p, limit_m * (1 + 1e-5) + nearest.hair);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(
      scene_->scene, &query, &context,
      [](RTCPointQueryFunctionArguments* a) {
        auto* n = static_cast<Nearest*>(a->userPtr);
        const double square = n->triangles[a->primID].square_distance(n->p);
        if (!(square < n->square)) return false;
        n->square = square;
        a->query->radius = static_cast<float>(std::sqrt(square) * (1 + 1e-5) + n->hair);
        return true;
      },
      &nearest);
  return std::sqrt(nearest.square);
}

bool Surface::near(const Vec3& p, double reach_m, std::size_t most, std::vector<std::uint32_t>& found) const {
  found.clear();
  if (empty()) return true;
  RTCPointQuery query = query_at(p - middle_, reach_m * (1 + 1e-5) + 1e-6 * size_);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  Gather gather{most, &found};
  rtcPointQuery(
      scene_->scene, &query, &context,
      [](RTCPointQueryFunctionArguments* a) {
        auto* g = static_cast<Gather*>(a->userPtr);
        g->found->push_back(a->primID);
        if (g->found->size() <= g->most) return false;
        a->query->radius = 0;  // enough: end the search
        return true;
      },
      &gather);
  return found.size() <= most;
}

void Surface::cross(const Vec3& p, const Vec3& direction, double reach_m, std::vector<Crossing>& found) const {
  if (empty()) return;
  Collect collect{};
  rtcInitIntersectContext(&collect.context);
  collect.context.filter = collect_and_go_on;
  collect.found = &found;
  const Vec3 from = p - middle_;
  RTCRay ray{};
  ray.org_x = static_cast<float>(from.x());
  ray.org_y = static_cast<float>(from.y());
  ray.org_z = static_cast<float>(from.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = 0;
  ray.tfar = static_cast<float>(reach_m);
  ray.mask = 0xffffffffu;
  rtcOccluded1(scene_->scene, &collect.context, &ray);
}

}  // namespace tact::contact
