#include "contact/model/contact.hpp"

namespace tact::contact {

ContactBuffer::ContactBuffer(std::size_t capacity)
    : point_id(capacity), r(capacity), N(capacity), g(capacity), depth_m(capacity), weight(capacity), flags(capacity) {}

}  // namespace tact::contact
