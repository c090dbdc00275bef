#include "view/render/ray_tracer.hpp"

#include <embree3/rtcore.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "fault/fault.hpp"

namespace tact::view {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr int kLanes = 8;  // rays traced together: 4 x 2 pixels, or 4 samples of 2 pixels
constexpr float kInfinity = std::numeric_limits<float>::infinity();

enum Body : std::uint8_t { kNothing, kObstacle, kTool };

// Linear light, blue green red.
const std::array<Vec3f, 3> kAlbedo{Vec3f(0, 0, 0), Vec3f(0.56f, 0.33f, 0.17f), Vec3f(0.11f, 0.16f, 0.68f)};
const Vec3f kLight_E = Vec3f(-0.5f, 0.62f, 0.6f).normalized();
const Vec3f kFill_E = Vec3f(0.8f, -0.1f, 0.6f).normalized();
constexpr float kHiddenArrow = 0.5f;  // opacity of an arrow behind a body

struct Surface {
  float t = kInfinity;
  Vec3f N = Vec3f::Zero();  // towards the viewer, in W
  Body body = kNothing;
};

// Position of sample s of four inside a pixel: a rotated grid.
constexpr std::array<std::array<float, 2>, 4> kSamples{
    {{0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}}};

std::uint8_t to_srgb(float linear) {
  static const std::array<std::uint8_t, 1024> table = [] {
    std::array<std::uint8_t, 1024> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double v = static_cast<double>(i) / 1023;
      t[i] = static_cast<std::uint8_t>(
          std::lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055)));
    }
    return t;
  }();
  return table[static_cast<std::size_t>(std::clamp(linear, 0.0f, 1.0f) * 1023.0f)];
}

float to_linear(std::uint8_t srgb) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double v = static_cast<double>(i) / 255;
      t[i] = static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table[srgb];
}

RTCScene build_body(RTCDevice device, const Mesh& mesh) {
  RTCScene scene = rtcNewScene(device);
  if (!mesh.triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Copies: embree may read 16 bytes at the last vertex, and the caller's mesh may go.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                             mesh.vertices.size());
    std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3f));
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(std::uint32_t), mesh.triangles.size());
    std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * 3 * sizeof(std::uint32_t));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcJoinCommitScene(scene);
  return scene;
}

void place(RTCGeometry instance, const Pose& X) {
  Eigen::Matrix<float, 3, 4> matrix;  // column-major, as RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR wants
  matrix << X.R().cast<float>(), X.p.cast<float>();
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
  rtcCommitGeometry(instance);
}

struct Box {
  Vec3f low = Vec3f::Constant(kInfinity), high = Vec3f::Constant(-kInfinity);
};

Box box_of(const Mesh& mesh) {
  Box box;
  for (const Vec3f& v : mesh.vertices) {
    box.low = box.low.cwiseMin(v);
    box.high = box.high.cwiseMax(v);
  }
  return box;
}

}  // namespace

struct RayTracer::Trees {
  RTCDevice device = nullptr;
  RTCScene obstacle = nullptr, tool = nullptr, world = nullptr, arrows = nullptr;
  RTCGeometry obstacle_instance = nullptr, tool_instance = nullptr;
  Box obstacle_box, tool_box;
  tbb::task_arena arena;

  // Of the picture being made.
  int width = 0, height = 0;
  float shadow_offset = 0;
  Vec3f eye, right, up, forward, light, fill;  // W
  std::array<Eigen::Matrix3f, 3> R_W;          // body -> W, by Body
  std::vector<Surface> surfaces;               // one a pixel
  std::vector<Vec3f> arrow_colors;             // linear
  std::vector<std::uint8_t> arrow_tiles;

  explicit Trees(int threads) : arena(threads) {}
  ~Trees() {
    for (RTCGeometry geometry : {obstacle_instance, tool_instance}) {
      if (geometry != nullptr) rtcReleaseGeometry(geometry);
    }
    for (RTCScene scene : {obstacle, tool, world, arrows}) {
      if (scene != nullptr) rtcReleaseScene(scene);
    }
    if (device != nullptr) rtcReleaseDevice(device);
  }

