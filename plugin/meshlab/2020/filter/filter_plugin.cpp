#include "plugin/meshlab/2020/filter/filter_plugin.h"

#include "pcm/ops/operation.h"
#include "plugin/filter/cloud_menu.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/filter_paths.h"
#include "plugin/filter/proposed_output.h"
#include "plugin/filter/server_script.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/rich_parameters.h"
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
    using F = MeshFilterInterface;
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
    for (int id = 0; id < static_cast<int>(filters().size()); ++id) {
        typeList << id;
        auto* action = new QAction(filterName(id), this);
        // MeshLab disables the entries of its other menus while there is no layer. Our filters need none.
        connect(action, &QAction::changed, action, [action] { action->setEnabled(true); });
        actionList << action;
    }
    add_cloud_menu();
}

QString PointCloudFilters::filterName(FilterIDType filter) const { return filter_of(filter).name; }

QString PointCloudFilters::filterInfo(FilterIDType filter) const { return filter_of(filter).info; }

MeshFilterInterface::FilterClass PointCloudFilters::getClass(QAction* action)
{
    // Without a layer MeshLab offers only filters of the class MeshCreation, so every filter starts with it. MeshLab
    // also resets the view after such a filter. It makes its menus before any filter is applied; from then on the class
    // only decides about the view.
    const unsigned menus = class_of(filter_of(ID(action)).menus);
    return FilterClass(!applied_ || resets_view_ ? MeshCreation | menus : menus);
}

void PointCloudFilters::initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters)
{
    dialog_without_layer_ = document.mm() == nullptr;
    const Filter& filter = filter_of(ID(action));
    Scene& scene = scene_of(document);
    Parameters asked;
    filter.add_parameters(asked);
    if (filter.output) propose_output(asked, scene, filter.output);
    add_field_buttons(asked, &scene);
    keep_those_of_script(filter.name, asked);
    add_to(parameters, asked);
}

// When its dialog for a filter is closed, MeshLab restores the layer that was current when it was opened from a state
// that it has not saved. Without a layer it compares null with a pointer that was never set, and may crash. For what
// changes nothing known it restores nothing. It asks right after initParameterSet(); later answers are about layers.
int PointCloudFilters::postCondition(QAction*) const
{
    return std::exchange(dialog_without_layer_, false) ? MeshModel::MM_UNKNOWN : MeshModel::MM_NONE;
}

bool PointCloudFilters::applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                                    vcg::CallBackPos* callback)
{
    errorMessage.clear();
    dialog_without_layer_ = false;
    applied_ = true;
    resets_view_ = false;
    const Filter& filter = filter_of(ID(action));
    try {
        const auto say = [this](const std::string& line) { Log(GLLogStream::FILTER, line); };
        const auto warn = [&](const std::string& line) {
            Log(GLLogStream::WARNING, std::string(filter.name) + ": " + line);
        };
        const Box3m before = document.bbox();
        const Parameters given = parameters_of(parameters);
        Scene& scene = scene_of(document);
        check_lock(given, scene);
        filter.run({scene, given, callback, say, warn});
        resets_view_ = !fits_in_view(before, document.bbox());
        renew_proposals();
        return true;
    } catch (...) {
        // An exception that leaves this function would leave the document busy for ever. Windows show errorMessage,
        // meshlabserver prints only the log.
        if (const auto text = cancelled_text(filter.name)) {
            errorMessage = *text;
            Log(GLLogStream::FILTER, text->toStdString());
            say_cancelled(*text);
            return false;
        }
        const std::string error = current_error();
        errorMessage = QString::fromStdString(error);
        Log(GLLogStream::WARNING, std::string(filter.name) + ": " + error);
        return false;
    }
}
