#include "plugin/meshlab/2020/render/sample_watch.h"

#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/layer.h"
#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/sample_change.h"
#include "plugin/meshlab/2020/sample_deletion.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/sample_region.h"
#include "plugin/scene/text.h"

#include <GL/glew.h>

#include <QApplication>
#include <QMessageBox>
#include <QPainter>
#include <QPushButton>
#include <QTimer>

#include <map>
#include <utility>

namespace pcm::host {

namespace {

constexpr int wait_ms = 100;

struct SampleEntry {
    LayerState seen;  // the last changed state that was looked at
    QString notice;
};

std::map<std::pair<const MeshDocument*, int>, SampleEntry>& watched()
{
    static auto* const layers = new std::map<std::pair<const MeshDocument*, int>, SampleEntry>;
    return *layers;
}

void log(MeshDocument& document, GLLogStream::Levels level, const std::string& line)
{
    document.Log.Log(level, line.c_str());
}

enum class Answer { remove, restore, leave };

Answer ask(QWidget* window, const MeshModel& layer, const TreeLayer& tree, const SampleChange& change,
           const SampleRegion& region)
{
    const std::string total = grouped(tree.cloud->info().points);
    QMessageBox box(QMessageBox::Question, "Point cloud",
                    "In the layer '" + layer.label() + "' " + QString::fromStdString(change.text) +
                        ". They are MeshLab's sample of the cloud, which still has all of its " +
                        QString::fromStdString(total) + " points.",
                    QMessageBox::NoButton, window);
    box.setInformativeText("They are the vertices in " + QString::fromStdString(region.words) + ". The cloud has " +
                           QString::fromStdString(points_in(tree, region.region)) +
                           " points there. Deleting them from " +
                           QString::fromStdString(tree.cloud->tree()->folder().string()) + " cannot be undone.");
    QPushButton* const remove = box.addButton("Delete the points of the cloud", QMessageBox::DestructiveRole);
    QPushButton* const restore = box.addButton("Restore the sample", QMessageBox::AcceptRole);
    QPushButton* const leave = box.addButton("Leave it", QMessageBox::RejectRole);
    box.setDefaultButton(restore);
    box.setEscapeButton(leave);
    box.exec();
    return box.clickedButton() == remove    ? Answer::remove
           : box.clickedButton() == restore ? Answer::restore
                                            : Answer::leave;
}

void settle_deletion(MeshModel& layer, const TreeLayer& tree, const SampleChange& change, const pcm::Camera& view)
{
    MeshDocument& document = *layer.parent;
    Matrix4d placement{};
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t r = 0; r < 4; ++r) placement[4 * c + r] = static_cast<double>(layer.cm.Tr[int(r)][int(c)]);
    const Matrix4d on_screen = product(view.projection, product(view.modelview, placement));
    const auto region =
        region_of(*tree.sample, change.deleted, tree.origin, on_screen, double(view.width) / std::max(view.height, 1));
    log(document, GLLogStream::WARNING, sample_warning(layer));
    const auto views = views_of(document);
    if (!region || views.empty()) return;
    QPointer<MeshDocument> alive(&document);
    const int mesh_id = layer.id();
    const Answer answer = ask(views.front()->window(), layer, tree, change, *region);
    MeshModel* const present = alive ? alive->getMesh(mesh_id) : nullptr;
    if (!present || answer == Answer::leave) return;
    if (answer == Answer::restore) {
        restore_sample(*present, *tree.sample);
        log(document, GLLogStream::FILTER,
            "The sample of the layer '" + present->label().toStdString() + "' is restored.");
        return;
    }
    Operation operation(nullptr);
    for (const std::string& line : delete_points_in(document, tree, region->region, operation))
        log(document, GLLogStream::FILTER, line);
}

void settle(MeshModel& layer, const pcm::Camera& view)
{
    const auto tree = Registry::instance().find(layer);
    if (!tree || !tree->sample) return;
    const SampleChange change = find_change(layer, *tree->sample);
    switch (change.kind) {
        case SampleChange::Kind::none:
            return;
        case SampleChange::Kind::moved:
            // MeshLab may freeze the same matrix once more before the next picture: that is another change.
            watched().erase({layer.parent, layer.id()});
            if (scene_of(*layer.parent).part<LayerMatrices>().is_locked(layer_of(layer))) {
                restore_sample(layer, *tree->sample);
                return log(
                    *layer.parent, GLLogStream::WARNING,
                    "The layer '" + layer.label().toStdString() +
                        "' is locked: the matrix that was frozen into MeshLab's sample is taken out of it again.");
            }
            unfreeze(layer, *tree->sample, change);
            log(*layer.parent, GLLogStream::FILTER,
                "The layer '" + layer.label().toStdString() +
                    "': the matrix that was frozen into MeshLab's sample is the layer's matrix again, so that all " +
                    grouped(tree->cloud->info().points) + " points of the cloud are moved by it.");
            return;
        case SampleChange::Kind::deleted:
            return settle_deletion(layer, *tree, change, view);
        case SampleChange::Kind::other:
            return log(*layer.parent, GLLogStream::WARNING, sample_warning(layer));
    }
}

// Not in the paint event, nor while a filter or a mouse drag is under way.
void settle_when_idle(MeshDocument* document, int mesh_id, const pcm::Camera& view)
{
    QPointer<MeshDocument> alive(document);
    QTimer::singleShot(document->isBusy() ? wait_ms : 0, &Registry::instance(), [alive, mesh_id, view] {
        MeshModel* const layer = alive ? alive->getMesh(mesh_id) : nullptr;
        if (!layer) return;
        if (alive->isBusy() || QApplication::mouseButtons() != Qt::NoButton || QApplication::activeModalWidget()) {
            QTimer::singleShot(wait_ms, &Registry::instance(), [alive, mesh_id, view] {
                if (alive) settle_when_idle(alive, mesh_id, view);
            });
            return;
        }
        try {
            settle(*layer, view);
        } catch (...) {
            log(*alive, GLLogStream::WARNING, "Point Cloud: " + current_error());
        }
        for (GLArea* area : views_of(*alive)) area->update();
    });
}

}  // namespace