  RTCGeometry add_instance(RTCScene body, unsigned id) {
    RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, body);
    rtcSetGeometryTimeStepCount(instance, 1);
    place(instance, Pose{});
    rtcAttachGeometryByID(world, instance, id);
    return instance;
  }

  Vec3f direction(float x, float y) const {
    return (forward + (2 * x / static_cast<float>(width) - 1) * right + (1 - 2 * y / static_cast<float>(height)) * up)
        .normalized();
  }

  struct Rays {
    alignas(32) RTCRayHit8 hits;
    alignas(32) int valid[kLanes];
    std::array<Vec3f, kLanes> directions;
  };

  void aim(Rays& rays, int lane, float x, float y) const {
    const Vec3f d = direction(x, y);
    rays.directions[static_cast<std::size_t>(lane)] = d;
    RTCRay8& ray = rays.hits.ray;
    ray.org_x[lane] = eye.x(), ray.org_y[lane] = eye.y(), ray.org_z[lane] = eye.z();
    ray.dir_x[lane] = d.x(), ray.dir_y[lane] = d.y(), ray.dir_z[lane] = d.z();
    ray.tnear[lane] = 0, ray.tfar[lane] = kInfinity, ray.time[lane] = 0;
    ray.mask[lane] = ~0u, ray.id[lane] = 0, ray.flags[lane] = 0;
    rays.hits.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    rays.hits.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    rays.valid[lane] = -1;
  }

  static void intersect(Rays& rays, RTCScene scene) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(rays.valid, scene, &context, &rays.hits);
  }

  // Normal of the hit of a lane, in the frame of what was hit, turned towards the viewer.
  static Vec3f normal(const Rays& rays, int lane) {
    const RTCHit8& hit = rays.hits.hit;
    return {hit.Ng_x[lane], hit.Ng_y[lane], hit.Ng_z[lane]};
  }

  Surface surface(const Rays& rays, int lane) const {
    Surface s;
    if (rays.hits.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) return s;
    s.body = rays.hits.hit.instID[0][lane] == kTool ? kTool : kObstacle;
    s.t = rays.hits.ray.tfar[lane];
    s.N = (R_W[s.body] * normal(rays, lane)).normalized();
    if (s.N.dot(rays.directions[static_cast<std::size_t>(lane)]) > 0) s.N = -s.N;
    return s;
  }

  // Which of the lanes the key light reaches.
  std::array<bool, kLanes> lit(const Rays& rays, const std::array<Surface, kLanes>& hits) const {
    alignas(32) RTCRay8 ray;
    alignas(32) int valid[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const Surface& s = hits[static_cast<std::size_t>(i)];
      valid[i] = s.body != kNothing && s.N.dot(light) > 0 ? -1 : 0;
      const Vec3f p =
          valid[i] != 0 ? Vec3f(eye + s.t * rays.directions[static_cast<std::size_t>(i)] + shadow_offset * s.N) : eye;
      ray.org_x[i] = p.x(), ray.org_y[i] = p.y(), ray.org_z[i] = p.z();
      ray.dir_x[i] = light.x(), ray.dir_y[i] = light.y(), ray.dir_z[i] = light.z();
      ray.tnear[i] = 0, ray.tfar[i] = kInfinity, ray.time[i] = 0, ray.mask[i] = ~0u, ray.id[i] = 0, ray.flags[i] = 0;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccluded8(valid, world, &context, &ray);
    std::array<bool, kLanes> result{};
    for (int i = 0; i < kLanes; ++i) result[static_cast<std::size_t>(i)] = valid[i] != 0 && ray.tfar[i] >= 0;
    return result;
  }

  Vec3f shade(const Vec3f& albedo, const Vec3f& N, const Vec3f& view, bool lit) const {
    const float key = std::max(0.0f, N.dot(light));
    const float sky = 0.30f + 0.14f * N.z() + 0.20f * std::max(0.0f, N.dot(fill));
    const float bright = sky + (lit ? 0.85f * key : 0.10f * key);
    const float mirror = std::max(0.0f, N.dot((light - view).normalized()));
    const float mirror4 = mirror * mirror * mirror * mirror, mirror16 = mirror4 * mirror4 * mirror4 * mirror4;
    const float shine = lit ? 0.16f * mirror16 * mirror16 * mirror16 : 0.0f;
    return bright * albedo + Vec3f::Constant(shine);
  }

  Vec3f backdrop(float y) const {
    const float s = y / static_cast<float>(height);
    return (1 - s) * Vec3f(0.95f, 0.94f, 0.93f) + s * Vec3f(0.78f, 0.73f, 0.69f);
  }

  Vec3f color(const Rays& rays, const Surface& s, int lane, bool is_lit, float y) const {
    if (s.body == kNothing) return backdrop(y);
    return shade(kAlbedo[s.body], s.N, rays.directions[static_cast<std::size_t>(lane)], is_lit);
  }

  void put(Image& out, int x, int y, const Vec3f& linear) const {
    std::uint8_t* p = out.bgr.data() +
                      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    for (int c = 0; c < 3; ++c) p[c] = to_srgb(linear[c]);
  }

  Surface& at(int x, int y) {
    return surfaces[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }

  void trace_rows(int y, Image& out) {
    Rays rays;
    for (int x = 0; x < width; x += 4) {
      for (int i = 0; i < kLanes; ++i) {
        // Outside the picture a lane repeats an inner pixel: harmless, and the packet stays full.
        aim(rays, i, static_cast<float>(std::min(x + i % 4, width - 1)) + 0.5f,
            static_cast<float>(std::min(y + i / 4, height - 1)) + 0.5f);
      }
      intersect(rays, world);
      std::array<Surface, kLanes> hits;
      bool any = false;
      for (int i = 0; i < kLanes; ++i) {
        hits[static_cast<std::size_t>(i)] = surface(rays, i);
        any |= hits[static_cast<std::size_t>(i)].body != kNothing;
      }
      const auto lights = any ? lit(rays, hits) : std::array<bool, kLanes>{};
      for (int i = 0; i < kLanes; ++i) {
        const int px = x + i % 4, py = y + i / 4;
        if (px >= width || py >= height) continue;
        const Surface& s = hits[static_cast<std::size_t>(i)];
        at(px, py) = s;
        put(out, px, py, color(rays, s, i, lights[static_cast<std::size_t>(i)], static_cast<float>(py)));
      }
    }
  }

  // 0: inside a face; 1: a fold of one body; 2: the outline of a body.
  int edge(int x, int y) {
    const Surface& s = at(x, y);
    int found = 0;
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
      const Surface& other = at(x + dx, y + dy);
      if (other.body != s.body) return 2;
      if (s.body == kNothing) continue;
      if (std::abs(other.t - s.t) > 0.02f * s.t) found = 2;
      if (other.N.dot(s.N) < 0.93f) found = std::max(found, 1);
    }
    return found;
  }

  // Four samples where a body or a face ends; folds a little darker, as in a technical drawing.
  void smooth_row(int y, Image& out) {
    Rays rays;
    for (int x = 0; x < width; ++x) {
      const int kind = edge(x, y);
      if (kind == 0) continue;
      for (int i = 0; i < kLanes; ++i) rays.valid[i] = 0;
      for (int i = 0; i < 4; ++i) {
        aim(rays, i, static_cast<float>(x) + kSamples[static_cast<std::size_t>(i)][0],
            static_cast<float>(y) + kSamples[static_cast<std::size_t>(i)][1]);
      }
      intersect(rays, world);
      std::array<Surface, kLanes> hits;
      for (int i = 0; i < 4; ++i) hits[static_cast<std::size_t>(i)] = surface(rays, i);
      const auto lights = lit(rays, hits);
      Vec3f sum = Vec3f::Zero();
      for (int i = 0; i < 4; ++i) {
        const Surface& s = hits[static_cast<std::size_t>(i)];
        const float ink = s.body == kNothing ? 1.0f : kind == 2 ? 0.75f : 0.85f;
        sum += ink * color(rays, s, i, lights[static_cast<std::size_t>(i)], static_cast<float>(y));
      }
      put(out, x, y, 0.25f * sum);
    }
  }

  static constexpr int kTile = 8;
  int tiles_x() const { return (width + kTile - 1) / kTile; }

  void build_arrows(std::span<const Arrow> list, const Camera& camera) {
    if (arrows != nullptr) rtcReleaseScene(arrows);
    arrows = nullptr;
    arrow_colors.clear();
    if (list.empty()) return;
    arrows = rtcNewScene(device);
    rtcSetSceneBuildQuality(arrows, RTC_BUILD_QUALITY_LOW);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE);
    // Two segments an arrow: shaft and head.
    auto* vertices = static_cast<Eigen::Vector4f*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(Eigen::Vector4f), 4 * list.size()));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(std::uint32_t), 2 * list.size()));
    arrow_tiles.assign(static_cast<std::size_t>(tiles_x()) * static_cast<std::size_t>((height + kTile - 1) / kTile), 0);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Arrow& arrow = list[i];
      const Vec3 along = (arrow.tip_W - arrow.tail_W).normalized();
      const Vec3 neck = arrow.tip_W - arrow.head_m * along;
      const auto vertex = [](const Vec3& p, double r) {
        return Eigen::Vector4f(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
                               static_cast<float>(r));
      };
      const double head_radius = arrow.head_m > 0 ? 2.8 * arrow.radius_m : arrow.radius_m;
      vertices[4 * i] = vertex(arrow.tail_W, arrow.radius_m);
      vertices[4 * i + 1] = vertex(neck, arrow.radius_m);
      vertices[4 * i + 2] = vertex(neck, head_radius);
      vertices[4 * i + 3] = vertex(arrow.tip_W, arrow.head_m > 0 ? 0.02 * arrow.radius_m : arrow.radius_m);
      indices[2 * i] = static_cast<std::uint32_t>(4 * i);
      indices[2 * i + 1] = static_cast<std::uint32_t>(4 * i + 2);
      arrow_colors.emplace_back(to_linear(arrow.color[0]), to_linear(arrow.color[1]), to_linear(arrow.color[2]));
      mark_tiles(camera, arrow, 2 + head_radius / camera.picture_height_m(arrow.tail_W) * height);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(arrows, geometry);
    rtcReleaseGeometry(geometry);
    rtcJoinCommitScene(arrows);
  }

  void mark_tiles(const Camera& camera, const Arrow& arrow, double margin_px) {
    const Eigen::Vector2d a = camera.project(arrow.tail_W, width, height),
                          b = camera.project(arrow.tip_W, width, height);
    const Eigen::Vector2d low = a.cwiseMin(b).array() - margin_px, high = a.cwiseMax(b).array() + margin_px;
    const auto tile = [](double v, int size) { return static_cast<int>(std::clamp(v, 0.0, size - 1.0)) / kTile; };
    if (high.x() < 0 || high.y() < 0 || low.x() >= width || low.y() >= height) return;
    for (int ty = tile(low.y(), height); ty <= tile(high.y(), height); ++ty) {
      for (int tx = tile(low.x(), width); tx <= tile(high.x(), width); ++tx) {
        arrow_tiles[static_cast<std::size_t>(ty) * static_cast<std::size_t>(tiles_x()) + static_cast<std::size_t>(tx)] =
            1;
      }
    }
  }

  void blend_arrows_row(int y, Image& out) {
    Rays rays;
    for (int x = 0; x < width; x += 2) {
      if (arrow_tiles[static_cast<std::size_t>(y / kTile) * static_cast<std::size_t>(tiles_x()) +
                      static_cast<std::size_t>(x / kTile)] == 0)
        continue;
      for (int i = 0; i < kLanes; ++i) {
        const auto& sample = kSamples[static_cast<std::size_t>(i % 4)];
        aim(rays, i, static_cast<float>(x + i / 4) + sample[0], static_cast<float>(y) + sample[1]);
      }
      intersect(rays, arrows);
      for (int pixel = 0; pixel < 2 && x + pixel < width; ++pixel) {
        Vec3f sum = Vec3f::Zero();
        float cover = 0;
        for (int i = 4 * pixel; i < 4 * pixel + 4; ++i) {
          if (rays.hits.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
          const Vec3f& view = rays.directions[static_cast<std::size_t>(i)];
          Vec3f N = normal(rays, i).normalized();
          if (N.dot(view) > 0) N = -N;
          const float alpha = 0.25f * (rays.hits.ray.tfar[i] < at(x + pixel, y).t ? 1.0f : kHiddenArrow);
          sum += alpha * shade(arrow_colors[rays.hits.hit.primID[i] / 2], N, view, true);
          cover += alpha;
        }
        if (cover == 0) continue;
        const Color under = out.at(x + pixel, y);
        const Vec3f below(to_linear(under[0]), to_linear(under[1]), to_linear(under[2]));
        put(out, x + pixel, y, sum + (1 - cover) * below);
      }
    }
  }

  template <class Row>
  void for_rows(int step, const Row& row) {
    const int count = (height + step - 1) / step;
    tbb::parallel_for(tbb::blocked_range<int>(0, count, 4), [&](const tbb::blocked_range<int>& range) {
      for (int i = range.begin(); i < range.end(); ++i) row(i * step);
    });
  }
};

