#include "pcm/filter/voxel_lattice.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <string>

namespace pcm {

void check_voxels(const VoxelLattice& lattice, const Box3d& box, const Grid* grid)
{
    const auto refuse = [](const std::string& what, const std::string& hint) {
        throw Error(ErrorCode::invalid_argument, {}, what, hint);
    };
    if (!(lattice.size > 0) || !std::isfinite(lattice.size))
        refuse("the size of the voxels is " + exact(lattice.size) + "; it must be a positive number",
               "give the length of a voxel's edge in the cloud's unit");
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string axis(1, "xyz"[a]);
        if (!std::isfinite(lattice.anchor[a]))
            refuse("the " + axis + " coordinate of the voxels' anchor is not a finite number", "");
        if (grid && lattice.size < std::fabs(grid->scale[a]))
            refuse("the voxels are " + exact(lattice.size) + " wide, less than the step of the points' positions, " +
                       exact(std::fabs(grid->scale[a])) + " in " + axis,
                   "no two different positions would share a voxel: choose larger voxels");
        if (box.empty()) continue;
        const double far =
            std::max(std::fabs(box.min[a] - lattice.anchor[a]), std::fabs(box.max[a] - lattice.anchor[a]));
        if (!(far / lattice.size < 0x1p52))
            refuse("voxels of " + exact(lattice.size) + " are too small for coordinates that are " + brief(far) +
                       " away from the voxels' anchor in " + axis,
                   "choose voxels of at least " + brief(far * 0x1p-51) + ", or an anchor near the cloud");
    }
}

}  // namespace pcm
