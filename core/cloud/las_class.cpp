#include "pcm/cloud/las_class.h"

#include <iterator>

namespace pcm {

std::string las_class_name(unsigned code)
{
    static constexpr const char* names[] = {"never classified",
                                            "unclassified",
                                            "ground",
                                            "low vegetation",
                                            "medium vegetation",
                                            "high vegetation",
                                            "building",
                                            "low point (noise)",
                                            "model key point",
                                            "water",
                                            "rail",
                                            "road surface",
                                            "overlap",
                                            "wire, guard (shield)",
                                            "wire, conductor (phase)",
                                            "transmission tower",
                                            "wire-structure connector",
                                            "bridge deck",
                                            "high noise",
                                            "overhead structure",
                                            "ignored ground",
                                            "snow",
                                            "temporal exclusion"};
    static_assert(std::size(names) == named_las_classes);
    if (code < std::size(names)) return names[code];
    return code < 64 ? "reserved" : "user defined";
}

}  // namespace pcm
