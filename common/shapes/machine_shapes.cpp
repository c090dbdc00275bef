#include "shapes/engine.hpp"
#include "shapes/landing_gear.hpp"
#include "shapes/shape.hpp"

namespace tact::shapes {
namespace {

constexpr const char* kEdge = "side of a triangle on round parts: finer is more triangles";

Shape engine_bay() {
  return {
      {"engine-bay",
       "An engine in its bay, 0.92 m long (x, gearbox to fan), z up; place of the starter at -y. Made of closed parts "
       "0.1 mm apart.",
       {{"passage_m", 0.08, 0.07, 0.1, "free width between the inlet pipes that the starter passes"},
        {"cable_m", 0.0027, 0.001, 0.006, "diameter of the thin cables"},
        {"edge_m", 0.00314, 0.001, 0.05, kEdge}}},
      {},
      [](const Values& v) {
        return EngineBay{v.at("passage_m"), v.at("cable_m"), v.at("edge_m")}.mesh();
      }};
}

Shape starter() {
  return {{"starter",
           "A starter motor: origin on its axis in the flange's face, x towards the pinion, z towards the solenoid.",
           {{"edge_m", 0.00175, 0.0005, 0.05, kEdge}}},
          {},
          [](const Values& v) { return Starter{v.at("edge_m")}.mesh(); }};
}

Shape landing_gear() {
  return {{"landing-gear",
           "A landing gear with four wheels, 2.87 m high (z), x along the bogie, z = 0 on the ground; place of the "
           "actuator "
           "at +x. Made of closed parts 0.1 mm apart.",
           {{"passage_m", 0.112, 0.108, 0.2, "free height between the two wires that the actuator passes"},
            {"wire_m", 0.0056, 0.002, 0.02, "diameter of the thin wires"},
            {"edge_m", 0.00335, 0.002, 0.1, kEdge}}},
          {},
          [](const Values& v) {
            return LandingGear{v.at("passage_m"), v.at("wire_m"), v.at("edge_m")}.mesh();
          }};
}

Shape actuator() {
  return {{"actuator",
           "A hydraulic actuator: origin in the upper pin, x towards the lower one, y along the pins.",
           {{"edge_m", 0.003, 0.001, 0.1, kEdge}}},
          {},
          [](const Values& v) { return Actuator{v.at("edge_m")}.mesh(); }};
}

}  // namespace

std::vector<Shape> machine_shapes() { return {actuator(), engine_bay(), landing_gear(), starter()}; }

}  // namespace tact::shapes
