// What tools draw over the clouds of a document: lines, marks and labels at places of the scene. Views draw them
// whichever tool is active (overlay/annotation_pass.h), and a snapshot has them too. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

#include "pcm/cloud/geometry.h"

#include <QColor>
#include <QObject>
#include <QString>

#include <map>
#include <vector>

namespace pcm::host {

// In the document's scene: source coordinates for layers without a matrix. For the others these are the coordinates
// that their matrix gives them (SceneLayer::placement).
struct Annotation {
    std::vector<Vec3d> line;   // joined by segments
    bool closed = false;       // the last point is joined with the first
    std::vector<Vec3d> marks;  // drawn as crosses of a fixed size on the screen
    QString label;             // next to `label_at`; empty: none. Lines are separated by \n
    Vec3d label_at{};
    QColor colour = QColor(255, 170, 0);
    double width_px = 2;
    bool on_top = false;  // the parts behind points are as visible as the others; else they are faint
};

// One for each scene.
class Annotations : public QObject {
    Q_OBJECT

public:
    explicit Annotations(Scene& scene);

    // Replaces what this owner ("measure", "clip", ...) has drawn, and repaints the document's views.
    void set(const QString& owner, std::vector<Annotation> annotations);
    const std::map<QString, std::vector<Annotation>>& all() const { return all_; }

signals:
    void changed();

private:
    Scene& scene_;
    std::map<QString, std::vector<Annotation>> all_;
};

}  // namespace pcm::host
