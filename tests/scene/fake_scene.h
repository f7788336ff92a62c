// A scene of lists: what MeshLab's documents, layers and views are to the plugins, without MeshLab.
#pragma once

#include "tests/scene/fake_settings.h"
#include "tests/support.h"

#include "pcm/build/builder.h"
#include "pcm/cloud/vector.h"
#include "pcm/generate/scene.h"
#include "plugin/scene/scene_view.h"

#include <QMainWindow>
#include <QString>
#include <QStringList>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pcm::host {

inline const Vec3d far_away{500000.0, 4800000.0, 100.0};

// A tree of a generated scene at far_away.
inline std::filesystem::path make_tree(const test::TemporaryFolder& folder, const std::string& name,
                                       std::uint64_t points)
{
    SceneOptions scene;
    scene.points = points;
    scene.origin = far_away;
    scene.overwrite = true;
    const std::filesystem::path las = folder / (name + ".las"), tree = folder / (name + ".pct");
    generate_scene(las, scene, false);
    BuildOptions build;
    build.memory_bytes = std::uint64_t(64) << 20;
    build.chunk_points = 1000;
    build_tree({las}, tree, build);
    return tree;
}

class FakeLayer : public SceneLayer {
public:
    FakeLayer(Scene& scene, int id, QString label) : scene_(scene), id_(id), label_(std::move(label)) {}

    Scene& scene() const override { return scene_; }
    int id() const override { return id_; }
    QString label() const override { return label_; }
    QString file() const override { return file_; }
    void set_file(const QString& file) override { file_ = file; }
    bool is_visible() const override { return visible; }
    void show(bool on) override { visible = on; }
    LayerMatrix matrix() const override { return matrix_; }
    void set_matrix(const LayerMatrix& matrix) override { matrix_ = matrix; }
    void mark_modified() override { modified = true; }
    std::optional<LayerCloud> tree() const override { return cloud; }
    std::optional<LayerCloud> drawn() const override { return cloud; }
    std::optional<Affine> placement() const override
    {
        if (!cloud || matrix_ == identity_matrix) return std::nullopt;
        Affine map;
        map.pivot = cloud->origin;
        for (std::size_t r = 0; r < 3; ++r) {
            for (std::size_t c = 0; c < 3; ++c) map.linear[r][c] = double(matrix_[r][c]);
            map.target[r] = cloud->origin[r] + double(matrix_[r][3]);
        }
        return map;
    }
    const std::vector<Metadata>* metadata() const override { return cloud ? &cloud->cloud->info().metadata : nullptr; }
    Box3d vertex_box() const override { return {}; }
    void visit_vertices(const std::function<void(const Vec3d& position, bool is_selected)>& visit) const override
    {
        for (const auto& [position, is_selected] : vertices) visit(position, is_selected);
    }

    std::optional<LayerCloud> cloud;
    std::vector<std::pair<Vec3d, bool>> vertices;  // and whether they are selected
    bool visible = true, modified = false;

private:
    Scene& scene_;
    const int id_;
    const QString label_;
    QString file_ = label_ + ".pct";
    LayerMatrix matrix_ = identity_matrix;
};

class FakeScene : public Scene {
public:
    FakeScene() : Scene(nullptr) {}

    std::vector<SceneLayer*> layers() const override
    {
        std::vector<SceneLayer*> all;
        for (const auto& layer : layers_) all.push_back(layer.get());
        return all;
    }
    SceneLayer* layer(int id) const override
    {
        for (const auto& layer : layers_)
            if (layer->id() == id) return layer.get();
        return nullptr;
    }
    SceneLayer* current() const override { return layer(current_); }
    void make_current(int id) override
    {
        current_ = id;
        emit current_changed(id);
    }
    std::vector<SceneView*> views() const override { return views_; }
    std::optional<Vec3d> origin() const override { return far_away; }
    double diagonal() const override { return 100; }
    bool is_busy() const override { return busy; }
    QString project_file() const override { return {}; }
    void log(LogLevel, const QString& text) override { lines << text; }
    void refresh_layer_lists() override { ++refreshed; }
    SceneLayer* add_tree(const std::filesystem::path& folder, const SceneLayer* like,
                         std::vector<std::string>&) override
    {
        FakeLayer& added = add(QString::fromStdString(folder.stem().string()), folder);
        if (like) added.set_matrix(like->matrix());
        return &added;
    }
    std::vector<std::string> reload(const std::filesystem::path& folder) override
    {
        reloaded.push_back(folder);
        return {"reloaded"};
    }

