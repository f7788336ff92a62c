#include "pcm/ops/operation.h"

namespace pcm::ops {

// Each is defined in the source of its name.
Row normals_row();
Row outliers_row();
Row radii_row();

const std::vector<Row>& operations()
{
    static const std::vector<Row> table{
        radii_row(),
        normals_row(),
        outliers_row(),
    };
    return table;
}

}  // namespace pcm::ops
