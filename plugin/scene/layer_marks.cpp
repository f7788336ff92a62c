#include "plugin/scene/layer_marks.h"

#include "pcm/system/error.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/layer_visibility.h"
#include "plugin/scene/project_parts.h"

#include <QFileInfo>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QTimer>

#include <vector>

namespace pcm::host {

namespace {

constexpr int look_again_ms = 50;

struct Marks {
    QString file;
    bool locked = false, solo = false, shown = true;  // shown: when no layer is shown alone
};

QString file_of(const SceneLayer& layer) { return QFileInfo(layer.file()).fileName(); }

[[noreturn]] void refuse_marks(const char* what)
{
    throw Error(ErrorCode::bad_format, {}, std::string("the marks of layers ") + what);
}

std::vector<Marks> parse(const QString& text)
{
    const QJsonDocument json = QJsonDocument::fromJson(text.toUtf8());
    if (!json.isObject()) refuse_marks("are not JSON");
    if (json.object()["version"].toInt() != 1) refuse_marks("have a version that is not 1");
    if (!json.object()["layers"].isArray()) refuse_marks("have no list 'layers'");
    std::vector<Marks> all;
    for (const QJsonValue& value : json.object()["layers"].toArray()) {
        const QJsonObject one = value.toObject();
        if (!one["file"].isString()) refuse_marks("have a layer without a 'file'");
        all.push_back(
            {one["file"].toString(), one["locked"].toBool(), one["solo"].toBool(), one["shown"].toBool(true)});
    }
    return all;
}

void apply(Scene& scene, const std::vector<Marks>& all)
{
    std::map<int, bool> shown;
    std::set<int> solo;
    std::vector<bool> used(all.size(), false);
    for (SceneLayer* layer : scene.layers()) {
        if (!layer) continue;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (used[i] || all[i].file != file_of(*layer)) continue;
            used[i] = true;
            if (all[i].locked) scene.part<LayerMatrices>().lock(*layer, true);
            if (all[i].solo) solo.insert(layer->id());
            shown[layer->id()] = all[i].shown;
            break;
        }
    }
    if (!solo.empty()) scene.part<SoloLayers>().restore(solo, shown);
}

void apply_when_open(Scene& scene, const std::vector<Marks>& all)
{
    if (!scene.is_busy()) return apply(scene, all);
    QTimer::singleShot(look_again_ms, &scene, [&scene, all] { apply_when_open(scene, all); });
}

}  // namespace

QString layer_marks(Scene& scene)
{
    const LayerMatrices& matrices = scene.part<LayerMatrices>();
    const SoloLayers& solo = scene.part<SoloLayers>();
    QJsonArray layers;
    bool any = false;
    for (const SceneLayer* layer : scene.layers()) {
        if (!layer) continue;
        QJsonObject one{{"file", file_of(*layer)}};
        if (matrices.is_locked(*layer)) one["locked"] = true;
        if (solo.is_solo(*layer)) one["solo"] = true;
        any = any || one.size() > 1;
        if (!solo.is_shown_otherwise(*layer)) one["shown"] = false;
        layers.push_back(one);
    }
    if (!any) return {};
    const QJsonObject all{{"version", 1}, {"layers", layers}};
    return QString::fromUtf8(QJsonDocument(all).toJson(QJsonDocument::Compact));
}

void take_layer_marks(Scene& scene, const QString& text)
{
    const std::vector<Marks> all = parse(text);
    QTimer::singleShot(0, &scene, [&scene, all] { apply_when_open(scene, all); });
}

void keep_layer_marks_in_projects() { add_project_part({"PointCloudLayers", layer_marks, take_layer_marks}); }

}  // namespace pcm::host
