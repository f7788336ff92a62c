#include "pcm/ops/operation.h"

namespace pcm::ops {

// Each is defined in the source of its name; those of selected points are in selected.cpp.
Row classify_selected_row();
Row delete_selected_row();
Row detect_row();
Row extract_selected_row();
Row fit_row();
Row measure_row();
Row normals_row();
Row outliers_row();
Row pick_row();
Row primitives_row();
Row profile_row();
Row query_row();
Row radii_row();
Row save_selected_row();
Row select_row();
Row set_row();
Row volume_row();

const std::vector<Row>& operations()
{
    static const std::vector<Row> table{
        query_row(),
        pick_row(),
        select_row(),
        save_selected_row(),
        extract_selected_row(),
        classify_selected_row(),
        delete_selected_row(),
        fit_row(),
        set_row(),
        radii_row(),
        normals_row(),
        outliers_row(),
        detect_row(),
        measure_row(),
        profile_row(),
        volume_row(),
        primitives_row(),
    };
    return table;
}

}  // namespace pcm::ops
