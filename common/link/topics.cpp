#include <dds/dds.h>

#include "link/wire.hpp"

namespace tact::wire {

#define TACT_TOPIC(Type, c_type, name, channel, transient_local, depth)                          \
  template <>                                                                                    \
  const TopicInfo& topic_info<Type>() {                                                          \
    static const TopicInfo info{name, &c_type##_desc, Channel::channel, transient_local, depth}; \
    return info;                                                                                 \
  }

// Unkeyed topics with several writers share one history, so their depth holds a burst of all writers.
TACT_TOPIC(ToolPose, tact_haptic_ToolPose, "tool_pose", haptic, false, 1)
TACT_TOPIC(ContactWrench, tact_haptic_ContactWrench, "contact_wrench", haptic, false, 1)
TACT_TOPIC(ContactSet, tact_msgs_msg_dds__ContactSet_, "contact_set", session, false, 4)
TACT_TOPIC(DeviceState, tact_msgs_msg_dds__DeviceState_, "device_state", session, false, 16)
TACT_TOPIC(HandTarget, tact_msgs_msg_dds__HandTarget_, "hand_target", session, false, 16)
TACT_TOPIC(Parameter, tact_msgs_msg_dds__Parameter_, "parameter", session, false, 32)
TACT_TOPIC(ParameterAck, tact_msgs_msg_dds__ParameterAck_, "parameter_ack", session, false, 32)
TACT_TOPIC(Health, tact_msgs_msg_dds__Health_, "health", session, false, 32)
TACT_TOPIC(SceneInfo, tact_msgs_msg_dds__SceneInfo_, "scene_info", session, true, 1)
TACT_TOPIC(SessionStats, tact_msgs_msg_dds__SessionStats_, "session_stats", session, false, 4)
#undef TACT_TOPIC

void free_contents(void* message, const TopicInfo& info) {
  dds_sample_free(message, static_cast<const dds_topic_descriptor_t*>(info.descriptor), DDS_FREE_CONTENTS);
}

}  // namespace tact::wire
