#include "contact/model/contact.hpp"

namespace tact::contact {

ContactBuffer::ContactBuffer(std::size_t capacity)
    : point_id(capacity + kBeyond),
      r(capacity + kBeyond),
      N(capacity + kBeyond),
      g(capacity + kBeyond),
      depth_m(capacity + kBeyond),
      weight(capacity + kBeyond),
      flags(capacity + kBeyond) {}

}  // namespace tact::contact
