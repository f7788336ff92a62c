#include "plugin/scene/reached_text.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

#include <cmath>

namespace pcm::host {

namespace {

[[noreturn]] void refuse_reached(const std::string& what)
{
    throw Error(ErrorCode::bad_format, {}, "the points of primitives in the project: " + what);
}

QJsonObject clip(const std::string& region, bool outside)
{
    return {{"region", QString::fromStdString(region)}, {"outside", outside}};
}

QJsonObject object_of(const ReachedFrom& from)
{
    QJsonArray seeds, clips, where;
    for (const Vec3d& seed : from.seeds) seeds.append(QJsonArray{seed[0], seed[1], seed[2]});
    const Selection& limit = from.limit;
    if (limit.box) clips.append(clip(Region::box(*limit.box).text(), false));
    if (limit.region) clips.append(clip(limit.region->text(), false));
    for (const Clip& each : limit.clips) clips.append(clip(each.region.text(), each.outside));
    for (const Condition& condition : limit.where) where.append(QString::fromStdString(condition.text));
    return {{"shape", QString::fromStdString(pcm::text_of(from.shape))},
            {"threshold", from.threshold},
            {"normal_angle", from.normal_angle},
            {"turned_angle", from.turned_angle},
            {"turned_edge", from.turned_edge},
            {"step", from.step},
            {"seeds", seeds},
            {"clips", clips},
            {"where", where}};
}

double number(const QJsonObject& object, const char* name)
{
    const double value = object[name].toDouble(std::nan(""));
    if (!(value >= 0) || !std::isfinite(value)) refuse_reached(std::string(name) + " is not a number from 0 on");
    return value;
}

ReachedFrom reached_of(const QJsonObject& object)
{
    ReachedFrom from;
    from.shape = parse_shape(object["shape"].toString().toStdString());
    from.threshold = number(object, "threshold");
    from.normal_angle = number(object, "normal_angle");
    // Projects of earlier versions have none: surfaces were not compared.
    if (object.contains("turned_angle")) {
        from.turned_angle = number(object, "turned_angle");
        from.turned_edge = number(object, "turned_edge");
    }
    from.step = number(object, "step");
    for (const QJsonValue& value : object["seeds"].toArray()) {
        const QJsonArray numbers = value.toArray();
        Vec3d seed{};
        for (int a = 0; a < 3; ++a) seed[std::size_t(a)] = numbers.at(a).toDouble(std::nan(""));
        if (numbers.size() != 3 || !is_finite(seed)) refuse_reached("a seed is not three numbers");
        from.seeds.push_back(seed);
    }
    for (const QJsonValue& value : object["clips"].toArray())
        from.limit.clips.push_back(
            {parse_region(value.toObject()["region"].toString().toStdString()), value.toObject()["outside"].toBool()});
    for (const QJsonValue& value : object["where"].toArray())
        from.limit.where.push_back(parse_condition(value.toString().toStdString()));
    return from;
}

}  // namespace

QString text_of(const std::map<std::string, ReachedFrom>& reached)
{
    QJsonArray list;
    for (const auto& [key, from] : reached) {
        QJsonObject object = object_of(from);
        object["of"] = QString::fromStdString(key);
        list.append(object);
    }
    return QJsonDocument(list).toJson(QJsonDocument::Compact);
}

std::map<std::string, ReachedFrom> reached_of(const QString& text)
{
    QJsonParseError parsed;
    const QJsonDocument document = QJsonDocument::fromJson(text.toUtf8(), &parsed);
    if (parsed.error != QJsonParseError::NoError) refuse_reached(parsed.errorString().toStdString());
    std::map<std::string, ReachedFrom> reached;
    for (const QJsonValue& value : document.array()) {
        const QString key = value.toObject()["of"].toString();
        if (key.isEmpty()) refuse_reached("an entry does not name its primitive");
        try {
            reached[key.toStdString()] = reached_of(value.toObject());
        } catch (const Error& error) {
            if (error.code() == ErrorCode::bad_format) throw;
            refuse_reached(error.what());
        }
    }
    return reached;
}

}  // namespace pcm::host
