#include "plugin/meshlab/2020/io/formats.h"

#include "pcm/io/formats.h"
#include "pcm/tree/tree.h"

namespace pcm::host {

namespace {

QList<MeshIOInterface::Format> listed(bool (*wanted)(const Format&))
{
    QList<MeshIOInterface::Format> list;
    for (const Format& format : formats())
        for (const std::string_view extension : format.extensions) {
            if (extension.empty() || !wanted(format)) continue;
            const QString upper = QString::fromStdString(std::string(extension)).toUpper();
            const QString label = QString::fromStdString(std::string(format.label));
            list << MeshIOInterface::Format(upper + " " + label, upper);
        }
    return list;
}

}  // namespace

QList<MeshIOInterface::Format> import_formats()
{
    QList<MeshIOInterface::Format> list = listed([](const Format&) { return true; });
    list.push_front(MeshIOInterface::Format("Point cloud tree", QString(tree_extension).toUpper()));
    return list;
}

QList<MeshIOInterface::Format> export_formats()
{
    return listed([](const Format& format) { return format.create != nullptr; });
}

}  // namespace pcm::host
