#pragma once
#include <string>
#include <vector>

#include "view/model/view_scene.hpp"

namespace tact::view {

/// What the scene itself does not know.
struct ViewerNumbers {
  std::uint64_t holder = 0;
  std::size_t viewers = 0;
  double frames_per_s = 0, cpu_ms_per_frame = 0;
};

/// The numbers of the page, as JSON: newest wins. README.md has the table. Lengths in mm, as the names say.
std::string status_json(const ViewScene& scene, const ViewerNumbers& numbers);

/// Faults as sentences for a person.
std::vector<std::string> fault_words(std::uint32_t faults);

/// Events for what changed between two looks: services that came, went or changed phase, faults that began or ended.
/// These are never dropped, however fast the numbers go by.
std::vector<std::string> change_events(const ViewScene& before, const ViewScene& now);

}  // namespace tact::view
