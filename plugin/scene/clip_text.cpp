#include "plugin/scene/clip_text.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/scene/clip_history.h"
#include "plugin/scene/project_parts.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

#include <cmath>

namespace pcm::host {

namespace {

const char* const element = "PointCloudClipBox";

[[noreturn]] void refuse(const std::string& what)
{
    throw Error(ErrorCode::bad_format, {}, std::string("the project's ") + element + ": " + what);
}

QJsonArray numbers(const Vec3d& v) { return {v[0], v[1], v[2]}; }

Vec3d vector_of(const QJsonValue& value, const std::string& name)
{
    const QJsonArray array = value.toArray();
    Vec3d v{};
    for (int a = 0; a < 3; ++a) v[std::size_t(a)] = array.at(a).toDouble(std::nan(""));
    if (array.size() != 3 || !is_finite(v)) refuse(name + " is not three numbers");
    return v;
}

}  // namespace

QString text_of(const ClipBox& box)
{
    const QJsonObject object{{"centre", numbers(box.centre)},
                             {"axes", QJsonArray{numbers(box.axes[0]), numbers(box.axes[1]), numbers(box.axes[2])}},
                             {"half", numbers(box.half)},
                             {"outside", box.outside},
                             {"enabled", box.enabled}};
    return QJsonDocument(object).toJson(QJsonDocument::Compact);
}

ClipBox clip_box_of(const QString& text)
{
    constexpr double rounding = 1e-9;
    QJsonParseError error;
    const QJsonObject object = QJsonDocument::fromJson(text.toUtf8(), &error).object();
    if (error.error != QJsonParseError::NoError) refuse(error.errorString().toStdString());
    ClipBox box;
    box.centre = vector_of(object["centre"], "centre");
    box.half = vector_of(object["half"], "half");
    const QJsonArray axes = object["axes"].toArray();
    for (int k = 0; k < 3; ++k) box.axes[std::size_t(k)] = vector_of(axes.at(k), "axes[" + std::to_string(k) + "]");
    for (std::size_t k = 0; k < 3; ++k) {
        if (!(box.half[k] > 0)) refuse("half has a number that is not above 0");
        if (!(std::fabs(length(box.axes[k]) - 1) < rounding &&
              std::fabs(dot(box.axes[k], box.axes[(k + 1) % 3])) < rounding))
            refuse("axes are not perpendicular and of length 1");
    }
    if (!object["outside"].isBool() || !object["enabled"].isBool()) refuse("outside or enabled is not true or false");
    box.outside = object["outside"].toBool();
    box.enabled = object["enabled"].toBool();
    return box;
}

void keep_clip_boxes_in_projects()
{
    static bool once = false;
    if (std::exchange(once, true)) return;
    add_project_part({element,
                      [](Scene& scene) {
                          const auto& box = scene.part<SceneState>().clip();
                          return box ? text_of(*box) : QString();
                      },
                      [](Scene& scene, const QString& text) {
                          const ClipBox box = clip_box_of(text);
                          scene.part<ClipHistory>().begin_with(box);
                      }});
}

}  // namespace pcm::host
