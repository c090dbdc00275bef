#pragma once
#include <string>
#include <vector>

#include "contact/pipeline/contact_pipeline.hpp"
#include "contact/server/contact_snapshot.hpp"
#include "contact/server/loaded_scene.hpp"
#include "link/wire.hpp"

/// The contact server's own types to and from the wire.
namespace tact::contact {

/// Real-time safe.
ToolQuery from_wire(const wire::ToolPose& in) noexcept;
/// The part of the reply that the pipeline knows; echoes, epochs, hashes and times are the server's. Real-time safe.
void to_wire(const ContactResult& in, wire::ContactWrench& out) noexcept;

/// `items` is the memory the sequence of `out` points to: at least ContactSnapshot::kMax.
void to_wire(const ContactSnapshot& in, std::uint64_t server_epoch, const std::string& law,
             std::vector<wire::Contact>& items, wire::ContactSet& out);

/// What is loaded and the parameters in force. `parts` is the memory the sequence of `out` points to.
void to_wire(const LoadedScene& scene, const SceneSpec& spec, const PipelineParams& params, std::uint64_t server_epoch,
             std::vector<wire::LoadedPart>& parts, wire::SceneInfo& out);

/// tact::Fault bits of Status bits.
std::uint32_t faults_of(std::uint32_t status) noexcept;

}  // namespace tact::contact
