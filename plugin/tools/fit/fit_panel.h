// The panel of the tool Fit Primitives: how shapes are fitted, what was found, and the list of primitives. It shows
// what it is given and reports what a user does; the tool decides. GUI thread.
#pragma once

#include "pcm/shapes/primitive_list.h"
#include "plugin/tools/fit/fit_settings.h"

#include <QDockWidget>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

class QAction;
class QGridLayout;
class QProgressBar;
class QPushButton;
class QVBoxLayout;

namespace pcm::host {

class FitFields;
class MessageArea;
class NamedList;
class ValueTable;

class FitPanel : public QDockWidget {
    Q_OBJECT

public:
    enum class Button {
        accept,
        discard,
        look_at,
        colour,
        remove,
        clear,
        undo,
        redo,
        copy,
        save,
        select_points,
        to_layer,
        to_file,
        remove_points,
        save_attribute,
        defaults,
    };
    Q_ENUM(Button)

    explicit FitPanel(QWidget* window);

    FitSettings settings() const;
    void show_defaults();  // shows the defaults of the fields
    void show_list(const PrimitiveList& list, std::optional<std::size_t> selected, const std::string& unit);
    void show_found(const QString& text, bool some);  // what the clicks have found so far; whether it can be accepted
    void say(const QString& text);                    // what happened
    // While something runs: what it is, and how much of it is done (0 to 1). Nothing: it has ended.
    void show_progress(const std::optional<std::pair<QString, double>>& progress);

signals:
    void settings_changed();
    void pressed(FitPanel::Button button);
    void renamed(int index, const QString& name);
    void hidden(int index, bool hidden);
    void selected(int index);  // -1: none

private:
    void add_button(QGridLayout& rows, int row, int column, Button button, const char* text, const char* tooltip);
    void add_draft(QVBoxLayout& column);
    void add_list(QVBoxLayout& column);
    void add_points_menu(QGridLayout& rows, int row, int column);

    FitFields* fields_ = nullptr;
    MessageArea *found_ = nullptr, *words_ = nullptr;
    QProgressBar* progress_ = nullptr;
    NamedList* list_ = nullptr;
    ValueTable* values_ = nullptr;
    QPushButton* points_ = nullptr;
    std::map<Button, QPushButton*> buttons_;
};

}  // namespace pcm::host
