#include "plugin/meshlab/filter/filter_plugin.h"

#include "pcm/ops/operation.h"
#include "plugin/filter/cloud_menu.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/filter_paths.h"
#include "plugin/filter/proposed_output.h"
#include "plugin/filter/proposed_spacing.h"
#include "plugin/filter/server_script.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/filter/numbers.h"
#include "plugin/meshlab/rich_parameters.h"
#include "plugin/panels/cancelled.h"
#include "plugin/panels/field_buttons.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/text.h"

#include <utility>

using namespace pcm;
using namespace pcm::host;

namespace {

// Whether the view shows something of the document's layers, before a filter, and all of them after it.
bool fits_in_view(Box3m before, const Box3m& after)
{
    if (before.IsNull() || after.IsNull()) return after.IsNull();
    before.Offset(before.Diag() / 100);
    return before.IsIn(after.min) && before.IsIn(after.max);
}

// The tree of a locked layer is not changed in place.
void check_lock(const Parameters& parameters, Scene& scene)
{
    if (parameters.has("InPlace") && parameters.flag("InPlace") && parameters.has("Tree"))
        refuse_locked(scene, tree_of(parameters, scene));
}

unsigned class_of(unsigned menus)
{
    using F = PCM_FILTER_INTERFACE;
    static constexpr std::pair<unsigned, unsigned> table[] = {
        {ops::menu::points, F::PointSet}, {ops::menu::sampling, F::Sampling}, {ops::menu::layers, F::Layer},
        {ops::menu::measure, F::Measure}, {ops::menu::select, F::Selection},  {ops::menu::quality, F::Quality},
        {ops::menu::normals, F::Normal},  {ops::menu::clean, F::Cleaning},    {camera_menu, F::Camera},
    };
    unsigned bits = 0;
    for (const auto& [menu, filter_class] : table)
        if (menus & menu) bits |= filter_class;
    return bits;
}

const Filter& filter_of(int id) { return filters()[static_cast<std::size_t>(id)]; }

}  // namespace

PointCloudFilters::PointCloudFilters()
{
    refuse_second(PointCloudFilters::pluginName());
    for (int id = 0; id < static_cast<int>(filters().size()); ++id) {
        typeList.push_back(id);
        auto* action = new QAction(name_of(id), this);
        // MeshLab disables the entries of its other menus while there is no layer. Our filters need none.
        connect(action, &QAction::changed, action, [action] { action->setEnabled(true); });
        actionList.push_back(action);
    }
    add_cloud_menu();
}

QString PointCloudFilters::name_of(int filter) const { return filter_of(filter).name; }

QString PointCloudFilters::info_of(int filter) const { return filter_of(filter).info; }

int PointCloudFilters::number_of(PluginAction* action) const
{
    int number = 0;
    for (const QAction* other : actionList) {
        if (other == action) return number;
        ++number;
    }
    return ID(action);  // MeshLab's copy of it, found by its text
}

int PointCloudFilters::classes_of(PluginAction* action) const
{
    // Without a layer MeshLab offers only filters of the class MeshCreation, so every filter starts with it. MeshLab
    // also resets the view after such a filter. It makes its menus before any filter is applied; from then on the class
    // only decides about the view.
    const int menus = static_cast<int>(class_of(filter_of(number_of(action)).menus));
    return !applied_ || resets_view_ ? MeshCreation | menus : menus;
}

RichParameterList PointCloudFilters::parameters_for(PluginAction* action, const MeshDocument& document)
{
    dialog_without_layer_ = const_cast<MeshDocument&>(document).mm() == nullptr;
    const Filter& filter = filter_of(number_of(action));
    Scene& scene = scene_of(document);
    Parameters asked;
    filter.add_parameters(asked);
    if (filter.output) propose_output(asked, scene, filter.output);
    if (!is_server()) propose_spacing(asked, scene);
    add_field_buttons(asked, &scene);
    keep_those_of_script(filter.name, asked);
    RichParameterList parameters;
    add_to(parameters, asked);
    return parameters;
}

// When its dialog for a filter is closed, MeshLab restores the layer that was current when it was opened from a state
// that it has not saved. Without a layer it compares null with a pointer that was never set, and may crash. For what
// changes nothing known it restores nothing. It asks right after parameters_for(); later answers are about layers.
int PointCloudFilters::postCondition(PluginAction*) const
{
    return std::exchange(dialog_without_layer_, false) ? MeshModel::MM_UNKNOWN : MeshModel::MM_NONE;
}

PointCloudFilters::Values PointCloudFilters::run(PluginAction* action, MeshDocument& document,
                                                 const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    dialog_without_layer_ = false;
    applied_ = true;
    resets_view_ = false;
    const Filter& filter = filter_of(number_of(action));
    try {
        Values values;
        const auto report = [this](const std::string& line) { say(GLLogStream::FILTER, line); };
        const auto warn = [&](const std::string& line) {
            say(GLLogStream::WARNING, std::string(filter.name) + ": " + line);
        };
        const auto answer = [&](const ops::Json& json) { values = numbers_of(json); };
        const Box3m before = document.bbox();
        const Parameters given = parameters_of(parameters);
        Scene& scene = scene_of(document);
        check_lock(given, scene);
        filter.run({scene, given, callback, report, warn, answer});
        resets_view_ = !fits_in_view(before, document.bbox());
        renew_proposals();
        return values;
    } catch (...) {
        // Another exception would leave the document busy for ever. Windows show the text of this one, meshlabserver
        // prints only the log.
        if (const auto text = cancelled_text(filter.name)) {
            say(GLLogStream::FILTER, text->toStdString());
            say_cancelled(*text);
            throw Failure(*text);
        }
        const std::string error = current_error();
        say(GLLogStream::WARNING, std::string(filter.name) + ": " + error);
        throw Failure(QString::fromStdString(error));
    }
}
