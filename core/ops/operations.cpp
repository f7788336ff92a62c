#include "pcm/ops/operation.h"

namespace pcm::ops {

// Each is defined in the source of its name.
Row align_row();
Row append_row();
Row build_row();
Row compact_row();
Row convert_row();
Row delete_row();
Row generate_row();
Row info_row();
Row merge_row();
Row normals_row();
Row outliers_row();
Row radii_row();
Row repair_row();
Row subsample_row();
Row transform_row();
Row verify_row();
Row voxel_row();

const std::vector<Row>& operations()
{
    static const std::vector<Row> table{
        build_row(),  convert_row(), info_row(),  verify_row(),    append_row(),   compact_row(),
        delete_row(), repair_row(),  radii_row(), normals_row(),   outliers_row(), transform_row(),
        align_row(),  merge_row(),   voxel_row(), subsample_row(), generate_row(),
    };
    return table;
}

}  // namespace pcm::ops
