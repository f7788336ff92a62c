#include "plugin/filter/filter.h"
#include "plugin/filter/moved_results.h"
#include "plugin/filter/operation_filter.h"

namespace pcm::host {

// Each is defined in the file of its name.
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
        operation_filter("info"),
    };
    return table;
}

}  // namespace pcm::host
