// The first-person camera of one of MeshLab's views.
//
// The camera is kept in MeshLab's own trackball. Each step starts from the trackball: from what the tool wrote there,
// or from what has replaced it since (a stock view, the other projection, a linked view, the trackball while the tool
// is suspended). So starting and ending the tool does not move the picture, and nothing has to be restored. GUI thread.
#pragma once

#include "plugin/tools/tool.h"

#include "pcm/cloud/vector.h"
#include "pcm/view/first_person.h"

#include <QElapsedTimer>
#include <QPoint>
#include <QTimer>

#include <optional>

namespace pcm::host {

class FirstPersonTool : public Tool {
    Q_OBJECT

public:
    FirstPersonTool();

    bool start(SceneView& view) override;
    void end() override;
    void draw(QPainter* painter) override;

    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void keyReleaseEvent(QKeyEvent* event) override;

protected:
    // A view that loses the keyboard focus gets no events of released keys.
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    // Reads the camera from the view, if it was changed there.
    void read_camera();
    // Writes the camera to the view.
    void write_camera();
    // Moves for the time since the last call.
    void advance();
    // Lifts the eye, which has moved from `before`, where it would go through the ground.
    void keep_above_ground(const Vec3d& before, double seconds);
    void hold(unsigned keys);
    void start_timer();
    // For observers such as tests.
    void publish();

    std::optional<FirstPerson> walk_;
    ViewPose written_;
    unsigned keys_ = 0;
    bool looking_ = false;
    QPoint looked_at_;
    double reach_ = 0, reach_error_ = 0;
    bool stays_above_ = true;        // the ground; the user's choice
    std::optional<double> ground_;   // under the eye, when it was looked for last
    std::optional<bool> was_above_;  // where the camera was put by other means; nothing: not looked yet
    QTimer timer_;                   // runs while a key is held or something moves
    QElapsedTimer clock_;
};

}  // namespace pcm::host
