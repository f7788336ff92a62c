#include "plugin/scene/bookmarks.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/scene/project_parts.h"

#include <QRegularExpression>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm::host {

namespace {

// An orthographic view shows 1.75 above and below the centre at a distance of 8 (trackball_pose.h).
constexpr double height_per_focus = 2 * 1.75 / 8;

}  // namespace

CameraFrame frame_of(const SceneView& view, const Vec3d& origin)
{
    const auto [pose, fov] = view.pose();
    CameraFrame frame;
    frame.eye = pose.eye + origin;
    frame.target = pose.centre() + origin;
    frame.up = pose.up;
    if (pose.orthographic)
        frame.height = pose.focus * height_per_focus;
    else
        frame.angle = double(fov);
    return frame;
}

void look_from(SceneView& view, const CameraFrame& frame, const Vec3d& origin)
{
    check(frame);
    EyePose pose;
    pose.orthographic = !frame.angle;
    pose.back = normalised(frame.eye - frame.target);
    pose.right = normalised(cross(normalised(frame.up), pose.back));
    pose.up = cross(pose.back, pose.right);
    pose.focus = length(frame.eye - frame.target);
    if (pose.orthographic) pose.focus = frame.height / height_per_focus;
    pose.eye = frame.target - origin + pose.focus * pose.back;
    // MeshLab's smallest angle marks an orthographic view, and its largest is 90 degrees.
    const float fov = frame.angle ? float(std::clamp(*frame.angle, 5.5, 90.0)) : orthographic_fov;
    view.look_from({pose, fov});
}

QString Bookmarks::free_name(const QString& wanted) const
{
    QString name = wanted.trimmed().isEmpty() ? QString("View") : wanted.trimmed();
    const QString base = QString(name).remove(QRegularExpression(" \\d+$"));
    const auto taken = [&] {
        return std::any_of(frames_.begin(), frames_.end(),
                           [&](const CameraFrame& frame) { return frame.name == name.toStdString(); });
    };
    for (int n = 2; taken(); ++n) name = QString("%1 %2").arg(base).arg(n);
    return name;
}

QString Bookmarks::add(CameraFrame frame, const QString& name)
{
    check(frame);
    const QString free = free_name(name);
    frame.name = free.toStdString();
    frames_.push_back(std::move(frame));
    emit changed();
    return free;
}

void Bookmarks::rename(std::size_t number, const QString& name)
{
    if (number >= frames_.size() || frames_[number].name == name.trimmed().toStdString()) return;
    frames_[number].name.clear();
    frames_[number].name = free_name(name).toStdString();
    emit changed();
}

void Bookmarks::remove(std::size_t number)
{
    if (number >= frames_.size()) return;
    frames_.erase(frames_.begin() + std::ptrdiff_t(number));
    emit changed();
}

void Bookmarks::clear()
{
    frames_.clear();
    emit changed();
}

QString Bookmarks::text() const
{
    if (frames_.empty()) return {};
    CameraPath path;
    path.name = "bookmarks";
    path.frames = frames_;
    return QString::fromStdString(path.text());
}

void Bookmarks::add_text(const QString& text, const QString& source)
{
    const CameraPath path = CameraPath::of_text(text.toStdString(), source.toStdString());
    if (path.in_box)
        throw Error(ErrorCode::invalid_argument, source.toStdString(),
                    "this camera path is in the coordinates of a cloud's box, and bookmarks are in source coordinates",
                    "use a path with \"coordinates\": \"source\"");
    for (const CameraFrame& frame : path.frames) add(frame, QString::fromStdString(frame.name));
}

void keep_bookmarks_in_projects()
{
    add_project_part({"PointCloudBookmarks", [](Scene& scene) { return scene.part<Bookmarks>().text(); },
                      [](Scene& scene, const QString& text) {
                          CameraPath::of_text(text.toStdString(), "bookmarks of the project");  // or nothing changes
                          scene.part<Bookmarks>().clear();
                          scene.part<Bookmarks>().add_text(text, "bookmarks of the project");
                      }});
}

}  // namespace pcm::host
