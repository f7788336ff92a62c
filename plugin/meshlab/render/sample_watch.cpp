#include "plugin/meshlab/render/sample_watch.h"

#include "pcm/cloud/matrix.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/sample_change.h"
#include "plugin/panels/sample_deletion.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/sample_region.h"
#include "plugin/scene/text.h"

#include <GL/glew.h>

#include <QApplication>
#include <QMessageBox>
#include <QPainter>
#include <QPointer>
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

using LayerKey = std::pair<const Scene*, int>;

LayerKey key_of(const SceneLayer& layer) { return {&layer.scene(), layer.id()}; }

std::map<LayerKey, SampleEntry>& watched()
{
    static auto* const layers = new std::map<LayerKey, SampleEntry>;
    return *layers;
}

void log(const SceneLayer& layer, LogLevel level, const std::string& line)
{
    layer.scene().log(level, QString::fromStdString(line));
}

enum class Answer { remove, restore, leave };

Answer ask(QWidget* window, const SceneLayer& layer, const TreeLayer& tree, const SampleChange& change,
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

void settle_deletion(SceneLayer& layer, const TreeLayer& tree, const SampleChange& change, const pcm::Camera& view)
{
    Scene& scene = layer.scene();
    Matrix4d placement{};
    const LayerMatrix rows = layer.matrix();
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t r = 0; r < 4; ++r) placement[4 * c + r] = static_cast<double>(rows[r][c]);
    const Matrix4d on_screen = product(view.projection, product(view.modelview, placement));
    const auto region =
        region_of(*tree.sample, change.deleted, tree.origin, on_screen, double(view.width) / std::max(view.height, 1));
    log(layer, LogLevel::warning, sample_warning(model_of(layer)));
    const auto views = scene.views();
    if (!region || views.empty()) return;
    const QPointer<Scene> alive(&scene);
    const int layer_id = layer.id();
    const Answer answer = ask(views.front()->widget().window(), layer, tree, change, *region);
    SceneLayer* const present = alive ? scene.layer(layer_id) : nullptr;
    if (!present || answer == Answer::leave) return;
    if (answer == Answer::restore) {
        restore_sample(model_of(*present), *tree.sample);
        log(*present, LogLevel::filter,
            "The sample of the layer '" + present->label().toStdString() + "' is restored.");
        return;
    }
    Operation operation(nullptr);
    for (const std::string& line : delete_points_in(scene, tree, region->region, operation))
        scene.log(LogLevel::filter, QString::fromStdString(line));
}

void settle(SceneLayer& layer, const pcm::Camera& view)
{
    MeshModel& model = model_of(layer);
    const auto tree = Registry::instance().find(model);
    if (!tree || !tree->sample) return;
    const SampleChange change = find_change(model, *tree->sample);
    switch (change.kind) {
        case SampleChange::Kind::none:
            return;
        case SampleChange::Kind::moved:
            // MeshLab may freeze the same matrix once more before the next picture: that is another change.
            watched().erase(key_of(layer));
            if (layer.scene().part<LayerMatrices>().is_locked(layer)) {
                restore_sample(model, *tree->sample);
                return log(
                    layer, LogLevel::warning,
                    "The layer '" + layer.label().toStdString() +
                        "' is locked: the matrix that was frozen into MeshLab's sample is taken out of it again.");
            }
            unfreeze(model, *tree->sample, change);
            log(layer, LogLevel::filter,
                "The layer '" + layer.label().toStdString() +
                    "': the matrix that was frozen into MeshLab's sample is the layer's matrix again, so that all " +
                    grouped(tree->cloud->info().points) + " points of the cloud are moved by it.");
            return;
        case SampleChange::Kind::deleted:
            return settle_deletion(layer, *tree, change, view);
        case SampleChange::Kind::other:
            return log(layer, LogLevel::warning, sample_warning(model));
    }
}

// Not in the paint event, nor while a filter or a mouse drag is under way.
void settle_when_idle(Scene& scene, int layer_id, const pcm::Camera& view)
{
    QTimer::singleShot(scene.is_busy() ? wait_ms : 0, &scene, [&scene, layer_id, view] {
        SceneLayer* const layer = scene.layer(layer_id);
        if (!layer) return;
        if (scene.is_busy() || QApplication::mouseButtons() != Qt::NoButton || QApplication::activeModalWidget()) {
            QTimer::singleShot(wait_ms, &scene, [&scene, layer_id, view] { settle_when_idle(scene, layer_id, view); });
            return;
        }
        const QPointer<Scene> alive(&scene);
        try {
            settle(*layer, view);
        } catch (...) {
            if (alive) scene.log(LogLevel::warning, "Point Cloud: " + QString::fromStdString(current_error()));
        }
        if (alive) scene.repaint();
    });
}

}  // namespace

void look_at_sample(SceneLayer& layer, const pcm::Camera& view)
{
    layer.scene().part<LayerMatrices>().hold(layer);
    const MeshModel& model = model_of(layer);
    const auto tree = Registry::instance().find(model);
    const LayerKey key = key_of(layer);
    const LayerState state = tree && tree->sample ? state_of(model, Watched::sample) : LayerState();
    if (!tree || !tree->sample || state == tree->state) {
        watched().erase(key);
        return;
    }
    if (layer.scene().is_busy()) return;  // a filter is changing it
    SampleEntry& entry = watched()[key];
    if (entry.seen == state) return;
    entry.seen = state;
    const SampleChange change = find_change(model, *tree->sample);
    entry.notice = change.kind == SampleChange::Kind::none || change.kind == SampleChange::Kind::moved
                       ? QString()
                       : QString::fromStdString("MeshLab's sample only: " + change.text +
                                                ".\nThe cloud still has its " + grouped(tree->cloud->info().points) +
                                                " points as they were.\nFile > Reload restores the sample.");
    settle_when_idle(layer.scene(), layer.id(), view);
}

QString sample_notice(const SceneLayer& layer)
{
    const auto found = watched().find(key_of(layer));
    return found == watched().end() ? QString() : found->second.notice;
}

void draw_sample_notices(const SceneView& view, QPainter& painter)
{
    QStringList notices;
    for (const SceneLayer* layer : view.scene().layers()) {
        if (!view.is_shown(*layer) || !layer->tree()) continue;
        const QString notice = sample_notice(*layer);
        if (!notice.isEmpty()) notices << layer->label() + "\n" + notice;
    }
    view.widget().setProperty("pcm_sample_notice", notices.join("\n"));
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
    QRect place =
        painter.fontMetrics().boundingRect(QRect(0, 0, std::max(200, view.size().width() / 2), view.size().height()),
                                           Qt::AlignLeft | Qt::TextWordWrap, text);
    place.moveTopRight(QPoint(view.size().width() - 2 * margin, 2 * margin));
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
