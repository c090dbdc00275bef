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
    {"--device", "device.driver", "simulated; playback and virtuose are reserved, not in this version"},
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
constexpr ShortOption kRunOptions[] = {
    {"--script", "run.script", "Hand motion of the scene to play (see tact scenes)"},
    {"--hand", "run.hand", "Your own hand motion: CSV time_s,x_m,y_m,z_m,qw,qx,qy,qz; its last pose is the goal"},
    {"--for", "run.for_s", "End by itself after this time in contact service: 20s, 2min"},
    {"--report", "run.report", "Write the session report as JSON, and its plot beside it"},
    {"--plot", "run.plot", "Where to draw the plot (PNG)"},
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
  command.add_option("--tool", o.tool, "Your own mesh as the held body; needs --unit");
  command.add_option("--unit", o.unit, "Unit of the numbers in your meshes: m, cm, mm or inch");
}

void add_run(CLI::App& app, tact::cli::RunOptions& o, std::function<void()> action) {
  auto* run = app.add_subcommand("run", "Run a session: contact server, coupling, view");
  add_session_options(*run, o);
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
  doctor->footer(
      "Exit status 0: sessions run here (warnings make them late or slow), 1: they do not.\nExample:\n  tact doctor");
  doctor->callback([&] { code = tact::cli::doctor(json); });

  auto* bench = app.add_subcommand("bench", "Measure speed and accuracy on this machine, beside FCL and OpenVDB");
  bench->set_help_flag();  // tact-bench has its own
  bench->prefix_command();
  bench->callback([&] { code = tact::cli::bench(bench->remaining()); });

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
