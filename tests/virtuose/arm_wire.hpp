#pragma once
#include <cstdint>

namespace tact::standin {

// What the stand-in library and the stand-in arm say to one another, in datagrams. Ours: the vendor's own protocol is
// not public.

inline constexpr std::uint32_t kMagic = 0x7ac7a24d;

enum class Order : std::int32_t {
  hello,
  bye,
  note,  ///< nothing but its name: the arm keeps the order of calls
  command_type,
  indexing,
  power,
  force,
  position,
  speed,
  attach,  ///< stiffness[6], damping[6], rotation first
  detach,
  saturate
};

struct Command {
  std::uint32_t magic = kMagic, session = 0;
  Order order = Order::note;
  std::int32_t number = 0;
  float values[12] = {};
  char call[40] = {};  ///< name of the call that sent it
};

enum class Link : std::int32_t { up, refused, cut };

struct State {
  std::uint32_t magic = kMagic, session = 0;
  Link link = Link::up;
  std::int32_t power = 0, dead_man = 0, chain = 0, shift = 0;
  std::uint32_t alarm = 0;
  float pose[7] = {}, twist[6] = {}, force[6] = {};
};

}  // namespace tact::standin
