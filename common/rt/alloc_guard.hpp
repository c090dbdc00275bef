#pragma once
#include <cstdint>

namespace tact::rt {

/// Marks what runs on this thread while it lives as real-time: calls of the malloc family (new, delete, malloc, free,
/// ... of any library) are counted. They are only seen by programs that link tact_rt_alloc_hooks, and never in
/// sanitizer builds. Nests. Costs two thread-local increments.
class RtSection {
 public:
  RtSection() noexcept;
  ~RtSection();
  RtSection(const RtSection&) = delete;
  RtSection& operator=(const RtSection&) = delete;
};

/// Calls of the malloc family seen in RT sections of this thread, ever.
std::uint64_t rt_allocations() noexcept;

/// True when such calls are seen at all in this program.
bool alloc_hooks_active() noexcept;

namespace detail {
/// For the hooks: one call was made on this thread.
void note_allocation() noexcept;
void set_alloc_hooks_active() noexcept;
}  // namespace detail

}  // namespace tact::rt
