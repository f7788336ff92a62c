#include "io/io_plugin.h"

#include "host/layer.h"
#include "host/operation.h"
#include "host/text.h"
#include "io/tree_beside.h"

#include <wrap/io_trimesh/io_mask.h>

#include <QDir>
#include <QFileInfo>

using namespace pcm;
using namespace pcm::host;

namespace {

// A file of more points becomes a tree; one of fewer is an ordinary layer of MeshLab, for all its tools.
constexpr std::uint64_t most_points_in_layer = 1'000'000;

std::vector<std::string> open_tree(const std::filesystem::path& path, MeshModel& layer)
{
    return show_tree(layer, Registry::instance().open(path));
}

std::vector<std::string> open_las(const std::filesystem::path& path, MeshModel& layer, vcg::CallBackPos* callback)
{
    const auto reader = open_reader(path);
    Operation operation(callback);
    if (reader->info().points <= most_points_in_layer) return load_points(layer, *reader, operation.progress());
    std::vector<std::string> lines = ensure_tree_beside(path, reader->info(), operation.progress());
    for (std::string& line : open_tree(tree_path_beside(path), layer)) lines.push_back(std::move(line));
    return lines;
}

}  // namespace

QList<MeshIOInterface::Format> PointCloudIo::importFormats() const
{
    return {Format("Point cloud tree", "PCT"), Format("LAS point cloud", "LAS")};
}

void PointCloudIo::GetExportMaskCapability(QString&, int& capability, int& defaults) const
{
    capability = defaults = 0;
}

bool PointCloudIo::open(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
                        const RichParameterList&, vcg::CallBackPos* callback, QWidget*)
{
    errorMessage.clear();
    // MeshLab passes the bare name and has changed the working folder to the file's.
    const std::filesystem::path path = QDir::cleanPath(QFileInfo(file_name).absoluteFilePath()).toStdString();
    try {
        Operation::refuse_second();
        Registry::instance().detach(layer);
        layer.cm.Clear();
        const std::vector<std::string> lines =
            format.compare("LAS", Qt::CaseInsensitive) == 0 ? open_las(path, layer, callback) : open_tree(path, layer);
        for (const std::string& line : lines) Log(GLLogStream::FILTER, line);
        mask |= vcg::tri::io::Mask::IOM_VERTCOORD;
        if (layer.hasDataMask(MeshModel::MM_VERTCOLOR)) mask |= vcg::tri::io::Mask::IOM_VERTCOLOR;
        if (layer.hasDataMask(MeshModel::MM_VERTQUALITY)) mask |= vcg::tri::io::Mask::IOM_VERTQUALITY;
        return true;
    } catch (...) {
        std::string error = current_error();
        // Errors of the core name their path; the few that know none get it here.
        if (error.find(path.string()) == std::string::npos) error = path.string() + ": " + error;
        errorMessage = QString::fromStdString(error);
        Log(GLLogStream::WARNING, "Cannot open " + error);
        return false;
    }
}

bool PointCloudIo::save(const QString&, const QString&, MeshModel&, const int, const RichParameterList&,
                        vcg::CallBackPos*, QWidget*)
{
    errorMessage = "point clouds cannot be saved by this plugin";
    return false;
}
