// The classes of LAS.
#pragma once

#include <string>

namespace pcm {

// The standard's meaning of a classification code, 0 to 255: "ground". Codes 8 and 12 have one in point formats 0 to 5
// only.
std::string las_class_name(unsigned code);
inline constexpr unsigned named_las_classes = 23;  // from 0: each has a name of its own

}  // namespace pcm
