#include "plugin/filter/operation_filter.h"

#include "pcm/system/error.h"
#include "plugin/filter/operation_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"

#include <utility>

namespace pcm::host {

namespace {

MeshFilterInterface::FilterClass class_of(unsigned menus)
{
    using F = MeshFilterInterface;
    unsigned bits = F::MeshCreation;
    static constexpr std::pair<unsigned, unsigned> table[] = {
        {ops::menu::points, F::PointSet}, {ops::menu::sampling, F::Sampling}, {ops::menu::layers, F::Layer},
        {ops::menu::measure, F::Measure}, {ops::menu::select, F::Selection},  {ops::menu::quality, F::Quality},
        {ops::menu::normals, F::Normal},  {ops::menu::clean, F::Cleaning},
    };
    for (const auto& [menu, filter_class] : table)
        if (menus & menu) bits |= filter_class;
    return F::FilterClass(bits);
}

// Shows the tree that was made, or loads those again that show one changed in place.
void show(const FilterRun& run, const ops::Result& result)
{
    if (result.makes == ops::Makes::nothing || result.makes == ops::Makes::file) return;
    TargetChoice target;
    target.in_place = result.makes == ops::Makes::changed;
    if (!target.in_place) target.copy = result.output;
    show_result(run, result.input.empty() ? std::filesystem::path() : std::filesystem::path(result.input.front()),
                target);
}

void run_operation(const ops::Row& row, const OperationHooks& hooks, const FilterRun& run)
{
    const auto operation = row.make();
    set_arguments(operation->arguments(), run);
    Operation guard(run.callback);
    ops::Context context;
    context.face = ops::Face::dialog;
    context.progress = guard.progress();
    if (hooks.before) hooks.before(run, *operation);
    const ops::Result result = operation->run(context);
    log_warnings(run, result.outcome.warnings);
    log_notes(run, result.notes);
    for (const std::string& line : result.lines) run.log(line);
    if (hooks.after)
        hooks.after(run, *operation, result);
    else
        show(run, result);
}

}  // namespace

Filter operation_filter(const std::string& name, OperationHooks hooks)
{
    const ops::Row* const row = ops::find_operation(name);
    if (!row || !row->title) throw std::logic_error("there is no operation " + name + " with a title");
    return {row->title,
            QString(row->details) + " Esc cancels it.",
            class_of(row->menus),
            [row](RichParameterList& parameters) {
                const auto operation = row->make();
                add_parameters(operation->arguments(), parameters);
            },
            [row, hooks = std::move(hooks)](const FilterRun& run) { run_operation(*row, hooks, run); },
            row->ending};
}

}  // namespace pcm::host
