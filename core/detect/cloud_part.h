// A part of a cloud that is looked at by itself.
#pragma once

#include "pcm/cloud/geometry.h"

#include <utility>
#include <vector>

namespace pcm {

// The positions in some boxes, or all others. Any thread.
class CloudPart {
public:
    CloudPart() = default;  // the whole cloud
    explicit CloudPart(std::vector<Box3i> boxes) : boxes_(std::move(boxes)), is_others_(false) {}

    bool is_whole() const { return is_others_ && boxes_.empty(); }
    // What is not in this part.
    CloudPart others() const;
    // The same within a box: with no boxes but those that reach into it.
    CloudPart within(const Box3i& box) const;
    // Whether the box may have positions of the part.
    bool touches(const Box3i& box) const;
    bool contains(const Vec3i& q) const;

private:
    std::vector<Box3i> boxes_;
    bool is_others_ = true;  // the positions in none of the boxes
};

}  // namespace pcm
