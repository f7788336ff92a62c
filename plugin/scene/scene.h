// What is open in one window of the program: layers, views, and what tools and panels keep about them. It does
// not depend on MeshLab; plugin/meshlab implements it over MeshLab's documents, and tests over lists of their own.
#pragma once

#include "plugin/scene/scene_layer.h"

#include <QObject>
#include <QString>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

class SceneView;

enum class LogLevel { system, filter, warning };

// GUI thread. Layers and views are the scene's.
class Scene : public QObject {
    Q_OBJECT

public:
    // In the order in which they were opened.
    virtual std::vector<SceneLayer*> layers() const = 0;
    virtual SceneLayer* layer(int id) const = 0;  // null: it was removed, or there was none
    virtual SceneLayer* current() const = 0;      // null: there is none
    virtual void make_current(int id) = 0;
    virtual std::vector<SceneView*> views() const = 0;  // none in a program without a window
    // Source coordinates minus this are those of the views; nothing before the first cloud.
    virtual std::optional<Vec3d> origin() const = 0;
    virtual double diagonal()
        const = 0;  // diagonal of the box around all layers as they are placed; 0: there is nothing
    // The program is reading or changing layers: nothing may be changed now.
    virtual bool is_busy() const = 0;
    virtual QString project_file() const = 0;  // the one opened or saved last; empty: none
    virtual void log(LogLevel level, const QString& text) = 0;
    // Lists of layers in the program's window are to show that names, the current layer or visibility have changed.
    virtual void refresh_layer_lists() = 0;

    // Adds a layer that shows the tree `folder`, makes it the current one and adds lines for the log; null: the tree
    // has no points. `like`: the new layer gets the matrix of this one; null: none. Throws what opening the tree and
    // reading chunks throws; the scene then has no new layer.
    virtual SceneLayer* add_tree(const std::filesystem::path& folder, const SceneLayer* like,
                                 std::vector<std::string>& lines) = 0;
    // The layers that show the tree `folder` are loaded again. Returns a line for each. Throws as add_tree().
    virtual std::vector<std::string> reload(const std::filesystem::path& folder) = 0;

    // Asks all views for a new picture.
    void repaint() const;

    // What is kept about the scene, one object of each class, made at the first request: T has a constructor with
    // a Scene&, is a QObject, and lives as long as the scene.
    template <class T>
    T& part()
    {
        T* found = findChild<T*>(QString(), Qt::FindDirectChildrenOnly);
        return found ? *found : *new T(*this);
    }

signals:
    void layer_removed(int id);
    void current_changed(int id);  // -1: there is no current layer
    // A layer shows another cloud than before, or one for the first time; or none any more.
    void cloud_attached(int id);
    void cloud_detached(int id);

protected:
    explicit Scene(QObject* parent) : QObject(parent) {}
};

}  // namespace pcm::host
