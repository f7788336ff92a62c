#include "plugin/scene/free_path.h"

#include <QDir>
#include <QFileInfo>
#include <QRegularExpression>
#include <QString>

namespace pcm::host {

namespace fs = std::filesystem;

fs::path free_path(const fs::path& cloud, const std::string& ending)
{
    const std::string extension = fs::path(ending).extension().string();
    const std::string suffix = ending.substr(0, ending.size() - extension.size());
    QString base = QString::fromStdString(cloud.stem().string());
    base.remove(QRegularExpression(QRegularExpression::escape(QString::fromStdString(suffix)) + "(-\\d+)?$"));
    fs::path folder = cloud.parent_path();
    if (!QFileInfo(QString::fromStdString(folder.string())).isWritable()) folder = QDir::homePath().toStdString();
    const std::string name = base.toStdString() + suffix;
    std::error_code ignored;
    fs::path path = folder / (name + extension);
    for (int n = 2; fs::exists(fs::symlink_status(path, ignored)); ++n)
        path = folder / (name + "-" + std::to_string(n) + extension);
    return path;
}

}  // namespace pcm::host