    // A layer, which becomes the current one; of a tree, or an ordinary one.
    FakeLayer& add(const QString& label, const std::filesystem::path& tree = {})
    {
        layers_.push_back(std::make_unique<FakeLayer>(*this, next_id_++, label));
        FakeLayer& layer = *layers_.back();
        if (!tree.empty()) layer.cloud = LayerCloud{PointCloud::open(tree), far_away, nullptr};
        current_ = layer.id();
        if (layer.cloud) emit cloud_attached(layer.id());
        return layer;
    }
    void remove(int id)
    {
        layers_.erase(std::remove_if(layers_.begin(), layers_.end(), [&](const auto& l) { return l->id() == id; }),
                      layers_.end());
        emit layer_removed(id);
    }
    void add_view(SceneView& view) { views_.push_back(&view); }

    bool busy = false;
    QStringList lines;
    int refreshed = 0;
    std::vector<std::filesystem::path> reloaded;

private:
    std::vector<std::unique_ptr<FakeLayer>> layers_;
    std::vector<SceneView*> views_;
    int current_ = -1, next_id_ = 0;
};

// 800 x 600 pixels, orthographic, straight down from 100 units above a place: a pixel is 0.1 units.
class FakeView : public SceneView {
public:
    explicit FakeView(FakeScene& scene) : SceneView(nullptr), scene_(scene)
    {
        widget_ = new QWidget(&window_);
        window_.setCentralWidget(widget_);
        scene.add_view(*this);
    }

    Scene& scene() const override { return scene_; }
    QWidget& widget() const override { return *widget_; }
    QMainWindow* window() const override { return const_cast<QMainWindow*>(&window_); }
    QSize size() const override { return {800, 600}; }
    double pixel_ratio() const override { return 1; }
    bool is_current() const override { return true; }
    bool is_shown(const SceneLayer& layer) const override { return layer.is_visible(); }
    void update() override { ++updates; }
    ViewPose pose() const override { return pose_; }
    void look_from(const ViewPose& pose) override { pose_ = pose; }
    void look_at(const Vec3d& place, double zoom) override { looked_at = {place, zoom}; }
    std::optional<Box3d> seen_box(const SceneLayer& layer) const override
    {
        return layer.drawn() ? std::optional(layer.drawn()->cloud->info().bounds()) : std::nullopt;
    }
    Occluder find_occluder(const PickRay&) const override { return occluder; }
    QAction* tool() const override { return nullptr; }
    void end_tool() override {}
    bool is_suspended() const override { return suspended; }
    void give_to_camera(const QEvent&) override { ++camera_events; }
    std::unique_ptr<SettingStore> settings() const override { return std::make_unique<FakeSettings>(kept); }
    void show_line(const QString& title, const QString& text) override { line = title + ": " + text; }

    // A picture of these layers; `centre` is in its middle.
    void paint(std::vector<int> layers, const Vec3d& centre = far_away)
    {
        Camera camera;
        camera.width = 800;
        camera.height = 600;
        const Vec3d eye = centre - far_away + Vec3d{0, 0, 100};
        camera.modelview = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -eye[0], -eye[1], -eye[2], 1};
        const double near = 1, far = 1000;
        camera.projection = {
            1.0 / 40, 0, 0, 0, 0, 1.0 / 30, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1};
        ShownClouds shown;
        shown.layers = std::move(layers);
        keep(camera, shown);
    }

    std::shared_ptr<Parameters> kept = std::make_shared<Parameters>();  // the settings
    int updates = 0, camera_events = 0;
    bool suspended = false;
    Occluder occluder;
    QString line;
    std::pair<Vec3d, double> looked_at;

private:
    FakeScene& scene_;
    QMainWindow window_;
    QWidget* widget_ = nullptr;
    ViewPose pose_{{}, 60};
};

}  // namespace pcm::host
