// The panel of the tool Select Points: how points are chosen, how many are selected, and what is done with them. It
// reports what a user does; the tool decides. GUI thread.
#pragma once

#include "pcm/query/point_set.h"
#include "pcm/select/grow_from.h"

#include <QColor>
#include <QDockWidget>

#include <map>
#include <optional>
#include <vector>

class QComboBox;
class QGridLayout;
class QLineEdit;
class QProgressBar;
class QPushButton;

namespace pcm::host {

class MessageArea;

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
        defaults,
        colour,
        to_layer,
        to_file,
        remove,
        classify,
        save,
    };
    Q_ENUM(Button)

    explicit SelectPanel(QWidget* window);

    // Those with a number throw Error(invalid_argument) for text that is not such a number.
    Shape shape() const;
    SetOperation operation() const;
    bool front_only() const;
    bool all_layers() const;
    std::optional<double> brush_px() const;  // nothing: from the points' spacing
    std::optional<double> distance() const;  // distance of growing, source units; nothing: from the points' spacing
    SeedLimits seed_limits() const;
    void propose_distance(const QString& text);  // shown where nothing is typed
    void show_defaults();
    QString where() const;

    void show_colour(const QColor& colour);  // colour of selected points
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
    QLineEdit* add_field(QGridLayout& rows, const char* label, const char* usual, const char* tooltip);
    void add_button(QGridLayout& rows, int row, int column, Button button, const char* text, const char* tooltip);
    void add_ways(QGridLayout& rows);
    void add_growing(QGridLayout& rows);
    void show_fields();  // shows only the fields of the chosen shape
    void add_uses(QGridLayout& rows);

    QComboBox *shape_, *operation_, *reach_, *layers_, *attributes_;
    QLineEdit *brush_, *distance_, *angle_, *difference_, *within_, *where_;
    MessageArea *count_, *words_;
    QProgressBar* progress_;
    std::map<Button, QPushButton*> buttons_;
    std::map<QWidget*, std::vector<QWidget*>> parts_;  // widgets of each field, its label included
};

}  // namespace pcm::host
