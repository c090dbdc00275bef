// The malloc family of glibc, counted: the dynamic linker prefers a program's own definitions, so calls made inside
// libraries are seen too. Sanitizers bring their own.
#ifndef TACT_SANITIZED
#include <cerrno>
#include <cstddef>

#include "rt/alloc_guard.hpp"

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): glibc names them
extern "C" {
void* __libc_malloc(std::size_t) noexcept;
void* __libc_calloc(std::size_t, std::size_t) noexcept;
void* __libc_realloc(void*, std::size_t) noexcept;
void* __libc_memalign(std::size_t, std::size_t) noexcept;
void __libc_free(void*) noexcept;
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

void* malloc(std::size_t size) noexcept {
  tact::rt::detail::note_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  tact::rt::detail::note_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) noexcept {
  tact::rt::detail::note_allocation();
  return __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  tact::rt::detail::note_allocation();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  tact::rt::detail::note_allocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
  tact::rt::detail::note_allocation();
  void* p = __libc_memalign(alignment, size);
  if (p == nullptr) return ENOMEM;
  *out = p;
  return 0;
}
void free(void* p) noexcept {
  if (p != nullptr) tact::rt::detail::note_allocation();
  __libc_free(p);
}
}  // extern "C"

namespace {
[[maybe_unused]] const bool kActive = (tact::rt::detail::set_alloc_hooks_active(), true);
}
#endif