RayTracer::RayTracer(const Mesh& obstacle_O, const Mesh& tool_M, int threads)
    : trees_(std::make_unique<Trees>(std::max(1, threads))) {
  Trees& t = *trees_;
  t.obstacle_box = box_of(obstacle_O);
  t.tool_box = box_of(tool_M);
  t.device = rtcNewDevice("start_threads=0,set_affinity=0");
  if (t.device == nullptr) throw SetupError("embree: no ray tracing device on this processor (SSE2 is needed)");
  t.arena.execute([&] {
    t.obstacle = build_body(t.device, obstacle_O);
    t.tool = build_body(t.device, tool_M);
    t.world = rtcNewScene(t.device);
    rtcSetSceneFlags(t.world, RTC_SCENE_FLAG_DYNAMIC);
    t.obstacle_instance = t.add_instance(t.obstacle, kObstacle);
    t.tool_instance = t.add_instance(t.tool, kTool);
    rtcJoinCommitScene(t.world);
  });
  if (rtcGetDeviceError(t.device) != RTC_ERROR_NONE)
    throw SetupError("embree: cannot build the trees of the bodies: out of memory?");
}

RayTracer::~RayTracer() = default;

void RayTracer::bounds(const Placement& placement, Vec3& centre_W, double& radius_m) const {
  Vec3 low = Vec3::Constant(kInfinity), high = Vec3::Constant(-kInfinity);
  const auto add = [&](const Pose& X, const Box& box) {
    if (box.low.x() > box.high.x()) return;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3f p((corner & 1) != 0 ? box.high.x() : box.low.x(), (corner & 2) != 0 ? box.high.y() : box.low.y(),
                    (corner & 4) != 0 ? box.high.z() : box.low.z());
      const Vec3 p_W = X * p.cast<double>();
      low = low.cwiseMin(p_W);
      high = high.cwiseMax(p_W);
    }
  };
  add(placement.X_WO, trees_->obstacle_box);
  add(placement.X_WM, trees_->tool_box);
  const bool empty = low.x() > high.x();
  centre_W = empty ? Vec3(Vec3::Zero()) : Vec3(0.5 * (low + high));
  radius_m = empty ? 1.0 : std::max(0.5 * (high - low).norm(), 1e-6);
}

