#pragma once
#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace tact::view {

/// What goes to browsers besides events; of each only the newest matters.
enum class Slot : std::uint8_t { status, picture, gauss_map, slice, strips };
constexpr std::size_t kSlots = 5;

using Payload = std::shared_ptr<const std::string>;

/// What waits for one client. Bounded whatever the client does: events queue up to a limit and are never dropped
/// (a client that cannot take them has to go), of each slot only the newest is kept.
class Outbox {
 public:
  explicit Outbox(std::size_t event_limit) : event_limit_(event_limit) {}

  /// False: the limit is reached.
  bool push_event(Payload event);
  void put(Slot slot, Payload newest) { slots_[static_cast<std::size_t>(slot)] = std::move(newest); }

  struct Item {
    Payload payload;
    bool binary;
  };
  /// Events first and in order, then the slots in turn, so that one busy slot does not starve the others.
  std::optional<Item> next();

 private:
  std::size_t event_limit_;
  std::deque<Payload> events_;
  std::array<Payload, kSlots> slots_;
  std::size_t turn_ = 0;
};

}  // namespace tact::view
