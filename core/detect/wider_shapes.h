// Larger thresholds for surfaces that are rougher than the cloud's noise.
#pragma once

#include "pcm/detect/assign_points.h"

#include <vector>

namespace pcm {

// A sample of the cloud, and the boxes that hold it.
struct WidenSample {
    AssignOptions assign;
    std::vector<Box3i> units;
};

struct WidenOptions {
    WidenSample fine;    // still coarser than that of the search
    WidenSample coarse;  // shows which surfaces continue beyond the widest threshold
    MergeOptions merge;
};

// Noise varies over a cloud: it grows with the distance from the scanner, and parts of one floor may lie in layers. The
// threshold cuts pieces out of such surfaces, as it does out of ground. A piece's threshold is doubled up to
// three times: where that shows the whole surface, to where it ends, the wider shape replaces the pieces that it
// explains, and parts of it that were even; ground continues beyond any threshold, and its pieces are not changed: a
// coarse sample shows which do at the widest one, and these are not tried in between. A trial reads
// the points near its shapes alone (vicinities): on a plant that is a tenth of the time. The result does not depend on
// threads. Throws what assign_points() throws.
std::vector<Hypothesis> with_wider_shapes(const ChosenPoints& points, std::vector<Hypothesis> all,
                                          const WidenOptions& options);

}  // namespace pcm