void RayTracer::trace(const Camera& camera, const Placement& placement, Image& out) {
  Trees& t = *trees_;
  t.width = out.width;
  t.height = out.height;
  t.surfaces.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  const Pose X_WE = camera.X_WE();
  const Eigen::Matrix3f R_WE = X_WE.R().cast<float>();
  const auto half_height = static_cast<float>(std::tan(camera.fov_y_rad / 2));
  t.eye = X_WE.p.cast<float>();
  t.right = R_WE.col(0) * half_height * static_cast<float>(out.width) / static_cast<float>(out.height);
  t.up = R_WE.col(1) * half_height;
  t.forward = -R_WE.col(2);
  t.light = R_WE * kLight_E;
  t.fill = R_WE * kFill_E;
  t.shadow_offset = 2e-4f * static_cast<float>(camera.distance_m);
  t.R_W[kObstacle] = placement.X_WO.R().cast<float>();
  t.R_W[kTool] = placement.X_WM.R().cast<float>();
  t.arena.execute([&] {
    place(t.obstacle_instance, placement.X_WO);
    place(t.tool_instance, placement.X_WM);
    rtcJoinCommitScene(t.world);
    t.build_arrows(placement.arrows, camera);
    t.for_rows(2, [&](int y) { t.trace_rows(y, out); });
    t.for_rows(1, [&](int y) { t.smooth_row(y, out); });
    if (t.arrows != nullptr) t.for_rows(1, [&](int y) { t.blend_arrows_row(y, out); });
  });
}

}  // namespace tact::view
