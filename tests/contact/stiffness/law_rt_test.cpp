#include <gtest/gtest.h>

#include "contact/contact_set.hpp"
#include "contact/response/assemble.hpp"
#include "contact/stiffness/law.hpp"
#include "rt/alloc_guard.hpp"

namespace tact::contact {
namespace {

TEST(Law, WeighingAndAssemblingNeverAllocate) {
  if (!rt::alloc_hooks_active()) GTEST_SKIP() << "allocation hooks are off in sanitizer builds";
  std::mt19937 rng(12);
  const test::ContactSet set = test::random_contacts(rng, 500, 20, 0.01);
  for (const std::string_view name : law_names()) {
    LawParams params;
    params.cluster_radius_m = 0.01;  // so that there are clusters
    const auto law = make_law(name, params, set.shell(), set.size());
    ContactBuffer b = set.buffer();
    const auto before = rt::rt_allocations();
    {
      const rt::RtSection section;
      law->weigh(b);
      assemble(b, *law, 1000, 1.0, {});
    }
    EXPECT_EQ(rt::rt_allocations(), before) << name;
  }
}

}  // namespace
}  // namespace tact::contact
