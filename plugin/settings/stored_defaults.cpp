#include "plugin/settings/stored_defaults.h"

#include <QMap>
#include <QSettings>

namespace pcm::host {

namespace {

const char* const kept = "kept";

// The defaults of the versions that recorded none.
const QMap<QString, QString> first_defaults{{"Colour", "0"},         {"EyeDomeLighting", "0"}, {"RadiusScale", "1"},
                                            {"Samples", "0"},        {"SplatSize", "2"},       {"Splats", "0"},
                                            {"TargetSpacing", "1.4"}};

QString record_of(const QString& name) { return "PointCloud/defaults/" + name.section("::", -1); }

QString text_of(const QVariant& value)
{
    switch (value.userType()) {
        case QMetaType::Float:
            return QString::number(value.toDouble(), 'g', 6);
        case QMetaType::QColor:
            return value.value<QColor>().name(QColor::HexArgb);
        default:
            return value.toString();
    }
}

}  // namespace

void follow_new_defaults(const Parameters& defaults, SettingStore& settings)
{
    static bool done = false;
    if (done) return;
    done = true;
    QSettings records;
    for (const Parameter& setting : defaults) {
        const QString now = text_of(setting.value), record = record_of(setting.name);
        const QString before = records.value(record, first_defaults.value(setting.name.section("::", -1))).toString();
        if (before == kept) continue;
        const auto stored = settings.stored(setting.name);
        if (before != now && !before.isNull() && stored && text_of(*stored) == before) settings.forget(setting.name);
        records.setValue(record, now);
    }
}

void keep_stored(const QString& name) { QSettings().setValue(record_of(name), kept); }

}  // namespace pcm::host
