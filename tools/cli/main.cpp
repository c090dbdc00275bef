// tact: what users type. Starts and supervises the services of a session; shows scenes; bakes; looks at the machine.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>

#include "cli/commands.hpp"
#include "cli/run_options.hpp"
#include "fault/fault.hpp"

namespace {

constexpr int kUserError = 2;

/// Stands for a key of a scene or machine file; --set takes all the others.
struct ShortOption {
  const char *option, *key, *help;
};
constexpr ShortOption kSessionOptions[] = {
    {"--device", "device.driver", "simulated, virtuose, or playback (of --recording)"},
    {"--recording", "device.recording", "Playback: the recording whose hand is played"},
    {"--events", "device.events", "Simulated: CSV of faults and grips, time_s,event,duration_s"},
    {"--mode", "device.mode", "pseudo-admittance or impedance"},
    {"--law", "contact.law", "none, global, cluster, adaptive-3dof, adaptive-6dof or potential"},
    {"--stiffness", "contact.stiffness_n_per_m", "Contact stiffness k in N/m"},
    {"--saturation", "coupling.saturation", "on or off: cap the virtual coupling at F_max"},
    {"--rate", "device.rate_hz", "Ticks per second of the device loop"},
    {"--transport", "transport", "shm (shared memory) or udp (slower)"},
    {"--view", "view.enabled", "on or off: pictures and the browser page"},
    {"--port", "view.port", "TCP port of the browser page; 0: any free one"},
    {"--resolution", "obstacle.field_cells", "Cells of the distance field along the obstacle's longest side"},
    {"--points", "tool.points", "Points of the tool's pointshell"},
};
constexpr ShortOption kPlayOptions[] = {
    {"--script", "run.script", "Hand motion of the scene to play (see tact scenes)"},
    {"--hand", "run.hand", "Your own hand motion: CSV time_s,x_m,y_m,z_m,qw,qx,qy,qz; its last pose is the goal"},
    {"--report", "run.report", "Write the session report as JSON"},
};
constexpr ShortOption kRunOptions[] = {
    {"--for", "run.for_s", "End by itself after this time in contact service: 20s, 2min"},
    {"--plot", "run.plot", "Where to draw the plot (PNG; default: beside the report)"},
    {"--record", "run.record", "Write every tick of the device loop there, for tact replay, tact plot, playback"},
};

// trigger_on_parse: settings come in the order typed, for the last one said to hold.
void add_short_option(CLI::App& command, tact::cli::RunOptions& o, const ShortOption& s) {
  command
      .add_option_function<std::string>(
          s.option,
          [&o, s](const std::string& value) {
            o.settings.push_back({s.option, s.key, value});
          },
          std::string(s.help) + "  [key " + s.key + "]")
      ->trigger_on_parse();
}

/// CLI11 keeps references to `o`.
void add_session_options(CLI::App& command, tact::cli::RunOptions& o) {
  command.add_option("SCENE", o.scene, "Name of a scene (see tact scenes) or path of a scene file");
  for (const ShortOption& s : kSessionOptions) add_short_option(command, o, s);
  command
      .add_option_function<std::string>(
          "--set", [&o](const std::string& value) { o.settings.push_back(tact::cli::parse_set(value)); },
          "KEY=VALUE: any key of a scene or machine file, such as contact.p=8")
      ->trigger_on_parse();
  command.add_option("--machine", o.machine_file,
                     "Machine file: device, rates, transport (default: /etc/tact/machine.toml if there)");
  command.add_option("--obstacle", o.obstacle,
                     "Your own mesh as the fixed body (OBJ, STL, PLY, OFF, glTF, DAE); needs --unit");
  command.add_option(
      "--tool", o.tool,
      "Your own mesh as the held body; needs --unit. FILE#PART: that part of it, FILE#!PART: all others");
  command.add_option("--unit", o.unit, "Unit of the numbers in your meshes: m, cm, mm or inch");
}

void add_run(CLI::App& app, tact::cli::RunOptions& o, std::function<void()> action) {
  auto* run = app.add_subcommand("run", "Run a session: contact server, coupling, view");
  add_session_options(*run, o);
  for (const ShortOption& s : kPlayOptions) add_short_option(*run, o, s);
  for (const ShortOption& s : kRunOptions) add_short_option(*run, o, s);
  run->add_option("--session", o.session, "Name of the session (default: the scene's name and a random number)");
  run->add_option("--write-session", o.write_session, "Write the session file (for the systemd units) and do not run");
  run->footer(
      "Examples:\n"
      "  tact run alpha --script solve\n"
      "  tact run alpha --script cheat --law global --stiffness 500 --saturation off --view off --report cheat.json\n"
      "  tact run --obstacle housing.glb --tool pump.stl --unit mm --resolution 512\n"
      "  tact run alpha --hand my_motion.csv --mode impedance --for 30s\n"
      "A session ends by --for, by Ctrl-C, or, with --view off, a second after its script.");
  run->callback(std::move(action));
}

void add_latency(CLI::App& app, tact::cli::LatencyOptions& o, std::function<void()> action) {
  auto* latency = app.add_subcommand("latency", "What this machine can do: wake-up, round trips, the rate we advise");
  latency->add_option("--rate", o.rate_hz, "Measurements per second")->check(CLI::Range(10.0, 10000.0));
  latency->add_option("--for", o.seconds, "Seconds for each figure")->check(CLI::Range(0.1, 3600.0));
  latency->add_option("--cpu", o.cpu, "Pin the threads to this CPU (default: any)");
  latency->add_option("--compute-us", o.compute_us, "What contact and coupling take of a tick, for the advice")
      ->check(CLI::NonNegativeNumber);
  latency->add_flag("--against-cyclictest", o.against_cyclictest,
                    "Wake-up only, alternating with cyclictest (package rt-tests), five repeats");
  latency->add_flag("--json", o.json, "As JSON");
  latency->footer(
      "Beside each figure stands what it was measured under: what the system refuses is measured without.\n"
      "Exit status 0; 3: wake-up p99 is more than 1.5 times cyclictest's (other work on the machine makes it worse).\n"
      "Examples:\n  tact latency\n  tact latency --rate 4000 --for 60 --compute-us 120\n"
      "  tact latency --against-cyclictest --for 20");
  latency->callback(std::move(action));
}

int run_tact(int argc, char** argv) {
  CLI::App app{"Tact: distributed 6-DoF haptic rendering", "tact"};
  app.require_subcommand(1);
  app.get_formatter()->column_width(28);
  app.footer("Examples:\n  tact scenes\n  tact run alpha --script solve\n  tact doctor");
  int code = 0;
  bool json = false;

  tact::cli::RunOptions run_options;
  add_run(app, run_options, [&] { code = tact::cli::run(run_options); });

  tact::cli::RunOptions bake_options;
  auto* bake = app.add_subcommand("bake", "Bake a scene's distance field and pointshell now, and show the bake report");
  add_session_options(*bake, bake_options);
  bake->add_flag("--json", json, "The whole report as JSON");
  bake->footer(
      "Examples:\n  tact bake alpha\n  tact bake --obstacle housing.glb --tool pump.stl --unit mm --resolution 512");
  bake->callback([&] { code = tact::cli::bake(bake_options, json); });

  tact::cli::RunOptions experiment_options;
  tact::cli::ExperimentOptions experiment;
  auto* lockstep = app.add_subcommand(
      "experiment", "Play a script in one thread on a clock that counts ticks: the same numbers every time");
  add_session_options(*lockstep, experiment_options);
  for (const ShortOption& s : kPlayOptions) add_short_option(*lockstep, experiment_options, s);
  lockstep->add_option("--delay", experiment.delay_ticks, "Ticks every reply of the contact server comes late");
  lockstep->add_option("--replies", experiment.replies, "Which replies arrive, repeated: 110 loses every third");
  lockstep->add_option("--csv", experiment.csv, "Write every tick to this file");
  lockstep->add_flag("--json", json, "The session report as JSON");
  lockstep->footer(
      "Device, coupling loop and contact server are those of tact run; DDS, threads and real time are left out.\n"
      "Examples:\n"
      "  tact experiment cone --script insert --law adaptive-6dof --set contact.force_along=normal\n"
      "  tact experiment peg --script press --stiffness 200000 --delay 3 --csv peg.csv");
  lockstep->callback([&] {
    experiment.json = json;
    code = tact::cli::experiment(experiment_options, experiment);
  });

  auto* scenes = app.add_subcommand("scenes", "List the scenes that come with Tact, and their scripts");
  scenes->add_flag("--json", json, "As JSON");
  scenes->footer("Example:\n  tact scenes --json");
  scenes->callback([&] { code = tact::cli::scenes(json); });

  auto* status = app.add_subcommand("status", "Show the sessions that run, and how their services are");
  status->add_flag("--json", json, "As JSON");
  status->footer("Example:\n  tact status");
  status->callback([&] { code = tact::cli::status(json); });

  auto* doctor = app.add_subcommand("doctor", "Look at this machine: what is missing, and what to do");
  doctor->add_flag("--json", json, "As JSON");
  std::filesystem::path doctor_machine;
  doctor->add_option("--machine", doctor_machine, "Machine file (default: /etc/tact/machine.toml, if there)");
  doctor->footer(
      "Exit status 0: sessions run here (warnings make them late or slow), 1: they do not.\nExample:\n  tact doctor");
  doctor->callback([&] { code = tact::cli::doctor(doctor_machine, json); });

  std::filesystem::path recording, png, csv;
  double factor = 1;
  auto* replay = app.add_subcommand("replay", "Run the coupling once more on a recording, and compare what comes out");
  replay->add_option("FILE", recording, "A flight record, or what tact run --record wrote")->required();
  replay->add_option("--factor", factor, "On the tolerances: 1e-6 N, 1e-7 Nm, 1e-9 m, 1e-8 rad")
      ->check(CLI::PositiveNumber);
  replay->add_flag("--json", json, "As JSON");
  replay->footer(
      "The same program on the same machine repeats every bit.\n"
      "Exit status 0: the same, 1: it differs (says from where and by how much), 2: no recording.\n"
      "Example:\n  tact replay report-flight-1.tick");
  replay->callback([&] { code = tact::cli::replay(recording, factor, json); });

  auto* plot = app.add_subcommand("plot", "Draw a recording: forces, poses, depth, contacts, tick time");
  plot->add_option("FILE", recording, "A flight record, or what tact run --record wrote")->required();
  plot->add_option("-o,--png", png, "Where to draw (default: beside the recording, with --csv: nowhere)");
  plot->add_option("--csv", csv, "Write every tick as a row there");
  plot->footer("Examples:\n  tact plot report-flight-1.tick\n  tact plot session.tick --csv session.csv");
  plot->callback([&] { code = tact::cli::plot(recording, png, csv); });

  tact::cli::LatencyOptions latency_options;
  add_latency(app, latency_options, [&] { code = tact::cli::latency(latency_options); });

  // Programs of their own, with their own --help.
  const auto add_program = [&app](const char* name, const char* what) {
    auto* command = app.add_subcommand(name, what);
    command->set_help_flag();
    command->prefix_command();
    command->callback([=] { tact::cli::become("tact-" + std::string(name), command->remaining()); });
  };
  add_program("bench", "Measure speed and accuracy on this machine, beside FCL and OpenVDB");
  add_program("report", "Repeat the figures of the paper and write them as one page, with numbers and plots");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help
  } catch (const CLI::ParseError& e) {
    throw tact::SetupError(std::string(e.what()) + " (tact --help, tact COMMAND --help)");
  }
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return run_tact(argc, argv);
  } catch (const tact::SetupError& e) {
    std::fprintf(stderr, "tact: %s\n", e.what());
    return kUserError;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "tact: unexpected: %s\n", e.what());
    return 1;
  }
}
