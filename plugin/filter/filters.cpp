#include "plugin/filter/filter.h"
#include "plugin/filter/operation_filter.h"

namespace pcm::host {

// Each is defined in the file of its name.
Filter build_tree();
Filter append();
Filter delete_points();
Filter compact();
Filter voxel_grid_filter();
Filter subsample_filter();
Filter merge();
Filter transform();
Filter align();
Filter tree_information();
Filter measure_filter();
Filter profile_filter();
Filter cut_volume();
Filter select_points_filter();
Filter save_selected();
Filter extract_selected();
Filter classify_selected();
Filter delete_selected();
Filter set_clip_box();
Filter fit_primitive();
Filter detect_primitives_filter();
Filter export_primitives();

const std::vector<Filter>& filters()
{
    static const std::vector<Filter> table{
        build_tree(),
        append(),
        delete_points(),
        compact(),
        voxel_grid_filter(),
        subsample_filter(),
        merge(),
        transform(),
        align(),
        operation_filter("radii"),
        operation_filter("normals"),
        operation_filter("outliers"),
        select_points_filter(),
        save_selected(),
        extract_selected(),
        classify_selected(),
        delete_selected(),
        measure_filter(),
        profile_filter(),
        cut_volume(),
        fit_primitive(),
        detect_primitives_filter(),
        export_primitives(),
        set_clip_box(),
        tree_information(),
    };
    return table;
}

}  // namespace pcm::host
