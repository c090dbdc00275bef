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

struct ShortOption {
  const char *option, *key, *help;
};
// Each stands for a key of a scene or machine file; --set takes all the others.
constexpr ShortOption kShortOptions[] = {
    {"--device", "device.driver", "simulated; playback and virtuose are reserved, not in this version"},
    {"--mode", "device.mode", "pseudo-admittance or impedance"},
    {"--law", "contact.law", "none, global, adaptive-3dof, adaptive-6dof or potential"},
    {"--stiffness", "contact.stiffness_n_per_m", "Contact stiffness k in N/m"},
    {"--saturation", "coupling.saturation", "on or off: cap the virtual coupling at F_max"},
    {"--rate", "device.rate_hz", "Ticks per second of the device loop"},
    {"--transport", "transport", "shm (shared memory) or udp (slower)"},
    {"--view", "view.enabled", "on or off: pictures and the browser page"},
    {"--port", "view.port", "TCP port of the browser page; 0: any free one"},
    {"--resolution", "obstacle.field_cells", "Cells of the distance field along the obstacle's longest side"},
    {"--points", "tool.points", "Points of the tool's pointshell"},
};

/// What the parser fills; CLI11 keeps references to it.
struct RunArguments {
  tact::cli::RunOptions options;
  std::string duration;
};

void add_session_options(CLI::App& command, RunArguments& arguments) {
  auto& o = arguments.options;
  command.add_option("SCENE", o.scene, "Name of a scene (see tact scenes) or path of a scene file");
  for (const ShortOption& s : kShortOptions) {
    command.add_option_function<std::string>(
        s.option,
        [&o, s](const std::string& value) {
          o.settings.push_back({s.option, s.key, value});
        },
        std::string(s.help) + "  [key " + s.key + "]");
  }
  command
      .add_option_function<std::vector<std::string>>(
          "--set",
          [&o](const std::vector<std::string>& values) {
            for (const auto& value : values) o.settings.push_back(tact::cli::parse_set(value));
          },
          "KEY=VALUE: any key of a scene or machine file, such as contact.p=8")
      ->allow_extra_args(false);
  command.add_option("--machine", o.machine_file,
                     "Machine file: device, rates, transport (default: /etc/tact/machine.toml if there)");
  command.add_option("--obstacle", o.obstacle,
                     "Your own mesh as the fixed body (OBJ, STL, PLY, glTF, DAE); needs --unit");
  command.add_option("--tool", o.tool, "Your own mesh as the held body; needs --unit");
  command.add_option("--unit", o.unit, "Unit of the numbers in your meshes: m, cm, mm or inch");
}

void add_run(CLI::App& app, RunArguments& arguments, std::function<void()> action) {
  auto* run = app.add_subcommand("run", "Run a session: contact server, coupling, view");
  auto& o = arguments.options;
  add_session_options(*run, arguments);
  run->add_option("--script", o.script, "Hand motion of the scene to play (see tact scenes)");
  run->add_option("--hand", o.hand,
                  "Your own hand motion: CSV time_s,x_m,y_m,z_m,qw,qx,qy,qz; its last pose is the goal");
  run->add_option("--session", o.session, "Name of the session (default: the scene's name and a random number)");
  run->add_option("--for", arguments.duration, "End by itself after this time in contact service: 20s, 2min");
  run->add_option("--report", o.report, "Write the session report as JSON, and its plot beside it");
  run->add_option("--plot", o.plot, "Where to draw the plot (PNG)");
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

  RunArguments run_arguments;
  add_run(app, run_arguments, [&] {
    auto& o = run_arguments.options;
    if (!run_arguments.duration.empty()) o.for_s = tact::cli::parse_duration_s("--for", run_arguments.duration);
    code = tact::cli::run(o);
  });

  RunArguments bake_arguments;
  auto* bake = app.add_subcommand("bake", "Bake a scene's distance field and pointshell now, and show the bake report");
  add_session_options(*bake, bake_arguments);
  bake->add_flag("--json", json, "The whole report as JSON");
  bake->footer(
      "Examples:\n  tact bake alpha\n  tact bake --obstacle housing.glb --tool pump.stl --unit mm --resolution 512");
  bake->callback([&] { code = tact::cli::bake(bake_arguments.options, json); });

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
