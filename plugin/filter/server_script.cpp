#include "plugin/filter/server_script.h"

#include <QCoreApplication>
#include <QFile>
#include <QFileInfo>
#include <QSet>
#include <QXmlStreamReader>

#include <map>
#include <utility>

namespace pcm::host {

namespace {

using Names = QSet<QString>;

// The parameters of each run of each filter, in the order of the script.
std::map<QString, QList<Names>> filters_of(const QString& path)
{
    std::map<QString, QList<Names>> filters;
    if (path.isEmpty()) return filters;
    QFile file(path);
    if (!file.open(QIODevice::ReadOnly)) return filters;
    QXmlStreamReader xml(&file);
    QList<Names>* runs = nullptr;
    while (!xml.atEnd()) {
        if (xml.readNext() != QXmlStreamReader::StartElement) continue;
        const QString name = xml.attributes().value("name").toString();
        if (xml.name() == QLatin1String("filter")) {
            runs = &filters[name];
            runs->append(Names());
        } else if (xml.name() == QLatin1String("Param") && runs) {
            runs->last().insert(name);
        }
    }
    return filters;
}

QString script_of_process()
{
    if (!is_server()) return {};
    const QStringList words = QCoreApplication::arguments();
    const int at = words.indexOf("-s");
    return at >= 0 && at + 1 < words.size() ? words[at + 1] : QString();
}

}  // namespace

bool is_server()
{
    if (!QCoreApplication::instance()) return false;  // a program that uses MeshLab as a library
    const QStringList words = QCoreApplication::arguments();
    return !words.isEmpty() && QFileInfo(words.first()).baseName() == "meshlabserver";
}

void keep_those_of_script(const QString& name, Parameters& parameters)
{
    static const std::map<QString, QList<Names>> filters = filters_of(script_of_process());
    static std::map<QString, int> runs;
    const auto found = filters.find(name);
    const int run = runs[name]++;
    if (found == filters.end() || run >= found->second.size()) return;
    Parameters kept;
    for (const Parameter& parameter : parameters)
        if (found->second[run].contains(parameter.name)) kept.add(parameter);
    parameters = std::move(kept);
}

}  // namespace pcm::host
