#include "plugin/filter/filter_plugin.h"

#include "plugin/filter/cloud_menu.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/server_script.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/field_buttons.h"
#include "plugin/meshlab/2020/proposed_output.h"
#include "plugin/panels/cancelled.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/text.h"

#include <utility>

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
void check_lock(const RichParameterList& parameters, MeshDocument& document)
{
    if (parameters.hasParameter("InPlace") && parameters.getBool("InPlace") && parameters.hasParameter("Tree"))
        refuse_locked(scene_of(document), tree_of(parameters, document));
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
    const FilterClass menus = filter_of(ID(action)).menus;
    if (!applied_) return FilterClass(MeshCreation | menus);
    return FilterClass(resets_view_ ? MeshCreation | menus : menus & ~MeshCreation);
}

void PointCloudFilters::initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters)
{
    dialog_without_layer_ = document.mm() == nullptr;
    const Filter& filter = filter_of(ID(action));
    filter.add_parameters(parameters);
    if (filter.output) propose_output(parameters, document, filter.output);
    add_field_buttons(parameters, &document);
    keep_those_of_script(filter.name, parameters);
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
        check_lock(parameters, document);
        filter.run({document, parameters, callback, say, warn});
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
