#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "geometry_msgs.h"
#include "haptic.h"
#include "tact_msgs.h"

/// The generated C types of idl/, under short names. Fields are documented in the .idl files.
namespace tact::wire {

using ToolPose = tact_haptic_ToolPose;
using ContactWrench = tact_haptic_ContactWrench;

using Contact = tact_msgs_msg_dds__Contact_;
using ContactSet = tact_msgs_msg_dds__ContactSet_;
using DeviceState = tact_msgs_msg_dds__DeviceState_;
using HandTarget = tact_msgs_msg_dds__HandTarget_;
using Parameter = tact_msgs_msg_dds__Parameter_;
using ParameterAck = tact_msgs_msg_dds__ParameterAck_;
using Phase = tact_msgs_msg_dds__Phase_;
using Health = tact_msgs_msg_dds__Health_;
using LoadedPart = tact_msgs_msg_dds__LoadedPart_;
using SceneInfo = tact_msgs_msg_dds__SceneInfo_;
using Histogram = tact_msgs_msg_dds__Histogram_;
using SessionStats = tact_msgs_msg_dds__SessionStats_;

inline constexpr std::uint32_t kSchema = tact_msgs_msg_dds__SCHEMA_VERSION;

inline constexpr Phase kStarting = tact_msgs_msg_dds__PHASE_STARTING;
inline constexpr Phase kLoading = tact_msgs_msg_dds__PHASE_LOADING;
inline constexpr Phase kConnecting = tact_msgs_msg_dds__PHASE_CONNECTING;
inline constexpr Phase kReady = tact_msgs_msg_dds__PHASE_READY;
inline constexpr Phase kActive = tact_msgs_msg_dds__PHASE_ACTIVE;
inline constexpr Phase kDegraded = tact_msgs_msg_dds__PHASE_DEGRADED;
inline constexpr Phase kStopping = tact_msgs_msg_dds__PHASE_STOPPING;

/// A whole message owned by C++: zeroed at first, its sequences freed at the end. Passes wherever a T& is wanted.
/// To publish a sequence from memory of your own set _buffer, _length, _maximum and leave _release false.
template <class T>
struct Message : T {
  Message() : T{} {}
  ~Message();
  Message(const Message&) = delete;
  Message& operator=(const Message&) = delete;
};

/// Name, type and quality of service of each topic: the table of idl/README.md, in code. Defined in topics.cpp.
enum class Channel { session, haptic };
struct TopicInfo {
  const char* name;        ///< "device_state"
  const void* descriptor;  ///< dds_topic_descriptor_t
  Channel channel;
  bool transient_local;  ///< late readers get the last sample
  int depth;             ///< KEEP_LAST of writer and reader
};
template <class T>
const TopicInfo& topic_info();

template <>
const TopicInfo& topic_info<ToolPose>();
template <>
const TopicInfo& topic_info<ContactWrench>();
template <>
const TopicInfo& topic_info<ContactSet>();
template <>
const TopicInfo& topic_info<DeviceState>();
template <>
const TopicInfo& topic_info<HandTarget>();
template <>
const TopicInfo& topic_info<Parameter>();
template <>
const TopicInfo& topic_info<ParameterAck>();
template <>
const TopicInfo& topic_info<Health>();
template <>
const TopicInfo& topic_info<SceneInfo>();
template <>
const TopicInfo& topic_info<SessionStats>();

/// Frees what the sequences of a message own.
void free_contents(void* message, const TopicInfo& info);

template <class T>
Message<T>::~Message() {
  free_contents(static_cast<T*>(this), topic_info<T>());
}

/// Copies text into a bounded string of the wire, cut to fit at a character border of UTF-8.
template <std::size_t N>
void set_text(char (&field)[N], std::string_view text) {
  std::size_t n = text.size() < N ? text.size() : N - 1;
  if (n < text.size()) {
    while (n > 0 && (static_cast<unsigned char>(text[n]) & 0xC0u) == 0x80u) --n;
  }
  text.copy(field, n);
  field[n] = '\0';
}

}  // namespace tact::wire
