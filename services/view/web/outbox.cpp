#include "view/web/outbox.hpp"

namespace tact::view {

bool Outbox::push_event(Payload event) {
  if (events_.size() >= event_limit_) return false;
  events_.push_back(std::move(event));
  return true;
}

std::optional<Outbox::Item> Outbox::next() {
  if (!events_.empty()) {
    Item item{std::move(events_.front()), false};
    events_.pop_front();
    return item;
  }
  for (std::size_t i = 0; i < kSlots; ++i) {
    const std::size_t slot = (turn_ + i) % kSlots;
    if (!slots_[slot]) continue;
    turn_ = slot + 1;
    return Item{std::move(slots_[slot]), slot != static_cast<std::size_t>(Slot::status)};
  }
  return std::nullopt;
}

}  // namespace tact::view
