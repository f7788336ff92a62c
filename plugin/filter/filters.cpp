#include "plugin/filter/filter.h"
#include "plugin/filter/moved_results.h"
#include "plugin/filter/operation_filter.h"
#include "plugin/filter/window_hooks.h"

namespace pcm::host {

// Each is defined in the file of its name.
Filter set_clip_box();

const std::vector<Filter>& filters()
{
    static const std::vector<Filter> table{
        operation_filter("build"),
        operation_filter("append"),
        operation_filter("delete"),
        operation_filter("compact"),
        operation_filter("voxel"),
        operation_filter("subsample"),
        operation_filter("merge", shown_as_merged()),
        operation_filter("transform", shown_as_moved()),
        operation_filter("align", shown_as_moved()),
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
        operation_filter("info"),
    };
    return table;
}

}  // namespace pcm::host
