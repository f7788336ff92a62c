// Selected Points: Classify.
#include "pcm/cloud/las_class.h"
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
    parameters.addParam(RichInt("Value", 2, "Class",
                                "The number that the selected points get; of LAS classes 2 is ground, 5 high "
                                "vegetation, 6 building, 7 noise. Default 2."));
    parameters.addParam(RichString("Attribute", "classification", "Attribute",
                                   "The integer attribute that is set; made (u8) when absent. Default "
                                   "classification."));
    add_set_change_parameters(parameters);
}

void run(const FilterRun& run)
{
    const SelectedLayer selected = selected_layer(run.document);
    SetChangeOptions options = set_change_options_of(run.parameters);
    const std::string name = run.parameters.getString("Attribute").trimmed().toStdString();
    const int value = run.parameters.getInt("Value");
    Operation operation(run.callback);
    options.progress = operation.progress();
    const SetChangeReport report = classify_points(*selected.points, value, name, options);
    log_warnings(run, report.outcome.warnings);
    const std::string meaning = name == "classification" && value >= 0 && value < 256
                                    ? " (" + las_class_name(static_cast<unsigned>(value)) + ")"
                                    : std::string();
    run.log("The attribute '" + name + "' of " + grouped(selected.points->size()) + " points of " +
            report.tree.string() + " is " + std::to_string(value) + meaning + "; " +
            grouped(report.outcome.points_out) + " of them had another value.");
    show_result(run, selected.shown.cloud->tree()->folder(), options.target);
}

}  // namespace

Filter classify_selected()
{
    using F = MeshFilterInterface;
    return {"Selected Points: Classify",
            "Sets the class, or another integer attribute, of the selected points of a <b>point cloud tree</b>, in a "
            "copy of it or in place. Esc cancels it." +
                about_selections(),
            F::FilterClass(F::Selection | F::PointSet),
            add_parameters,
            run,
            "-classified.pct"};
}

}  // namespace pcm::host
