#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "contact/server/loaded_scene.hpp"
#include "contact/server/pose_server.hpp"
#include "link/health.hpp"

namespace tact::contact {

/// The contact server's place on the session domain, on a thread that is not real-time: publishes ContactSet (60 Hz at
/// most, only what is new) and SceneInfo (at start and at each change), takes the parameters of service "contact".
/// A parameter builds its law here and is in force from the next step on; it is acknowledged then.
class SessionLink {
 public:
  /// Publishes SceneInfo at once. All references must outlive it. `params` is what the pipeline was made with.
  SessionLink(const Session& session, const Participant& low, HealthReporter& health, const LoadedScene& loaded,
              ContactPipeline& pipeline, PoseServer& server, const PipelineParams& params);
  ~SessionLink() { stop(); }
  SessionLink(const SessionLink&) = delete;
  SessionLink& operator=(const SessionLink&) = delete;

  void start();
  void stop();

 private:
  void run();
  void publish_contacts();
  void publish_scene();
  void take_parameters();
  void change(const std::string& key, const std::string& value);

  HealthReporter& health_;
  const LoadedScene& loaded_;
  ContactPipeline& pipeline_;
  PoseServer& server_;
  SceneSpec scene_;  // with the parameters in force
  PipelineParams params_;
  Publisher<wire::ContactSet> sets_;
  Publisher<wire::SceneInfo> scenes_;
  Publisher<wire::ParameterAck> acks_;
  Subscriber<wire::Parameter> requests_;
  std::unique_ptr<ContactSnapshot> snapshot_;
  std::vector<wire::Contact> items_;
  std::vector<wire::LoadedPart> parts_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace tact::contact