void look_at_sample(MeshModel& layer, const pcm::Camera& view)
{
    scene_of(*layer.parent).part<LayerMatrices>().hold(layer_of(layer));
    const auto tree = Registry::instance().find(layer);
    const std::pair<const MeshDocument*, int> key(layer.parent, layer.id());
    const LayerState state = tree && tree->sample ? state_of(layer, Watched::sample) : LayerState();
    if (!tree || !tree->sample || state == tree->state) {
        watched().erase(key);
        return;
    }
    if (layer.parent->isBusy()) return;  // a filter is changing it
    SampleEntry& entry = watched()[key];
    if (entry.seen == state) return;
    entry.seen = state;
    const SampleChange change = find_change(layer, *tree->sample);
    entry.notice = change.kind == SampleChange::Kind::none || change.kind == SampleChange::Kind::moved
                       ? QString()
                       : QString::fromStdString("MeshLab's sample only: " + change.text +
                                                ".\nThe cloud still has its " + grouped(tree->cloud->info().points) +
                                                " points as they were.\nFile > Reload restores the sample.");
    settle_when_idle(layer.parent, layer.id(), view);
}

QString sample_notice(const MeshModel& layer)
{
    const auto found = watched().find({layer.parent, layer.id()});
    return found == watched().end() ? QString() : found->second.notice;
}

void draw_sample_notices(GLArea& area, QPainter& painter)
{
    QStringList notices;
    for (const MeshModel* layer : area.md()->meshList) {
        if (!layer || !area.meshVisibilityMap.value(layer->id()) || !Registry::instance().find(*layer)) continue;
        const QString notice = sample_notice(*layer);
        if (!notice.isEmpty()) notices << layer->label() + "\n" + notice;
    }
    area.setProperty("pcm_sample_notice", notices.join("\n"));
    if (notices.isEmpty()) return;
    const QString text = notices.join("\n\n");
    // As MeshLab's own labels: Qt sets the matrices.
    glPushAttrib(GL_ENABLE_BIT | GL_VIEWPORT_BIT);
    glDisable(GL_DEPTH_TEST);
    for (const GLenum matrix : {GL_PROJECTION, GL_MODELVIEW}) {
        glMatrixMode(matrix);
        glPushMatrix();
    }
    painter.endNativePainting();
    painter.save();
    QFont font = painter.font();
    font.setBold(true);
    font.setPixelSize(13);
    painter.setFont(font);
    const int margin = 8;
    QRect place = painter.fontMetrics().boundingRect(QRect(0, 0, std::max(200, area.width() / 2), area.height()),
                                                     Qt::AlignLeft | Qt::TextWordWrap, text);
    place.moveTopRight(QPoint(area.width() - 2 * margin, 2 * margin));
    painter.fillRect(place.adjusted(-margin, -margin, margin, margin), QColor(255, 255, 255, 225));
    painter.setPen(QColor(190, 0, 0));
    painter.drawText(place, Qt::AlignLeft | Qt::TextWordWrap, text);
    painter.restore();
    painter.beginNativePainting();
    for (const GLenum matrix : {GL_PROJECTION, GL_MODELVIEW}) {
        glMatrixMode(matrix);
        glPopMatrix();
    }
    glPopAttrib();
}

}  // namespace pcm::host
