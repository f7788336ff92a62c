#include "plugin/edit/align/write_moved.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "plugin/edit/align/align_session.h"
#include "plugin/host/moved_tree.h"
#include "plugin/host/operation.h"
#include "plugin/host/proposed_output.h"
#include "plugin/host/result_layer.h"

#include <cmath>

namespace pcm::host {

namespace {

// MeshLab's kind of callback has no place for an object.
std::function<void(const QString&)>& listener()
{
    static auto* const listener = new std::function<void(const QString&)>;
    return *listener;
}

bool report(const int percent, const char*)
{
    if (listener()) listener()(QString("Writing the moved tree: %1 %. Esc cancels it.").arg(percent));
    return true;
}

std::filesystem::path with_extension(const QString& file)
{
    std::filesystem::path path = file.toStdString();
    if (path.extension() != ".pct") path += ".pct";
    return path;
}

TreeLayer tree_of(const AlignSession& session)
{
    const MeshModel* layer = session.moving();
    const auto tree = layer ? Registry::instance().find(*layer) : std::nullopt;
    if (!tree)
        throw Error(ErrorCode::invalid_argument, {}, "the moving layer is no point cloud tree",
                    "build a tree of it, or use its matrix and export it");
    return *tree;
}

}  // namespace

QString proposed_tree(const AlignSession& session)
{
    return QString::fromStdString(free_path(tree_of(session).cloud->tree()->folder(), "-aligned.pct").string());
}

void write_moved_layer(AlignSession& session, const QString& file, const std::function<void(const QString&)>& say)
{
    if (!session.fit()) throw Error(ErrorCode::invalid_argument, {}, session.problem().toStdString());
    const Affine motion = session.fit()->motion;
    const TreeLayer tree = tree_of(session);
    const std::filesystem::path output = with_extension(file);
    MeshDocument& document = session.document();
    const int mesh_id = session.moving()->id();
    BuildReport written;
    {
        listener() = say;
        Operation operation(report);
        BuildOptions build;
        build.progress = operation.progress();
        try {
            written = write_moved_tree(tree.cloud->tree(), {motion}, output, build);
        } catch (...) {
            listener() = nullptr;
            throw;
        }
        listener() = nullptr;
    }
    for (const std::string& note : written.notes) document.Log.Log(GLLogStream::FILTER, note.c_str());
    document.Log.Log(GLLogStream::FILTER,
                     ("Wrote the moved tree " + output.string() + ": " + grouped(written.outcome.points_out) +
                      " points; largest position error " + exact(written.outcome.error) + " source units.")
                         .c_str());
    MeshModel* const former = document.getMesh(mesh_id);
    const TreeResult result{output, former ? std::vector<MeshModel*>{former} : std::vector<MeshModel*>(), false};
    for (const std::string& line : show_result(document, result)) document.Log.Log(GLLogStream::FILTER, line.c_str());
    say("The moved tree " + QString::fromStdString(output.filename().string()) +
        " is shown; the layer that it was made " + "from is hidden.");
}

}  // namespace pcm::host
