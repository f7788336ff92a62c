#include "plugin/filter/filter.h"
#include "plugin/filter/operation_filter.h"
#include "plugin/filter/window_hooks.h"

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
Filter set_clip_box();

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
        operation_filter("select", on_selection()),
        operation_filter("save-selected", on_selection()),
        operation_filter("extract-selected", on_selection()),
        operation_filter("classify-selected", on_selection()),
        operation_filter("delete-selected", on_selection()),
        operation_filter("measure", at_points_of_layer()),
        operation_filter("profile"),
        operation_filter("volume"),
        operation_filter("fit", fitting_primitives()),
        operation_filter("detect", finding_primitives()),
        operation_filter("primitives", exporting_primitives()),
        set_clip_box(),
        tree_information(),
    };
    return table;
}

}  // namespace pcm::host
