#include "plugin/filter/filter.h"
#include "plugin/filter/moved_results.h"
#include "plugin/filter/operation_filter.h"
#include "plugin/filter/window_hooks.h"

#include <map>
#include <string>

namespace pcm::host {

// In the files of their names.
Filter open_address();
Filter set_clip_box();

namespace {

// What else of the window some operations use.
const std::map<std::string, OperationHooks>& hooks()
{
    static const std::map<std::string, OperationHooks> table{
        {"merge", shown_as_merged()},          {"transform", shown_as_moved()},
        {"align", shown_as_moved()},           {"select", on_selection()},
        {"save_selected", on_selection()},     {"extract_selected", on_selection()},
        {"classify_selected", on_selection()}, {"delete_selected", on_selection()},
        {"measure", at_points_of_layer()},     {"fit", fitting_primitives()},
        {"detect", finding_primitives()},      {"primitives", exporting_primitives()},
    };
    return table;
}

}  // namespace

const std::vector<Filter>& filters()
{
    static const std::vector<Filter> table = [] {
        std::vector<Filter> filters;
        for (const ops::Row& row : ops::operations()) {
            if (!row.title) continue;
            const auto used = hooks().find(row.name);
            filters.push_back(operation_filter(row, used == hooks().end() ? OperationHooks{} : used->second));
        }
        filters.push_back(open_address());
        filters.push_back(set_clip_box());
        return filters;
    }();
    return table;
}

}  // namespace pcm::host
