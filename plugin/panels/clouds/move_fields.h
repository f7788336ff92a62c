// Fields that move the current layer by numbers: translation, rotation, scale, applied to its matrix, with undo.
#pragma once

#include "plugin/scene/scene.h"

#include <QPointer>
#include <QWidget>

#include <array>
#include <functional>

class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;

namespace pcm::host {

// GUI thread.
class MoveFields : public QWidget {
    Q_OBJECT

public:
    explicit MoveFields(QWidget* parent);

    // The document whose current layer is moved; null: none.
    void refresh(Scene* scene);

private:
    void move();
    // Runs `work` with the current layer, if it shows a cloud; what it throws is shown next to the fields.
    void guarded(const std::function<void(SceneLayer&)>& work);

    QPointer<Scene> scene_;
    std::array<QLineEdit*, 3> translate_{};
    QComboBox* axis_ = nullptr;
    QLineEdit *degrees_ = nullptr, *scale_ = nullptr;
    QPushButton *move_ = nullptr, *undo_ = nullptr, *redo_ = nullptr, *reset_ = nullptr;
    QLabel* words_ = nullptr;
};

}  // namespace pcm::host
