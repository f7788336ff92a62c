// The layers of a document that show point clouds, as a table: which is current, visible, shown alone, locked.
#pragma once

#include "plugin/scene/scene.h"

#include <QPointer>
#include <QTableWidget>

#include <vector>

namespace pcm::host {

// GUI thread. MeshLab does not signal all changes of its layers, so the table is compared with them at refresh().
class LayerList : public QTableWidget {
    Q_OBJECT

public:
    explicit LayerList(QWidget* parent);

    // Shows the layers of this scene; null: none. Cheap where nothing has changed.
    void refresh(Scene* scene);

private:
    enum Column { name, points, visible, solo, locked, columns };
    struct Row {
        int layer_id;
        QString label, points;
        bool current, visible, solo, locked;
        bool operator==(const Row& other) const;
    };
    static std::vector<Row> rows_of(Scene& scene);
    void fill();
    void ticked(QTableWidgetItem* item);
    void chosen();
    SceneLayer* layer_in(int row) const;

    QPointer<Scene> scene_;
    std::vector<Row> rows_;
    bool filling_ = false;
};

}  // namespace pcm::host
