#include "link/participant.hpp"

#include <dds/dds.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <sstream>

#include "fault/fault.hpp"
#include "link/roudi.hpp"
#include "link/roudi_probe.hpp"
#include "rt/thread.hpp"

namespace tact {
namespace {

// Fixed, so that ROS 2 tools can be told (ROS_DOMAIN_ID); sessions are told apart by topic names and by the tag.
constexpr dds_domainid_t kSessionDomain = 71;
constexpr dds_domainid_t kHapticDomain = 72;

std::atomic<bool> abandoned{false};

std::string read_profile(wire::Channel kind, const Session& session) {
  const auto path = share_dir() / "dds" / (kind == wire::Channel::haptic ? "haptic.xml" : "session.xml");
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw SetupError(path.string() + ": cannot be read; reinstall Tact");
  std::string xml = text.str();
  const auto substitute = [&](const std::string& key, const std::string& value) {
    for (std::size_t at = xml.find(key); at != std::string::npos; at = xml.find(key, at)) {
      xml.replace(at, key.size(), value);
    }
  };
  substitute("@SESSION@", session.name);
  substitute("@SHARED_MEMORY@", session.machine.transport == "shm" ? "true" : "false");
  return xml;
}

}  // namespace

struct Participant::Domain {
  dds_entity_t entity;
  std::string xml;

  Domain(dds_domainid_t id, std::string text) : entity(dds_create_domain(id, text.c_str())), xml(std::move(text)) {
    if (entity < 0) {
      throw SetupError("DDS: domain " + std::to_string(id) + " cannot be made: " + dds_strretcode(entity) +
                       "; is the loopback interface up (ip link show lo)? Cyclone's messages are above");
    }
  }
  ~Domain() { dds_delete(entity); }

  /// The process's domain of this kind, made when nobody holds it.
  static std::shared_ptr<Domain> get(wire::Channel kind, const Session& session) {
    static std::mutex mutex;
    static std::weak_ptr<Domain> domains[2];
    const std::scoped_lock lock(mutex);
    auto& slot = domains[kind == wire::Channel::haptic ? 1 : 0];
    std::string xml = read_profile(kind, session);
    auto domain = slot.lock();
    if (!domain) {
      domain = std::make_shared<Domain>(kind == wire::Channel::haptic ? kHapticDomain : kSessionDomain, std::move(xml));
      slot = domain;
    } else if (domain->xml != xml) {
      throw SetupError("session " + session.name + ": this process already speaks for another session or transport");
    }
    return domain;
  }
};

Participant::Participant(wire::Channel kind, const Session& session, const Threads& threads)
    : kind_(kind), session_name_(session.name) {
  if (kind == wire::Channel::haptic && session.machine.transport == "shm") {
    require_roudi();
    join_roudi();
    roudi_instance_ = roudi_instance();
    // iceoryx keeps one connection a process, for ever: with a new RouDi it would abort().
    static const std::uint64_t first_known = roudi_instance_;
    if (roudi_instance_ != first_known) {
      throw SetupError("RouDi: it was replaced since this process first spoke to it; restart the process");
    }
  }
  std::string failure;
  const auto create = [&] {
    try {
      domain_ = Domain::get(kind, session);
      entity_ =
          dds_create_participant(kind == wire::Channel::haptic ? kHapticDomain : kSessionDomain, nullptr, nullptr);
      if (entity_ < 0) failure = std::string("DDS: no participant: ") + dds_strretcode(entity_);
    } catch (const SetupError& e) {
      failure = e.what();
    }
  };
  if (threads.priority > 0 || threads.cpu >= 0) {
    rt::Thread creator({.name = "tact-dds", .priority = threads.priority, .cpu = threads.cpu}, create);
    creator.join();
  } else {
    create();
  }
  if (!failure.empty()) throw SetupError(failure);
}

Participant::~Participant() {
  if (kind_ == wire::Channel::haptic && endpoints_abandoned()) {
    // Leaked on purpose; out of memory here ends the process, as it should.
    new std::shared_ptr<Domain>(std::move(domain_));  // NOLINT(bugprone-unhandled-exception-at-new)
    return;
  }
  dds_delete(entity_);
}

bool Participant::transport_intact() const {
  return roudi_instance_ == 0 ||
         (roudi_instance() == roudi_instance_ && probe_roudi(std::chrono::milliseconds{100}) == RoudiState::reachable);
}

bool endpoints_abandoned() noexcept { return abandoned.load(); }
void note_endpoints_abandoned() noexcept { abandoned.store(true); }

std::uint64_t process_epoch() {
  static const auto epoch = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
          .count());
  return epoch;
}

}  // namespace tact
