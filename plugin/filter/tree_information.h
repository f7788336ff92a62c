// What a tree holds, in lines for the log.
#pragma once

#include "pcm/tree/tree.h"

#include <string>
#include <vector>

namespace pcm::host {

std::vector<std::string> tree_information(const Tree& tree);

}  // namespace pcm::host
