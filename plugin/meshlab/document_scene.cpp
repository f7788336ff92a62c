#include "plugin/meshlab/document_scene.h"

#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/mesh_occlusion.h"
#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/placement.h"
#include "plugin/meshlab/registry.h"
#include "plugin/meshlab/rich_parameters.h"
#include "plugin/meshlab/trackball_pose.h"
#include "plugin/scene/misfit.h"
#include "plugin/scene/open_clouds.h"

#include <QCoreApplication>
#include <QFileInfo>
#include <QMainWindow>
#include <QMdiArea>
#include <QMdiSubWindow>
#include <QMouseEvent>
#include <QPointer>
#include <QWheelEvent>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

namespace pcm::host {

namespace {

LayerMatrix rows_of(const Matrix44m& matrix)
{
    LayerMatrix rows;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) rows[std::size_t(r)][std::size_t(c)] = static_cast<float>(matrix[r][c]);
    return rows;
}

class ModelLayer : public SceneLayer {
public:
    explicit ModelLayer(MeshModel& model) : model_(model) {}
    MeshModel& model() const { return model_; }

    Scene& scene() const override { return scene_of(document_of(model_)); }
    int id() const override { return model_.id(); }
    QString label() const override { return model_.label(); }
    QString file() const override { return model_.fullName(); }
    void set_file(const QString& path) override { model_.setFileName(path); }

    bool is_visible() const override { return is_shown(model_); }
    void show(bool on) override
    {
        set_shown(model_, on);
        for (GLArea* view : views_of(document_of(model_))) {
            view->meshVisibilityMap[model_.id()] = on;
            view->update();
        }
    }

    LayerMatrix matrix() const override { return rows_of(model_.cm.Tr); }
    void set_matrix(const LayerMatrix& matrix) override
    {
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) model_.cm.Tr[r][c] = Scalarm(matrix[std::size_t(r)][std::size_t(c)]);
    }
    void mark_modified() override { model_.setMeshModified(true); }

    std::optional<LayerCloud> tree() const override { return Registry::instance().find(model_); }
    std::optional<LayerCloud> drawn() const override { return Registry::instance().drawn(model_); }
    std::optional<Affine> placement() const override
    {
        const auto tree = Registry::instance().drawn(model_);
        return tree ? placement_of(model_, *tree) : std::nullopt;
    }
    const std::vector<Metadata>* metadata() const override
    {
        if (const auto tree = Registry::instance().find(model_)) return &tree->cloud->info().metadata;
        if (const auto source = Registry::instance().source_of(model_)) return &source->info.metadata;
        return nullptr;
    }
    Box3d vertex_box() const override
    {
        Box3d box;
        for (int corner = 0; corner < 8 && !model_.cm.bbox.IsNull(); ++corner) {
            const Point3m p = model_.cm.bbox.P(corner);
            box.extend(Vec3d{double(p[0]), double(p[1]), double(p[2])});
        }
        return box;
    }
    void visit_vertices(const std::function<void(const Vec3d& position, bool is_selected)>& visit) const override
    {
        for (const CVertexO& vertex : model_.cm.vert) {
            const Point3m& p = vertex.cP();
            if (!vertex.IsD()) visit({double(p[0]), double(p[1]), double(p[2])}, vertex.IsS());
        }
    }

private:
    MeshModel& model_;
};

int number_of(LogLevel level)
{
    switch (level) {
        case LogLevel::system:
            return GLLogStream::SYSTEM;
        case LogLevel::filter:
            return GLLogStream::FILTER;
        default:
            return GLLogStream::WARNING;
    }
}

class DocumentScene : public Scene {
public:
    explicit DocumentScene(MeshDocument& document) : Scene(&document), document_(document)
    {
        connect(&document, &MeshDocument::meshRemoved, this, [this](int id) {
            emit layer_removed(id);
            layers_.erase(id);
        });
        connect(&document, &MeshDocument::currentMeshChanged, this, &Scene::current_changed);
        const Registry& registry = Registry::instance();
        connect(&registry, &Registry::attached, this, [this](MeshDocument* changed, int id) {
            if (changed == &document_) emit cloud_attached(id);
        });
        connect(&registry, &Registry::detached, this, [this](MeshDocument* changed, int id) {
            if (changed == &document_) emit cloud_detached(id);
        });
    }
    MeshDocument& document() const { return document_; }

