// A part of space that alone is shown and read, or that is left out.
#pragma once

#include "pcm/cloud/region.h"

namespace pcm {

// Immutable; any number of threads. Both answers are exact where those of the region are.
struct Clip {
    Region region;
    bool outside = false;  // points in the region are left out; else all others are

    // Whether a point stays. A point that is not finite does not.
    bool holds(const Vec3d& p) const { return region.contains(p) != outside && is_finite(p); }
    // Whether points of the box stay: none, some, or all. Conservative like Region::relation().
    BoxRelation relation(const Box3d& box) const
    {
        const BoxRelation found = region.relation(box);
        if (!outside || found == BoxRelation::crosses || box.empty()) return found;
        return found == BoxRelation::inside ? BoxRelation::outside : BoxRelation::inside;
    }
};

// Whether points of the box stay that pass through all the clips.
template <class Clips>
BoxRelation relation_of(const Clips& clips, const Box3d& box)
{
    BoxRelation relation = BoxRelation::inside;
    for (const Clip& clip : clips) relation = both(relation, clip.relation(box));
    return relation;
}

}  // namespace pcm
