// A view of the scene: its camera, what its last picture shows, and its widget.
#pragma once

#include "pcm/cloud/condition.h"
#include "pcm/pick/pick_ray.h"
#include "pcm/view/camera.h"
#include "pcm/view/first_person.h"
#include "plugin/scene/scene.h"
#include "plugin/scene/setting_store.h"

#include <QObject>
#include <QSize>
#include <QString>

#include <limits>
#include <memory>
#include <optional>
#include <vector>

class QAction;
class QEvent;
class QMainWindow;
class QWidget;

namespace pcm::host {

// What clouds are drawn in a view, and how.
struct ShownClouds {
    std::vector<int> layers;       // ids of those whose clouds are in the picture
    std::vector<Condition> where;  // only points that meet these are shown; those on attributes that a cloud lacks, or
                                   // that name no component of several, leave that cloud as it is
    double size_scale = 0;         // radii of splats for sizes of points; 0: squares of a few pixels
    bool fitted = false;           // these depend on the points' surroundings
};

// The nearest face of a layer that is drawn as a surface.
struct Occluder {
    double along = std::numeric_limits<double>::infinity();  // distance along the ray
    QString layer;                                           // its label
};

// The eye and the angle of sight, as the program keeps them in single precision.
struct ViewPose {
    EyePose pose;   // in the views' coordinates
    float fov = 0;  // degrees; at most orthographic_fov: the view is orthographic
};
inline constexpr float orthographic_fov = 5;

// Destroyed with its widget. GUI thread.
class SceneView : public QObject {
    Q_OBJECT

public:
    virtual Scene& scene() const = 0;
    virtual QWidget& widget() const = 0;
    virtual QMainWindow* window() const = 0;  // around the widget; null while it has none
    virtual QSize size() const = 0;           // Qt's pixels
    virtual double pixel_ratio() const = 0;   // number of the screen's pixels along a side of one of Qt's pixels
    virtual bool is_current() const = 0;      // whether it is the current view of its scene
    virtual bool is_shown(const SceneLayer& layer) const = 0;
    virtual void update() = 0;  // schedules a new picture

    virtual ViewPose pose() const = 0;
    virtual void look_from(const ViewPose& pose) = 0;
    // The view turns about this place from now on, and looks at it; `zoom` is relative to the scene's own size. The
    // direction of view stays.
    virtual void look_at(const Vec3d& place, double zoom) = 0;
    // The box, in source coordinates, around what the view shows of the layer: about as close as the size of a chunk.
    // Nothing if it shows none.
    virtual std::optional<Box3d> seen_box(const SceneLayer& layer) const;
    // The nearest face that the ray (the views' coordinates) meets between its begin and its end. Exact, from both
    // sides; about 10 ms per million faces.
    virtual Occluder find_occluder(const PickRay& ray) const = 0;

    // The action of the tool that is on in the view; null: none is.
    virtual QAction* tool() const = 0;
    virtual void end_tool() = 0;
    // Esc has given the events of the view back to the camera, and a tool gets none.
    virtual bool is_suspended() const = 0;
    // The camera handles a mouse or wheel event as if no tool was on.
    virtual void give_to_camera(const QEvent& event) = 0;
    // The program's settings, for all views of the window: they may be kept longer than the view.
    virtual std::unique_ptr<SettingStore> settings() const = 0;
    // A line about what happens at the moment, in the view, until the next picture. Not where the view shows no lines.
    virtual void show_line(const QString& title, const QString& text) = 0;

    // In the views' coordinates: Camera::origin is 0, and what it maps are source coordinates minus the scene's origin.
    // Its size is in the pixels of the screen. Nothing until the view has painted a cloud.
    const std::optional<Camera>& camera() const { return camera_; }
    // Nothing until the view has painted.
    const std::optional<ShownClouds>& shown() const { return shown_; }
    // Called by what paints clouds, with each picture but those of snapshots.
    void keep(const Camera& camera, ShownClouds shown);

protected:
    explicit SceneView(QObject* parent) : QObject(parent) {}

private:
    std::optional<Camera> camera_;
    std::optional<ShownClouds> shown_;
};

}  // namespace pcm::host