    std::vector<SceneLayer*> layers() const override
    {
        std::vector<SceneLayer*> all;
        for (MeshModel* model : models_of(document_)) all.push_back(&layer_for(*model));
        return all;
    }
    SceneLayer* layer(int id) const override
    {
        MeshModel* const model = id < 0 ? nullptr : document_.getMesh(id);
        return model ? &layer_for(*model) : nullptr;
    }
    SceneLayer* current() const override { return document_.mm() ? &layer_for(*document_.mm()) : nullptr; }
    void make_current(int id) override { document_.setCurrentMesh(id); }
    std::vector<SceneView*> views() const override
    {
        std::vector<SceneView*> all;
        for (GLArea* area : views_of(document_)) all.push_back(&view_of(*area));
        return all;
    }
    std::optional<Vec3d> origin() const override { return Registry::instance().origin_of(document_); }
    double diagonal() const override { return double(document_.bbox().Diag()); }
    bool is_busy() const override { return document_.isBusy(); }
    QString project_file() const override
    {
        // MeshLab's name of a project that was opened or saved is its path.
        const QFileInfo file(document_.docLabel());
        const QString type = file.suffix().toLower();
        return (type == "mlp" || type == "mlb") && file.isFile() ? file.absoluteFilePath() : QString();
    }
    void log(LogLevel level, const QString& text) override { write_log(document_.Log, number_of(level), text); }
    void refresh_layer_lists() override
    {
        for (const GLArea* area : views_of(document_))
            if (QMainWindow* window = window_of(*area)) {
                QMetaObject::invokeMethod(window, "updateLayerDialog");
                return;
            }
    }
    SceneLayer* add_tree(const std::filesystem::path& folder, const SceneLayer* like,
                         std::vector<std::string>& lines) override;
    std::vector<std::string> reload(const std::filesystem::path& folder) override
    {
        return reload_layers(document_, folder);
    }

    // MeshLab's layers have no place for one of ours, so they are found by their ids.
    ModelLayer& layer_for(MeshModel& model) const
    {
        auto& layer = layers_[model.id()];
        if (!layer || &layer->model() != &model) layer = std::make_unique<ModelLayer>(model);
        return *layer;
    }

private:
    MeshDocument& document_;
    mutable std::map<int, std::unique_ptr<ModelLayer>> layers_;
};

SceneLayer* DocumentScene::add_tree(const std::filesystem::path& folder, const SceneLayer* like,
                                    std::vector<std::string>& lines)
{
    const auto cloud = open_cloud(folder);
    if (cloud->info().points == 0) {
        lines.push_back(folder.string() + " has no points, so no layer shows it.");
        return nullptr;
    }
    MeshModel* const model = document_.addNewMesh(QString::fromStdString(folder.string()),
                                                  QString::fromStdString(folder.filename().string()));
    SceneLayer& layer = layer_for(*model);
    try {
        for (const Misfit& misfit : misfits(layer, cloud->info().metadata, cloud->info().bounds()))
            lines.push_back("Warning: " + folder.filename().string() + ": " + misfit.text);
        for (std::string& line : show_tree(*model, cloud)) lines.push_back(std::move(line));
    } catch (...) {
        remove_model(document_, *model);
        throw;
    }
    if (like) layer.set_matrix(like->matrix());
    repaint();
    return &layer;
}

// The tool counts as suspended in its lifetime: GLArea exports no functions of its trackball.
class Suspended {
public:
    explicit Suspended(GLArea& area) : area_(area), before_(area.suspendedEditor) { area.suspendedEditor = true; }
    ~Suspended() { area_.suspendedEditor = before_; }
    Suspended(const Suspended&) = delete;
    Suspended& operator=(const Suspended&) = delete;

private:
    GLArea& area_;
    bool before_;
};

class AreaView : public SceneView {
public:
    explicit AreaView(GLArea& area) : SceneView(&area), area_(area), scene_(scene_of(*area.md())) {}
    GLArea& area() const { return area_; }

