// The first-person camera of one of MeshLab's views.
//
// All that it keeps of the camera is in MeshLab's own trackball: what it has written there last it goes on from, and
// when somebody else has written there since (a stock view, the other projection, a linked view, the trackball while
// the tool is suspended), it goes on from that. So neither going in nor going out moves the picture, and there is
// nothing to be restored.
#pragma once

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

    // All layers are walked through; which one is current does not matter.
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
    // A view that loses the keyboard hears of no key that is let go of.
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    // Goes on from what the view shows.
    void take_over();
    // Gives the view what there is.
    void show();
    // Moves for the time since the last call.
    void advance();
    void hold(unsigned keys);
    void keep_going();
    void publish();

    GLArea* view_ = nullptr;  // while the tool is on
    std::optional<FirstPerson> walk_;
    vcg::Similarityf written_;
    float written_fov_ = 0;
    unsigned keys_ = 0;
    bool looking_ = false;
    QPoint looked_at_;
    double reach_ = 0, reach_error_ = 0;
    QTimer timer_;  // runs while a key is held or something moves
    QElapsedTimer clock_;
};

}  // namespace pcm::host
