// What people write. The first byte is the kind: scene, machine and session files, hand motions, device events, and
// single keys as on the command line. Nothing but one clear SetupError may come out; what is accepted is saved and read
// back as the same, and its shapes are made. See README.md.
#include <algorithm>
#include <string_view>

#include "coupling/device/device_events.hpp"
#include "fault/fault.hpp"
#include "file/whole_file.hpp"
#include "fuzz/fuzz_target.hpp"
#include "session/session.hpp"
#include "shapes/shapes.hpp"

namespace tact::fuzz {
namespace {

/// Calls `read`, which must not refuse: what it reads is our own.
template <class Read>
auto must(const Read& read, const std::string& what) {
  try {
    return read();
  } catch (const SetupError& refused) {
    broken(what + " is refused: " + refused.what());
  }
}

void expect_same_back(const Session& session) {
  const auto first = scratch() / "first.toml", second = scratch() / "second.toml";
  save_session(session, first);
  const Session back = must([&] { return load_session(first); }, read_file(first));
  save_session(back, second);
  if (read_file(first) != read_file(second)) {
    broken("saved:\n" + read_file(first) + "\nread back and saved:\n" + read_file(second));
  }
}

/// A shape may be refused too, with one clear error; what it is made of is bounded.
void make_shape_of(const BodySpec& body) {
  if (body.shape.empty()) return;
  try {
    check_shape(body.shape, body.shape_params);
    const auto& all = all_shapes();
    const auto info = std::find_if(all.begin(), all.end(), [&](const ShapeInfo& s) { return s.name == body.shape; });
    const auto has_edge = [](const ShapeParam& p) { return p.name == "edge_m"; };
    if (std::any_of(info->params.begin(), info->params.end(), has_edge)) return;  // machines: seconds each
    for (const auto& v : make_shape(body.shape, body.shape_params).vertices) {
      if (!v.allFinite()) broken("shape " + body.shape + " has a vertex that is nowhere");
    }
  } catch (const SetupError& refused) {
    expect_clear(refused.what(), "shape");
  }
}

void use(const Session& session) {
  expect_same_back(session);
  make_shape_of(session.scene.obstacle);
  make_shape_of(session.scene.tool);
}

void load_keys(const std::string& text) {
  Session session;
  session.name = "fuzz";
  session.run_dir = scratch();
  session.scene.name = "fuzz";
  session.scene.obstacle.shape = session.scene.tool.shape = "box";
  std::size_t lines = 0;
  for (std::size_t at = 0, end = 0; at < text.size() && lines < 10; at = end + 1, ++lines) {
    end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    const std::size_t equals = std::min(line.find('='), line.size());
    try {
      set_key(session, line.substr(0, equals), equals < line.size() ? line.substr(equals + 1) : "");
    } catch (const SetupError& refused) {
      expect_clear(refused.what(), "");
    }
  }
  check_session(session);
  use(session);
}

/// Files that inputs may name.
void write_others() {
  write_whole(scratch() / "hand.csv", "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n");
  write_whole(scratch() / "part.stl", "solid\nendsolid\n");
}

void load(char kind, const std::filesystem::path& file, const std::string& text) {
  Session session;
  switch (kind) {
    case 's':
      load_scene(file, session);
      session.name = "fuzz";
      session.run_dir = scratch();
      check_session(session);
      use(session);
      break;
    case 'm':
      load_machine(file, session);
      break;
    case 'r':
      use(load_session(file));
      break;
    case 'h':
      load_hand_motion(file);
      break;
    case 'e':
      coupling::load_device_events(file);
      break;
    default:
      load_keys(text);
  }
}

}  // namespace

bool try_input(std::span<const std::uint8_t> input) {
  // scene, machine, running session, hand motion, device events, keys
  static constexpr char kKinds[] = {'s', 'm', 'r', 'h', 'e', 'k'};
  if (input.empty()) return false;
  const char* known = std::find(std::begin(kKinds), std::end(kKinds), static_cast<char>(input[0]));
  const char kind = known != std::end(kKinds) ? *known : kKinds[input[0] % std::size(kKinds)];
  const std::string text(reinterpret_cast<const char*>(input.data()) + 1, input.size() - 1);
  const auto file = scratch() / "input";
  static const bool once = (write_others(), true);
  static_cast<void>(once);
  write_whole(file, text);
  try {
    load(kind, file, text);
    return true;
  } catch (const SetupError& refused) {
    expect_clear(refused.what(), kind == 'k' ? "" : file.string() + ": ");
    return false;
  }
}

}  // namespace tact::fuzz