    Scene& scene() const override { return scene_; }
    QWidget& widget() const override { return area_; }
    QMainWindow* window() const override { return window_of(area_); }
    QSize size() const override { return area_.size(); }
    double pixel_ratio() const override { return area_.devicePixelRatioF(); }
    bool is_current() const override { return area_.isCurrent(); }
    bool is_shown(const SceneLayer& layer) const override { return area_.meshVisibilityMap.value(layer.id(), true); }
    void update() override { area_.update(); }

    ViewPose pose() const override { return {pose_of(area_.trackball.track, area_.fov), area_.fov}; }
    void look_from(const ViewPose& pose) override
    {
        area_.fov = pose.fov;
        area_.trackball.track = trackball_of(pose.pose, pose.fov);
        area_.update();
    }
    void look_at(const Vec3d& place, double zoom) override
    {
        auto& track = area_.trackball.track;
        track.sca = static_cast<float>(zoom);
        track.tra = vcg::Point3f(float(-place[0]), float(-place[1]), float(-place[2]));
        area_.update();
    }
    Occluder find_occluder(const PickRay& ray) const override { return host::find_occluder(*this, ray); }

    QAction* tool() const override { return area_.getCurrentEditAction(); }
    void end_tool() override
    {
        area_.suspendedEditor = false;  // MeshLab would start the next tool suspended
        if (QMainWindow* const window = window_of(area_))
            QMetaObject::invokeMethod(window, "endEdit", Qt::DirectConnection);
    }
    bool is_suspended() const override { return area_.suspendedEditor; }
    void give_to_camera(const QEvent& event) override;
    std::unique_ptr<SettingStore> settings() const override
    {
        return setting_store(const_cast<RichParameterList*>(area_.glas.currentGlobalParamSet));
    }
    void show_line(const QString& title, const QString& text) override
    {
        // MeshLab clears these lines only when it shows them.
        if (area_.infoAreaVisible && area_.md()) host::show_line(area_.md()->Log, title, text);
    }

private:
    GLArea& area_;
    Scene& scene_;
};

void AreaView::give_to_camera(const QEvent& event)
{
    const QCursor cursor = area_.cursor();  // MeshLab sets one of its own for the trackball
    {
        const Suspended suspended(area_);
        if (event.type() == QEvent::Wheel) {
            QWheelEvent copy(static_cast<const QWheelEvent&>(event));
            QCoreApplication::sendEvent(&area_, &copy);
        } else {
            QMouseEvent copy(static_cast<const QMouseEvent&>(event));
            QCoreApplication::sendEvent(&area_, &copy);
        }
    }
    area_.setCursor(cursor);
}

}  // namespace

Scene& scene_of(const MeshDocument& document)
{
    auto* found = document.findChild<Scene*>(QString(), Qt::FindDirectChildrenOnly);
    return found ? *found : *new DocumentScene(const_cast<MeshDocument&>(document));
}

MeshDocument& document_of(const Scene& scene) { return static_cast<const DocumentScene&>(scene).document(); }

SceneLayer& layer_of(const MeshModel& model)
{
    return static_cast<DocumentScene&>(scene_of(document_of(model))).layer_for(const_cast<MeshModel&>(model));
}

MeshModel& model_of(const SceneLayer& layer) { return static_cast<const ModelLayer&>(layer).model(); }

SceneView& view_of(GLArea& area)
{
    auto* found = area.findChild<SceneView*>(QString(), Qt::FindDirectChildrenOnly);
    return found ? *found : *new AreaView(area);
}

GLArea& area_of(const SceneView& view) { return static_cast<const AreaView&>(view).area(); }

SceneView* current_view(const QMainWindow& window)
{
    const auto* projects = window.findChild<QMdiArea*>();
    QMdiSubWindow* const project = projects ? projects->currentSubWindow() : nullptr;
    if (!project) return nullptr;
    GLArea* found = nullptr;
    for (QWidget* widget : project->findChildren<QWidget*>()) {
        if (!widget->inherits("GLArea")) continue;
        auto* const area = static_cast<GLArea*>(widget);
        if (!found || area->hasFocus()) found = area;
        if (area->hasFocus()) break;
    }
    return found && found->md() ? &view_of(*found) : nullptr;
}

}  // namespace pcm::host
