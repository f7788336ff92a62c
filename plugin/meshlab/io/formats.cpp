#include "plugin/meshlab/io/formats.h"

#include "pcm/io/formats.h"
#include "pcm/tree/tree.h"

namespace pcm::host {

namespace {

std::vector<FileType> listed(bool (*wanted)(const Format&))
{
    std::vector<FileType> list;
    for (const Format& format : formats())
        for (const std::string_view extension : format.extensions) {
            if (extension.empty() || !wanted(format)) continue;
            const QString upper = QString::fromStdString(std::string(extension)).toUpper();
            const QString label = QString::fromStdString(std::string(format.label));
            list.push_back({upper + " " + label, upper});
        }
    return list;
}

}  // namespace

std::vector<FileType> import_formats()
{
    std::vector<FileType> list = listed([](const Format&) { return true; });
    list.insert(list.begin(), {"Point cloud tree", QString(tree_extension).toUpper()});
    return list;
}

std::vector<FileType> export_formats()
{
    return listed([](const Format& format) { return format.create != nullptr; });
}

}  // namespace pcm::host
