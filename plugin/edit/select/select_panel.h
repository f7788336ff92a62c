// The panel of the tool Select Points: how points are chosen, how many are selected, and what is done with them. It
// reports what a user does; the tool decides. GUI thread.
#pragma once

#include "pcm/query/point_set.h"

#include <QColor>
#include <QDockWidget>

#include <map>
#include <optional>

class QComboBox;
class QGridLayout;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;

namespace pcm::host {

class SelectPanel : public QDockWidget {
    Q_OBJECT

public:
    enum class Shape { rectangle, lasso, brush, grow };
    enum class Button {
        where,
        all,
        none,
        invert,
        undo,
        redo,
        stop,
        colour,
        to_layer,
        to_file,
        remove,
        classify,
        save,
    };
    Q_ENUM(Button)

    explicit SelectPanel(QWidget* window);

    // brush_px() and distance() throw Error(invalid_argument) for text that is no such number.
    Shape shape() const;
    SetOperation operation() const;
    bool front_only() const;
    bool all_layers() const;
    double brush_px() const;
    std::optional<double> distance() const;  // of growing, source units; nothing: from the points' spacing
    QString where() const;

    void show_colour(const QColor& colour);  // of selected points
    void show_count(const QString& text);
    void show_attributes(const QStringList& names);
    void show_steps(const QString& undo, const QString& redo);  // words of the steps; null: there is none
    void show_progress(double fraction, const QString& stage);
    void end_progress();
    void say(const QString& text);

signals:
    void pressed(SelectPanel::Button button);
    void shape_changed();

private:
    QComboBox* add_choice(QGridLayout& rows, const char* label, const QStringList& choices, const char* tooltip);
    QLineEdit* add_field(QGridLayout& rows, const char* label, const char* text, const char* tooltip);
    void add_button(QGridLayout& rows, int row, int column, Button button, const char* text, const char* tooltip);
    void add_ways(QGridLayout& rows);
    void add_uses(QGridLayout& rows);

    QComboBox *shape_, *operation_, *reach_, *layers_, *attributes_;
    QLineEdit *brush_, *distance_, *where_;
    QLabel *count_, *words_;
    QProgressBar* progress_;
    std::map<Button, QPushButton*> buttons_;
};

}  // namespace pcm::host
