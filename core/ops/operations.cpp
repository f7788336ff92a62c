#include "pcm/ops/operation.h"

#include <algorithm>

namespace pcm::ops {

// Each is defined in the source of its name; those of selected points are in selected.cpp.
Row align_row();
Row append_row();
Row build_row();
Row classify_selected_row();
Row compact_row();
Row convert_row();
Row delete_row();
Row delete_selected_row();
Row detect_row();
Row extract_selected_row();
Row fit_row();
Row generate_row();
Row info_row();
Row measure_row();
Row merge_row();
Row normals_row();
Row outliers_row();
Row pick_row();
Row primitives_row();
Row profile_row();
Row query_row();
Row repair_row();
Row run_row();
Row save_selected_row();
Row select_row();
Row set_row();
Row subsample_row();
Row transform_row();
Row verify_row();
Row volume_row();
Row voxel_row();

const std::vector<Row>& operations()
{
    static const std::vector<Row> table{
        build_row(),
        convert_row(),
        run_row(),
        info_row(),
        verify_row(),
        append_row(),
        delete_row(),
        compact_row(),
        repair_row(),
        voxel_row(),
        subsample_row(),
        merge_row(),
        transform_row(),
        align_row(),
        radii_row(),
        normals_row(),
        outliers_row(),
        query_row(),
        pick_row(),
        set_row(),
        select_row(),
        save_selected_row(),
        extract_selected_row(),
        classify_selected_row(),
        delete_selected_row(),
        measure_row(),
        profile_row(),
        volume_row(),
        fit_row(),
        detect_row(),
        primitives_row(),
        render_row(),
        generate_row(),
    };
    return table;
}

const Row* find_operation(const std::string& name)
{
    const auto& rows = operations();
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.name == name; });
    return found == rows.end() ? nullptr : &*found;
}

}  // namespace pcm::ops
