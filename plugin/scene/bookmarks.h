// The cameras of a document that a user has given names. They are kept in project files as the text of a camera path
// (view/camera_path.h), in source coordinates, so that they hold whatever the origin of MeshLab's coordinates is. GUI
// thread.
#pragma once

#include "plugin/scene/scene_view.h"

#include "pcm/view/camera_path.h"

#include <QObject>
#include <QString>

#include <cstddef>
#include <vector>

namespace pcm::host {

// The camera of the view, and back: MeshLab keeps it in single precision. `origin`: the scene's origin.
CameraFrame frame_of(const SceneView& view, const Vec3d& origin);
void look_from(SceneView& view, const CameraFrame& frame, const Vec3d& origin);

// One for each scene.
class Bookmarks : public QObject {
    Q_OBJECT

public:
    explicit Bookmarks(Scene& scene) : QObject(&scene) {}

    const std::vector<CameraFrame>& all() const { return frames_; }
    // A name that there is already, or an empty one, gets a number. Returns the name.
    QString add(CameraFrame frame, const QString& name);
    // As add(); nothing is done for a number out of range.
    void rename(std::size_t number, const QString& name);
    void remove(std::size_t number);

    // As a camera path. add_text() adds the frames; throws Error(bad_format) for text that is not one, and
    // Error(invalid_argument) for a path in the coordinates of a box, and adds nothing then.
    QString text() const;
    void add_text(const QString& text, const QString& source);
    void clear();

signals:
    void changed();

private:
    QString free_name(const QString& wanted) const;

    std::vector<CameraFrame> frames_;
};

// Lets project files keep bookmarks. Called once.
void keep_bookmarks_in_projects();

}  // namespace pcm::host
