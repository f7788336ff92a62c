#include "plugin/tools/walk/first_person_tool.h"

#include "pcm/cloud/vector.h"
#include "plugin/scene/text.h"
#include "plugin/tools/walk/scene_reach.h"

#include <QEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPointer>
#include <QVariantMap>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>

namespace pcm::host {
namespace {

constexpr int tick_ms = 16;
constexpr double longest_step = 0.25;  // seconds: after a slow frame the eye does not jump
constexpr int wheel_notch = 120;       // Qt's unit: eighths of a degree

constexpr double eye_spacings = 3;     // height of the eye above the ground, in spacings of the ground's points
constexpr double rise_seconds = 0.15;  // in which it rises by all but 1/e

const char* const name = "First Person Navigation";

unsigned walk_key(int key)
{
    switch (key) {
        case Qt::Key_W:
        case Qt::Key_Up:
            return walk_forward;
        case Qt::Key_S:
        case Qt::Key_Down:
            return walk_back;
        case Qt::Key_A:
        case Qt::Key_Left:
            return walk_left;
        case Qt::Key_D:
        case Qt::Key_Right:
            return walk_right;
        case Qt::Key_E:
        case Qt::Key_PageUp:
            return walk_up;
        case Qt::Key_Q:
        case Qt::Key_PageDown:
            return walk_down;
        case Qt::Key_Shift:
            return walk_fast;
        default:
            return 0;
    }
}

bool same(const ViewPose& a, const ViewPose& b)
{
    return a.pose.eye == b.pose.eye && a.pose.right == b.pose.right && a.pose.up == b.pose.up &&
           a.pose.back == b.pose.back && a.pose.focus == b.pose.focus && a.fov == b.fov;
}

const char* words_of_ground(bool stays_above)
{
    return stays_above ? "the eye stays above the ground (G lets it through)"
                       : "the eye goes through the ground (G keeps it above)";
}

const char* name_of(UpAxis axis) { return axis == UpAxis::z ? "z" : "y"; }

}  // namespace

FirstPersonTool::FirstPersonTool()
{
    timer_.setTimerType(Qt::PreciseTimer);
    timer_.setInterval(tick_ms);
    connect(&timer_, &QTimer::timeout, this, &FirstPersonTool::advance);
}

bool FirstPersonTool::start(SceneView& view)
{
    view_ = &view;
    try {
        if (!walk_) walk_.emplace(EyePose(), shows_clouds(view) ? UpAxis::z : UpAxis::y);
        written_.fov = 0;  // no view has this value, so the camera is read
        read_camera();
    } catch (...) {
        view.scene().log(LogLevel::warning, QString("%1: %2").arg(name, QString::fromStdString(current_error())));
        view_ = nullptr;
        return false;
    }
    keys_ = 0;
    looking_ = false;
    reach_ = reach_error_ = 0;
    view.widget().installEventFilter(this);
    view.widget().setFocus();
    view.widget().setCursor(Qt::OpenHandCursor);
    view.scene().log(
        LogLevel::system,
        QString("%1: W A S D or the arrow keys walk, E and Q move up and down, Shift moves faster; drag to look "
                "around; the wheel changes the speed (now x %2); U changes the up axis (now %3); %4; Esc switches "
                "between this tool and the trackball. The speed is proportional to the distance of the nearest "
                "points.")
            .arg(name)
            .arg(walk_->factor(), 0, 'g', 3)
            .arg(name_of(walk_->up_axis()))
            .arg(words_of_ground(stays_above_)));
    publish();
    return true;
}

void FirstPersonTool::end()
{
    hold(0);
    looking_ = false;
    timer_.stop();
    view_->widget().removeEventFilter(this);
    publish();
    view_ = nullptr;
}

void FirstPersonTool::read_camera()
{
    const ViewPose pose = view_->pose();
    if (same(pose, written_)) return;
    walk_->set_pose(pose.pose);
    was_above_.reset();
    written_ = pose;
}

void FirstPersonTool::write_camera()
{
    view_->look_from({walk_->pose(), view_->pose().fov});
    written_ = view_->pose();
    publish();
}

void FirstPersonTool::advance()
{
    if (!view_ || !timer_.isActive()) return;
    const double seconds = std::min(static_cast<double>(clock_.nsecsElapsed()) * 1e-9, longest_step);
    clock_.restart();
    if (view_->is_suspended()) {  // the tool gets no events of released keys
        keys_ = 0;
        timer_.stop();
    }
    try {
        read_camera();
        if (timer_.isActive() && walk_->moves(keys_)) {
            const SceneReach reach = reach_from(*view_, walk_->pose().eye);
            reach_ = reach.distance;
            reach_error_ = reach.error;
            const Vec3d before = walk_->pose().eye;
            if (walk_->step(seconds, keys_, reach_)) {
                keep_above_ground(before, seconds);
                write_camera();
            }
        }
        if (keys_ == 0 && !walk_->moves(keys_)) timer_.stop();
    } catch (...) {  // Qt does not allow exceptions in event handlers
        timer_.stop();
        view_->scene().log(LogLevel::warning, current_error().c_str());
    }
    if (!timer_.isActive()) publish();
}

void FirstPersonTool::keep_above_ground(const Vec3d& before, double seconds)
{
    EyePose pose = walk_->pose();
    if (!stays_above_ || pose.orthographic) return;
    const std::size_t up = walk_->up_axis() == UpAxis::z ? 2 : 1;
    if (!was_above_) {
        const auto begun = ground_under(*view_, before, up);
        if (!begun) return;
        was_above_ = before[up] >= begun->height;  // an eye that begins in a cellar stays there
    }
    const auto ground = *was_above_ ? ground_under(*view_, pose.eye, up) : std::nullopt;
    if (!ground) return;
    ground_ = ground->height;
    const double wanted = ground->height + eye_spacings * ground->spacing;
    double& eye = pose.eye[up];
    if (!(eye < wanted)) return;
    // Never nearer than half of it, and the rest smoothly: the ground is found from few points.
    const double least = ground->height + eye_spacings / 2 * ground->spacing;
    eye = std::max(eye + (wanted - eye) * (1 - std::exp(-seconds / rise_seconds)), least);
    walk_->set_pose(pose);
}

void FirstPersonTool::hold(unsigned keys)
{
    if (keys == keys_) return;
    advance();  // with the keys held until now
    keys_ = keys;
    start_timer();
    publish();
}

void FirstPersonTool::start_timer()
{
    if (!view_ || timer_.isActive() || (keys_ == 0 && !walk_->moves(keys_))) return;
    clock_.start();
    timer_.start();
}

void FirstPersonTool::keyPressEvent(QKeyEvent* event)
{
    if ((event->modifiers() & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier)) != 0)
        return;  // shortcuts of MeshLab
    if (event->key() == Qt::Key_U) {
        event->accept();
        if (event->isAutoRepeat()) return;
        walk_->set_up_axis(walk_->up_axis() == UpAxis::z ? UpAxis::y : UpAxis::z);
        view_->scene().log(LogLevel::system, QString("%1: %2 is up").arg(name, name_of(walk_->up_axis())));
        view_->update();
        return;
    }
    if (event->key() == Qt::Key_G) {
        event->accept();
        if (event->isAutoRepeat()) return;
        stays_above_ = !stays_above_;
        was_above_.reset();
        view_->scene().log(LogLevel::system, QString("%1: %2").arg(name, words_of_ground(stays_above_)));
        view_->update();
        return publish();
    }
    const unsigned key = walk_key(event->key());
    if (key == 0) return;
    event->accept();
    if (event->isAutoRepeat()) return;
    const bool fast = key == walk_fast || (event->modifiers() & Qt::ShiftModifier) != 0;
    hold((keys_ & ~unsigned(walk_fast)) | key | (fast ? walk_fast : 0u));
}

