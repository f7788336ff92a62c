// Selected Points: Save as Attribute.
#include "pcm/filter/set_changes.h"

#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/selected_points.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    parameters.addParam(RichString("Attribute", "selected", "Attribute",
                                   "Name of the attribute (u8) that becomes 1 for the selected points and 0 for all "
                                   "others; made when absent. Default selected."));
    parameters.addParam(
        RichBool("Overwrite", false, "Overwrite",
                 "Also write an attribute that this filter did not make, whose values are lost. Default "
                 "off: refused."));
    add_set_change_parameters(parameters);
}

void run(const FilterRun& run)
{
    const SelectedLayer selected = selected_layer(run.document);
    SetChangeOptions options = set_change_options_of(run.parameters);
    options.overwrite = run.parameters.getBool("Overwrite");
    const std::string name = run.parameters.getString("Attribute").trimmed().toStdString();
    Operation operation(run.callback);
    options.progress = operation.progress();
    const SetChangeReport report = save_as_attribute(*selected.points, name, options);
    log_warnings(run, report.outcome.warnings);
    run.log("The attribute '" + name + "' of " + report.tree.string() + " is 1 for " +
            grouped(selected.points->size()) + " of " + grouped(report.outcome.points_in) + " points; Where: " + name +
            "=1 selects them again.");
    show_result(run, selected.shown.cloud->tree()->folder(), options.target);
}

}  // namespace

Filter save_selected()
{
    using F = MeshFilterInterface;
    return {"Selected Points: Save as Attribute",
            "Writes which points are selected into an attribute of the <b>point cloud tree</b>, in a copy of it or in "
            "place. Esc cancels it." +
                about_selections(),
            F::FilterClass(F::Selection | F::PointSet),
            add_parameters,
            run,
            "-selected.pct"};
}

}  // namespace pcm::host
