#include "rt/alloc_guard.hpp"

namespace tact::rt {
namespace {
// Initial-exec: reading them from within malloc must not itself allocate.
[[gnu::tls_model("initial-exec")]] thread_local int depth = 0;
[[gnu::tls_model("initial-exec")]] thread_local std::uint64_t allocations = 0;
bool hooks_active = false;
}  // namespace

RtSection::RtSection() noexcept { ++depth; }
RtSection::~RtSection() { --depth; }

std::uint64_t rt_allocations() noexcept { return allocations; }
bool alloc_hooks_active() noexcept { return hooks_active; }

namespace detail {
void note_allocation() noexcept {
  if (depth > 0) ++allocations;
}
void set_alloc_hooks_active() noexcept { hooks_active = true; }
}  // namespace detail

}  // namespace tact::rt