void FirstPersonTool::keyReleaseEvent(QKeyEvent* event)
{
    const unsigned key = walk_key(event->key());
    if (key == 0) return;
    event->accept();
    if (!event->isAutoRepeat()) hold(keys_ & ~key);
}

void FirstPersonTool::mousePressEvent(QMouseEvent* event)
{
    if (event->button() != Qt::LeftButton) return;
    looking_ = true;
    looked_at_ = event->pos();
    view_->widget().setCursor(Qt::ClosedHandCursor);
}

void FirstPersonTool::mouseMoveEvent(QMouseEvent* event)
{
    if (!looking_ || (event->buttons() & Qt::LeftButton) == 0) return;
    const QPoint moved = event->pos() - looked_at_;
    looked_at_ = event->pos();
    if (moved.isNull() || view_->widget().height() <= 0) return;
    try {
        advance();
        read_camera();
        // What is in the middle of the picture goes by as fast as the mouse; an orthographic view turns by half a
        // circle over its height.
        const double angle = walk_->pose().orthographic ? pi : static_cast<double>(view_->pose().fov) * pi / 180;
        const double each = angle / view_->widget().height();
        walk_->turn(-moved.x() * each, -moved.y() * each);
        write_camera();
        start_timer();  // until the horizon is level
    } catch (...) {
        view_->scene().log(LogLevel::warning, current_error().c_str());
    }
}

void FirstPersonTool::mouseReleaseEvent(QMouseEvent* event)
{
    if (event->button() != Qt::LeftButton) return;
    looking_ = false;
    view_->widget().setCursor(Qt::OpenHandCursor);
}

void FirstPersonTool::wheelEvent(QWheelEvent* event)
{
    advance();
    // Some systems turn the wheel sideways while a key is held.
    const int turned = event->angleDelta().y() != 0 ? event->angleDelta().y() : event->angleDelta().x();
    walk_->change_speed(static_cast<double>(turned) / wheel_notch);
    event->accept();
    publish();
}

void FirstPersonTool::draw(QPainter*)
{
    const auto number = [](double v) { return QString::fromStdString(brief(v)); };
    QString text = QString("speed x %1").arg(walk_->factor(), 0, 'g', 3);
    if (walk_->pose().orthographic) {
        text += ", proportional to the height of the view";
    } else if (reach_ > 0) {
        const double speed = reach_ * walk_->factor() * ((keys_ & walk_fast) != 0 ? FirstPerson::fast_factor : 1);
        const QString from = number(reach_ - reach_error_), to = number(reach_);
        text +=
            QString(": %1 per second; nearest points %2 away").arg(number(speed), from == to ? to : from + " to " + to);
    }
    text += QString("; %1").arg(words_of_ground(stays_above_));
    view_->show_line(name, text);
}

bool FirstPersonTool::eventFilter(QObject* receiver, QEvent* event)
{
    if (view_ && receiver == &view_->widget() &&
        (event->type() == QEvent::FocusOut || event->type() == QEvent::WindowDeactivate ||
         event->type() == QEvent::Hide)) {
        hold(0);
        looking_ = false;
    }
    return QObject::eventFilter(receiver, event);
}

void FirstPersonTool::publish()
{
    if (!view_) return;
    QVariantMap state;
    state["keys"] = keys_;
    state["moving"] = timer_.isActive();
    state["factor"] = walk_->factor();
    state["roll"] = walk_->roll();
    state["reach"] = reach_;
    state["reach_error"] = reach_error_;
    state["stays_above"] = stays_above_;
    if (ground_) state["ground"] = *ground_;
    view_->widget().setProperty("pcm_first_person", state);
}

}  // namespace pcm::host
