#pragma once
#include <string>

#include "view/render/image.hpp"

namespace tact::view {

/// One page for a file: title, scene picture, Gauss map and slice at its right, strips below, each with its caption.
/// The plots may be empty: their place stays blank; without strips the page ends above them.
Image compose_sheet(const std::string& title, const Image& picture, const Image& gauss_map, const Image& slice,
                    const Image& strips);

}  // namespace tact::view
