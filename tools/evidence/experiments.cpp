#include "evidence/experiments.hpp"

#include <iterator>

namespace tact::evidence {
namespace {

using bench::Effort;
using bench::Report;

void peers(const Effort& effort, Report& report) {
  report.say(
      "FCL answers whether triangles meet and how far apart two bodies are; where they overlap it knows no depth to "
      "push out along. It takes soup as it is, and thin parts exactly. OpenVDB's meshToVolume makes the same kind of "
      "field; "
      "its sign on soup is a flood fill's, and it has no points, no contacts and no forces. Neither scales stiffness.");
  bench::bench_contact(effort, report);
  bench::bench_sample(effort, report);
  bench::bench_bake(effort, report);
}

constexpr Experiment kExperiments[] = {
    {"fig-1-10", "Fig. 1 and 10: a starter motor into an engine bay",
     "A part is moved through a narrow passage among thin parts. Contacts, force, torque, depth and time of a tick, "
     "with "
     "and without a cap on the coupling's force, and with a cap that follows the stiffness.",
     fig_10},
    {"fig-2", "Fig. 2: a square peg on one face, and a round peg",
     "Many contacts of one direction add up to a stiffness that a time step of a millisecond cannot follow. How stiff "
     "may "
     "a single contact be before the tool swings, with and without scaling?",
     fig_2},
    {"fig-3", "Fig. 3: a cone in a gap",
     "The base of a cone slides on a floor with hundreds of contacts while its tip meets an edge with a few. A law "
     "that "
     "averages over all contacts ignores the tip.",
     fig_3},
    {"fig-4", "Fig. 4: a wedge",
     "Two contacts whose normals lean by an angle: how stiff is the box left-right and up-down? Filtering the "
     "eigenvalues "
     "of the stiffness matrix makes both equal, which is not how a wedge feels, and jumps near 0.",
     bench::bench_wedge},
    {"fig-6", "Fig. 6: where the time goes",
     "Traversal, law, gradient and solve, each timed alone, by number of contacts.", fig_6},
    {"fig-7", "Fig. 7: a box on two walls",
     "Two walls bear the same load, one through 70 times as many contacts. All normals are alike; only torques tell "
     "the "
     "walls apart.",
     fig_7},
    {"fig-8", "Fig. 8: the alpha puzzle",
     "Two linked loops come apart one way only. Does a hand that pulls straight get through the gap?", fig_8},
    {"fig-11", "Fig. 9 and 11: landing gear", "A hydraulic actuator pushed straight against wires two voxels thick.",
     fig_11},
    {"fig-12", "Fig. 12: clustering",
     "Contacts near each other are merged into one. How many are left, and is the wire still felt?",
     bench::bench_cluster},
    {"fig-13", "Fig. 13: impedance and pseudo-admittance",
     "The device gives a pose and takes a force, or the other way round: which bears the stiffer coupling?", fig_13},
    // fig-14, a deformable obstacle, has its place here.
    {"translation", "Translation only", "The same with the tool's rotation locked.", translation_only},
    {"closed-paths", "Net work round closed paths",
     "Forces that have an energy do no work round a closed path; others can pump the tool up.", bench::bench_work},
    {"paper-errors", "What [P] prints that is not so", "Formulas and claims put to numbers.", paper_errors},
    {"thin-parts", "What thin parts bear, by direction of force",
     "Obstacles two voxels thick, and the force at which a tool is pushed through them.", bench::bench_walls},
    {"gradient", "What the gradient foretells",
     "How well F + G dx predicts the next wrench, and what the change of weights does, by law.", bench::bench_gradient},
    {"accuracy", "Speed against error: field, points and law",
     "Coarser fields and fewer points, against the same law on the finest.", bench::bench_accuracy},
    {"rates", "Speed against error: rate and integrator", "Longer time steps, against the same run in short ones.",
     rates},
    {"judgement", "Laws at equal stability margin",
     "Each law at half the largest stiffness at which it is stable: what depth, force steps and balance does it give "
     "there?",
     bench::bench_judgement},
    {"stability", "Largest stable stiffness",
     "By law, coupling, device mode, rate, delay and hand: where does the tool begin to swing?",
     bench::bench_stability},
    {"assemblies", "Real assemblies",
     "Pegs in holes of known play, a bolt in its nut, a part of an engine drawn out and put back, scans pressed "
     "together: "
     "what is exact is beside what was found.",
     bench::bench_assemblies},
    {"peers", "Beside FCL and OpenVDB", "The same work in the same run.", peers},
};

}  // namespace

std::span<const Experiment> experiments() { return kExperiments; }

}  // namespace tact::evidence
