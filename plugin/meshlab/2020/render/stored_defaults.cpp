#include "plugin/meshlab/2020/render/stored_defaults.h"

#include <QDomDocument>
#include <QMap>
#include <QSettings>

#include <memory>

namespace pcm::host {

namespace {

const char* const kept = "kept";

// The defaults of the versions that recorded none.
const QMap<QString, QString> first_defaults{{"Colour", "0"},         {"EyeDomeLighting", "0"}, {"RadiusScale", "1"},
                                            {"Samples", "0"},        {"SplatSize", "2"},       {"Splats", "0"},
                                            {"TargetSpacing", "1.4"}};

QString record_of(const QString& name) { return "PointCloud/defaults/" + name.section("::", -1); }

QString text_of(const Value& value)
{
    if (value.isFloat()) return QString::number(static_cast<double>(value.getFloat()), 'g', 6);
    if (value.isEnum()) return QString::number(value.getEnum());
    if (value.isBool()) return value.getBool() ? "true" : "false";
    if (value.isInt()) return QString::number(value.getInt());
    if (value.isColor()) return value.getColor().name(QColor::HexArgb);
    return value.isString() ? value.getString() : QString();
}

// The value that MeshLab has stored, as text; null if there is none.
QString stored_text(const QSettings& settings, const QString& name)
{
    QDomDocument document;
    RichParameter* read = nullptr;
    if (!document.setContent(settings.value(name).toString()) ||
        !RichParameterAdapter::create(document.firstChildElement(), &read))
        return {};
    const std::unique_ptr<RichParameter> setting(read);
    return text_of(setting->value());
}

}  // namespace

void follow_new_defaults(const RichParameterList& defaults)
{
    static bool done = false;
    if (done) return;
    done = true;
    QSettings settings;
    for (const RichParameter& setting : defaults) {
        const QString now = text_of(setting.value()), record = record_of(setting.name());
        const QString before =
            settings.value(record, first_defaults.value(setting.name().section("::", -1))).toString();
        if (before == kept) continue;
        if (before != now && !before.isNull() && stored_text(settings, setting.name()) == before)
            settings.remove(setting.name());
        settings.setValue(record, now);
    }
}

void keep_stored(const QString& name) { QSettings().setValue(record_of(name), kept); }

}  // namespace pcm::host
