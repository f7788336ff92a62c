// The first-person camera of one of MeshLab's views.
//
// The camera is kept in MeshLab's own trackball. Each step starts from the trackball: from what the tool wrote there,
// or from what has replaced it since (a stock view, the other projection, a linked view, the trackball while the tool
// is suspended). So starting and ending the tool does not move the picture, and nothing has to be restored. GUI thread.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/view/first_person.h"

#include <common/interfaces.h>
#include <vcg/math/similarity.h>

#include <QElapsedTimer>
#include <QPoint>
#include <QTimer>

#include <optional>

namespace pcm::host {

class FirstPersonTool : public QObject, public MeshEditInterface {
    Q_OBJECT
    Q_INTERFACES(MeshEditInterface)

public:
    FirstPersonTool();
    QString pluginName() const override { return "EditPointCloud"; }

    // The tool walks through all layers; the current layer does not matter.
    bool isSingleMeshEdit() const override { return false; }
    bool StartEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;
    void EndEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;
    void LayerChanged(MeshDocument&, MeshModel&, GLArea*, MLSceneGLSharedDataContext*) override {}
    void Decorate(MeshModel& layer, GLArea* view, QPainter* painter) override;

    void mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void wheelEvent(QWheelEvent* event, MeshModel&, GLArea* view) override;
    void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view) override;
    void keyReleaseEvent(QKeyEvent* event, MeshModel&, GLArea* view) override;

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

    GLArea* view_ = nullptr;  // while the tool is on
    std::optional<FirstPerson> walk_;
    vcg::Similarityf written_;
    float written_fov_ = 0;
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
