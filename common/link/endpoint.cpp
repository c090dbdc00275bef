#include "link/endpoint.hpp"

#include <dds/dds.h>
#include <dds/ddsc/dds_loan_api.h>

#include <algorithm>

#include "fault/fault.hpp"

namespace tact::detail {
namespace {

/// The one place of quality of service: both ends of a topic must agree, or shared memory is silently not used, or
/// worse, used by one end only. So no deadline, no manual liveliness, no KEEP_ALL anywhere.
dds_qos_t* make_qos(const wire::TopicInfo& info) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(10));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, info.depth);
  if (info.transient_local) {
    dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, info.depth, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED);
  } else {
    dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  }
  dds_qset_writer_data_lifecycle(qos, false);  // as ROS 2: the end of a writer disposes nothing
  return qos;
}

std::string topic_name(const Participant& participant, const wire::TopicInfo& info, const std::string& incarnation) {
  // Topic names know no '-', session names no '_'.
  std::string session = participant.session_name();
  std::replace(session.begin(), session.end(), '-', '_');
  if (info.channel == wire::Channel::haptic) return "tact/" + session + "/" + incarnation + "/" + info.name;
  return "rt/tact/" + session + "/" + info.name;
}

dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity < 0) {
    throw SetupError("DDS: cannot make the " + what + ": " + dds_strretcode(entity) +
                     "; look for iceoryx or Cyclone messages above");
  }
  return entity;
}

}  // namespace

Endpoint::Endpoint(const Participant& participant, const wire::TopicInfo& info, Role role,
                   const std::string& incarnation)
    : role_(role), info_(info) {
  TACT_CHECK(participant.kind() == info.channel);
  const std::string name = topic_name(participant, info, incarnation);
  dds_qos_t* qos = make_qos(info);
  topic_ = dds_create_topic(participant.entity(), static_cast<const dds_topic_descriptor_t*>(info.descriptor),
                            name.c_str(), qos, nullptr);
  if (topic_ > 0) {
    entity_ = role == Role::writer ? dds_create_writer(participant.entity(), topic_, qos, nullptr)
                                   : dds_create_reader(participant.entity(), topic_, qos, nullptr);
  }
  dds_delete_qos(qos);
  checked(topic_, "topic " + name);
  checked(entity_, (role == Role::writer ? "writer of " : "reader of ") + name);
  if (role == Role::reader) {
    scratch_.resize(static_cast<const dds_topic_descriptor_t*>(info.descriptor)->m_size);
    waitset_ = checked(dds_create_waitset(participant.entity()), "waitset of " + name);
    const dds_entity_t condition = checked(dds_create_readcondition(entity_, DDS_ANY_STATE), "condition of " + name);
    checked(dds_waitset_attach(waitset_, condition, 0), "waitset of " + name);
  }
}

Endpoint::~Endpoint() {
  if (waitset_ > 0) dds_delete(waitset_);
  if (entity_ > 0) dds_delete(entity_);
  if (topic_ > 0) dds_delete(topic_);
  if (!scratch_.empty()) wire::free_contents(scratch_.data(), info_);
}

bool Endpoint::write(const void* sample) noexcept { return dds_write(entity_, sample) == DDS_RETCODE_OK; }

bool Endpoint::take(void* sample) noexcept {
  void* scratch = scratch_.data();
  dds_sample_info_t info;
  while (dds_take(entity_, &scratch, &info, 1, 1) == 1) {
    if (!info.valid_data) continue;  // a writer ended: the sample is all zeros
    std::swap_ranges(scratch_.begin(), scratch_.end(), static_cast<std::byte*>(sample));
    return true;
  }
  return false;
}

bool Endpoint::wait(std::int64_t timeout_ns) noexcept { return dds_waitset_wait(waitset_, nullptr, 0, timeout_ns) > 0; }

int Endpoint::matched() const noexcept {
  if (role_ == Role::writer) {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(entity_, &status);
    return static_cast<int>(status.current_count);
  }
  dds_subscription_matched_status_t status{};
  dds_get_subscription_matched_status(entity_, &status);
  return static_cast<int>(status.current_count);
}

bool Endpoint::shared_memory_capable() const noexcept { return dds_is_shared_memory_available(entity_); }

void Endpoint::abandon() noexcept {
  note_endpoints_abandoned();
  waitset_ = entity_ = topic_ = 0;
}

}  // namespace tact::detail
