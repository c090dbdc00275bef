#include "link/haptic_connector.hpp"

#include <future>
#include <thread>
#include <type_traits>

#include "fault/fault.hpp"

namespace tact {
namespace {

constexpr std::chrono::milliseconds kSurelyAlive{300};

template <class Ends>
constexpr bool kIsCoupling = std::is_same_v<Ends, CouplingEnds>;
template <class Ends>
constexpr const char* kPeerService = kIsCoupling<Ends> ? "contact" : "coupling";

std::string loading(const wire::Health& peer) {
  std::string text = peer.phase == wire::kLoading ? "loading" : "starting";
  if (peer.progress >= 0) text += ", " + std::to_string(static_cast<int>(100 * peer.progress)) + " %";
  return text;
}

}  // namespace

template <class Ends>
std::shared_ptr<Ends> HapticConnector<Ends>::poll() {
  monitor_.poll(20'000'000);
  const std::string name = kPeerService<Ends>;
  // Also the last words of a peer that refused us first.
  if (const auto heard = monitor_.latest(name);
      heard && heard->transport != transport_ && monitor_.silence(name) < std::chrono::seconds{1}) {
    throw SetupError("transport: found \"" + transport_ + "\" here and \"" + heard->transport + "\" in tact-" + name +
                     "; start both from one session file");
  }
  const auto peer = monitor_.alive(name);
  peer_ready_ = peer && peer->phase >= wire::kConnecting;
  if (!peer_ready_) {
    state_ = "waiting for tact-" + name + (peer ? " (" + loading(*peer) + ")" : "");
    return nullptr;
  }
  if (ends_ && peer_epoch_ != peer->epoch) drop();
  if (!ends_) {
    if (!haptic_.transport_intact()) {
      state_ = "RouDi is gone or was replaced: it and all shared-memory processes must be restarted together";
      return nullptr;
    }
    ends_ = make(peer->epoch);
    if (!ends_) return nullptr;
    publish();
  }
  state_ = "waiting for the endpoints of tact-" + name + " to match";
  if (!ends_->matched()) return nullptr;
  health_.update([&](wire::Health& h) { h.peer_epoch = peer_epoch_; });
  if (peer->peer_epoch != process_epoch()) return nullptr;
  if (transport_ == "shm" && !peer->shared_memory_capable) {
    throw SetupError("transport: the endpoints of tact-" + name +
                     " cannot use shared memory; see its log, or choose transport = \"udp\"");
  }
  return ends_;
}

template <class Ends>
bool HapticConnector<Ends>::peer_alive(std::chrono::milliseconds silence) {
  monitor_.poll();
  const auto peer = monitor_.alive(kPeerService<Ends>);
  return ends_ && peer && peer->epoch == peer_epoch_ && monitor_.silence(kPeerService<Ends>) < silence;
}

template <class Ends>
void HapticConnector<Ends>::drop(bool hung) {
  if (!ends_) return;
  const auto last = monitor_.latest(kPeerService<Ends>);
  const bool orderly =
      peer_alive(kSurelyAlive) || (last && last->epoch == peer_epoch_ && last->phase == wire::kStopping);
  if (hung || !orderly) ends_->abandon();
  ends_.reset();
  peer_epoch_ = 0;
  publish();
}

template <class Ends>
std::shared_ptr<Ends> HapticConnector<Ends>::make(std::uint64_t peer_epoch) {
  // iceoryx asks RouDi for each endpoint and waits for its answer: on a thread that can be left behind.
  const auto made = std::make_shared<std::promise<std::shared_ptr<Ends>>>();
  auto future = made->get_future();
  const std::uint64_t own = process_epoch();
  std::thread([made, &haptic = haptic_, own, peer_epoch] {
    try {
      made->set_value(kIsCoupling<Ends> ? std::make_shared<Ends>(haptic, own, peer_epoch)
                                        : std::make_shared<Ends>(haptic, peer_epoch, own));
    } catch (const SetupError&) {
      made->set_exception(std::current_exception());
    }
  }).detach();
  if (future.wait_for(std::chrono::seconds{3}) != std::future_status::ready) {
    note_endpoints_abandoned();
    state_ = "RouDi does not answer: it and all shared-memory processes must be restarted together";
    return nullptr;
  }
  auto ends = future.get();
  if (transport_ == "shm" && !ends->shared_memory_capable()) {
    throw SetupError(
        "transport: shared memory was asked for but Cyclone DDS would use the network; is its shared-memory support "
        "(iceoryx) installed? Or choose transport = \"udp\"");
  }
  peer_epoch_ = peer_epoch;
  return ends;
}

template <class Ends>
void HapticConnector<Ends>::publish() {
  health_.update([&](wire::Health& h) {
    h.shared_memory_capable = ends_ && ends_->shared_memory_capable();
    h.shared_memory_proven = false;
    h.peer_epoch = 0;
  });
}

template class HapticConnector<CouplingEnds>;
template class HapticConnector<ContactEnds>;

}  // namespace tact
