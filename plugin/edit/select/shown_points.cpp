#include "plugin/edit/select/shown_points.h"

#include "pcm/cloud/selection.h"
#include "pcm/system/error.h"
#include "plugin/host/scene_state.h"

#include <meshlab/glarea.h>

#include <QRegularExpression>

namespace pcm::host {

namespace {

// The settings of the render plugin (render/colour_settings.h).
const char* const conditions = "MeshLab::PointCloud::Conditions";
const char* const hidden_classes = "MeshLab::PointCloud::HiddenClasses";

void add_condition(Query& query, const QString& text, const Schema& schema)
{
    try {
        Selection one;
        one.where = {parse_condition(text.toStdString())};
        const Selector test(one, schema);
        query.where.push_back(one.where.front());
    } catch (const Error&) {  // has no effect on the picture either, which says so
    }
}

}  // namespace

Query shown_points(GLArea& view, const MeshModel& layer)
{
    Query query;
    const auto tree = Registry::instance().drawn(layer);
    if (!tree) return query;
    if (const auto clip = clip_of(layer)) query.clips.push_back(*clip);
    const RichParameterList* settings = view.glas.currentGlobalParamSet;
    if (!settings || !settings->hasParameter(conditions)) return query;
    const Schema& schema = tree->cloud->info().schema;
    for (const QString& text : settings->getString(conditions).split(';', Qt::SkipEmptyParts))
        if (!text.trimmed().isEmpty()) add_condition(query, text.trimmed(), schema);
    QStringList classes;
    for (const QString& word :
         settings->getString(hidden_classes).split(QRegularExpression("[,;\\s]+"), Qt::SkipEmptyParts)) {
        bool is_number = false;
        if (const unsigned number = word.toUInt(&is_number); is_number && number < 256)
            classes << QString::number(number);
    }
    if (!classes.empty()) add_condition(query, "classification!=" + classes.join(','), schema);
    return query;
}

std::vector<MeshModel*> shown_layers(GLArea& view)
{
    std::vector<MeshModel*> layers;
    for (MeshModel* layer : view.md()->meshList)
        if (layer && view.meshVisibilityMap.value(layer->id(), true) && Registry::instance().drawn(*layer))
            layers.push_back(layer);
    return layers;
}

}  // namespace pcm::host
