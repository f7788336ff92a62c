// The panel of the tool Clip Box: the box as numbers, and buttons. It shows what it is given and reports what a user
// does; the tool decides. GUI thread.
#pragma once

#include "plugin/scene/scene_state.h"

#include <QDockWidget>

#include <map>
#include <optional>

class QCheckBox;
class QComboBox;
class QGridLayout;
class QLineEdit;
class QPushButton;
class QSlider;

namespace pcm::host {

class MessageArea;

class ClipPanel : public QDockWidget {
    Q_OBJECT

public:
    enum class Button {
        from_view,
        from_layer,
        box_from_points,
        section_from_points,
        make_slab,
        step_back,
        step_ahead,
        undo,
        redo,
        remove,
        keep_layer,
        keep_file,
    };
    Q_ENUM(Button)

    explicit ClipPanel(QWidget* window);

    // `bounds` are those of the clouds, in the scene; the slider moves the slab through them. `step` is the finest one
    // of their grids: numbers that a slider makes have no more digits.
    void show_box(const std::optional<ClipBox>& box, const Box3d& bounds, double step);
    void show_steps(bool can_undo, bool can_redo);
    void say(const QString& text);
    std::size_t slab_axis() const;
    // What is typed as the slab's thickness; nothing where that is not a number above 0.
    std::optional<double> thickness() const;

signals:
    void edited(const ClipBox& box);  // a number, or a choice
    void pressed(ClipPanel::Button button);

private:
    enum Field { centre_x, centre_y, centre_z, size_x, size_y, size_z, turn, thickness_field };
    QLineEdit* add_field(QGridLayout& rows, Field field, const char* label, const char* tooltip);
    void add_button(QGridLayout& rows, int row, int column, Button button, const char* text, const char* tooltip,
                    int span = 1);
    void add_box_fields(QGridLayout& rows);
    void add_slab_fields(QGridLayout& rows);
    void take(Field field);
    void choose();
    void slide(int step);
    void show_slab(const Box3d& bounds);

    std::optional<ClipBox> box_;
    Box3d bounds_;
    double step_ = 0;
    QCheckBox* enabled_;
    QComboBox *side_, *axis_;
    QSlider* slider_;
    MessageArea* words_;
    std::map<Field, QLineEdit*> fields_;
    std::map<Field, QString> shown_;
    std::map<Button, QPushButton*> buttons_;
};

}  // namespace pcm::host
