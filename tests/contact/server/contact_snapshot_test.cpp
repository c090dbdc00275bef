#include "contact/server/contact_snapshot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "rt/alloc_guard.hpp"

namespace tact::contact {
namespace {

ContactBuffer random_contacts(std::size_t n, std::size_t capacity) {
  ContactBuffer contacts(capacity);
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> number(0.0, 1.0);
  contacts.size = n;
  for (std::size_t i = 0; i < n; ++i) {
    contacts.point_id[i] = static_cast<std::uint32_t>(i);
    contacts.depth_m[i] = number(rng);
    contacts.weight[i] = number(rng);
    contacts.r[i] = contacts.N[i] = contacts.g[i] = Vec3::Constant(number(rng));
    contacts.flags[i] = 0;
  }
  return contacts;
}

TEST(ContactSnapshot, FewContactsAreAllThereInOrder) {
  const auto contacts = random_contacts(100, 4096);
  const auto snapshot = std::make_unique<ContactSnapshot>();
  SnapshotTaker(4096).take(contacts, {}, *snapshot);
  ASSERT_EQ(snapshot->size, 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(snapshot->items[i].point_id, i);
    EXPECT_EQ(snapshot->items[i].depth_m, contacts.depth_m[i]);
  }
}

TEST(ContactSnapshot, TheHeaviestAreKeptHeaviestFirst) {
  constexpr std::size_t kCount = 3000;
  const auto contacts = random_contacts(kCount, 4096);
  std::vector<double> force;
  for (std::size_t i = 0; i < kCount; ++i) force.push_back(contacts.weight[i] * contacts.depth_m[i]);
  std::sort(force.rbegin(), force.rend());
  const auto snapshot = std::make_unique<ContactSnapshot>();
  SnapshotTaker(4096).take(contacts, {}, *snapshot);
  EXPECT_EQ(snapshot->total, kCount);
  ASSERT_EQ(snapshot->size, ContactSnapshot::kMax);
  for (std::size_t i = 0; i < ContactSnapshot::kMax; ++i) {
    EXPECT_EQ(snapshot->items[i].weight * snapshot->items[i].depth_m, force[i]);
  }
}

TEST(ContactSnapshot, TakingOneDoesNotAllocate) {
  if (!rt::alloc_hooks_active()) GTEST_SKIP() << "sanitizer build";
  const auto contacts = random_contacts(4096, 4096);
  const auto snapshot = std::make_unique<ContactSnapshot>();
  SnapshotTaker taker(4096);
  const std::uint64_t before = rt::rt_allocations();
  {
    const rt::RtSection section;
    taker.take(contacts, {}, *snapshot);
  }
  EXPECT_EQ(rt::rt_allocations(), before);
}

}  // namespace
}  // namespace tact::contact
